function C = triad(a, m, g, h)
    t1 = a/norm(a);
    t2 = cross(a, m); t2 = t2/norm(t2);
    t3 = cross(t1, t2);
    r1 = g/norm(g);
    r2 = cross(g, h); r2 = r2./norm(r2);
    r3 = cross(r1, r2);
    C = [t1, t2, t3]*[r1, r2, r3]';
end
