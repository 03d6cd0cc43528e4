% The mathematics of NaveGo issue 12 and pull request 94: the sign of the Coriolis term beside the order of the cross product.
function S = skewm(v)
    S = [0 -v(3) v(2); v(3) 0 -v(1); -v(2) v(1) 0];
end

function fc = before(f, v, wen, wie, g)
    c = skewm(v) * (wen + 2 * wie);
    fc = f - c + g;
end

function fc = after(f, v, wen, wie, g)
    c = skewm(v) * (wen + 2 * wie);
    fc = f + c + g;
end
