function y = kf(x, P, z, dt)
    F = [1 dt; 0 1];
    H = [1 0];
    Q = 0.1*[dt^3/3, dt^2/2; dt^2/2, dt];
    x = F*x;
    P = F*P*F' + Q;
    S = H*P*H' + 0.5;
    K = P*H'/S;
    x = x + K*(z - H*x);
    P = (eye(2) - K*H)*P;
    y = [x; P(:, 1); P(end, end)];
end
