function y = strap(v, w, C, dt)
    Om = skew(w);
    n = norm(w)*dt;
    Cn = C*(eye(3) + Om*dt + 0.5*Om^2*dt^2);
    F = zeros(6);
    F(1:3, 4:6) = Cn;
    F(4:6, 1:3) = -skew(v);
    for i = 1:2:5
        F(i, i) = F(i, i) + i;
    end
    y = F(:, 1)' + F(2, :)*F + sum(v.^2) + trace(C) + n;
end
function S = skew(v)
    S = [0, -v(3), v(2); v(3), 0, -v(1); -v(2), v(1), 0];
end
