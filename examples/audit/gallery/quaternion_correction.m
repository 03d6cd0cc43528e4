% The mathematics of NaveGo issue 120: the sign of the cross product in the correction of a quaternion.
function d = before(q, e)
    A = [0 q(3) -q(2); -q(3) 0 q(1); q(2) -q(1) 0];
    d = 0.5 * (q(4) * e + A * e);
end

function d = after(q, e)
    A = [0 -q(3) q(2); q(3) 0 -q(1); -q(2) q(1) 0];
    d = 0.5 * (q(4) * e + A * e);
end
