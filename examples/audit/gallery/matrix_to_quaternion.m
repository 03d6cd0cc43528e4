% The mathematics of mex-wholebodymodel issue 92: a sum in the place of a difference when a matrix becomes a quaternion.
function R = rotation(q)
    R = [q(1)^2+q(2)^2-q(3)^2-q(4)^2, 2*(q(2)*q(3)-q(1)*q(4)), 2*(q(2)*q(4)+q(1)*q(3));
         2*(q(2)*q(3)+q(1)*q(4)), q(1)^2-q(2)^2+q(3)^2-q(4)^2, 2*(q(3)*q(4)-q(1)*q(2));
         2*(q(2)*q(4)-q(1)*q(3)), 2*(q(3)*q(4)+q(1)*q(2)), q(1)^2-q(2)^2-q(3)^2+q(4)^2];
end

function p = before(q)
    R = rotation(q);
    s = 0.25 / q(1);
    p = [(R(3,2) + R(2,3)) * s; (R(1,3) - R(3,1)) * s; (R(2,1) - R(1,2)) * s];
end

function p = after(q)
    R = rotation(q);
    s = 0.25 / q(1);
    p = [(R(3,2) - R(2,3)) * s; (R(1,3) - R(3,1)) * s; (R(2,1) - R(1,2)) * s];
end
