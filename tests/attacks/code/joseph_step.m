% The covariance of two states after a measurement of the first, in Joseph's form.
function p = joseph_step(P, r)
    s = P(1,1) + r;
    k1 = P(1,1) / s;
    k2 = P(2,1) / s;
    a = 1 - k1;
    p11 = a^2 * P(1,1) + k1^2 * r;
    p12 = a * (P(1,2) - k2 * P(1,1)) + k1 * r * k2;
    p22 = P(2,2) - 2 * k2 * P(1,2) + k2^2 * P(1,1) + r * k2^2;
    p = [p11; p12; p22];
end
