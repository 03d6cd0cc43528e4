/* The mathematics of crazyflie-firmware pull request 1531: a residual of attitude that does not lead to the measured one. */
static void product(const double a[4], const double b[4], double c[4])
{
    c[0] = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3];
    c[1] = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2];
    c[2] = a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1];
    c[3] = a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0];
}

void before(const double q[4], const double p[4], double back[4])
{
    const double inverse[4] = { q[0], -q[1], -q[2], -q[3] };
    double residual[4];
    product(inverse, p, residual);
    product(residual, q, back);
}

void after(const double q[4], const double p[4], double back[4])
{
    const double inverse[4] = { q[0], -q[1], -q[2], -q[3] };
    double residual[4];
    product(p, inverse, residual);
    product(residual, q, back);
}
