function y = shapes(M, v, a)
    r = M(2, :);
    A = r'*r;
    c = M(:, 1);
    B = c*c';
    w = v';
    d = w*v + r*c;
    s = w(2:3);
    S = s'*s;
    M(3, :) = v;
    M(:, 2) = r;
    N = [M(1, :); r; w];
    z = M(end, 1:end-1)*S*M(1, 2);
    q = [r, a; v', d]*[c; a];
    y = [A(:, 1); B(:, 3); d; N(2, :)'; z'; q; M(end, end)];
end
