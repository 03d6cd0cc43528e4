% Cartesian coordinates of latitude, longitude and height above an ellipsoid.
function p = earth_place(x, a, e2)
    s = sin(x(1));
    c = cos(x(1));
    n = a / sqrt(1 - e2 * s^2);
    r = (n + x(3)) * c;
    p = [r * cos(x(2)); r * sin(x(2)); (n * (1 - e2) + x(3)) * s];
end
