/* The mathematics of PX4-Autopilot pull request 10350: a sign in the Jacobian of a fit of a sphere. */
#include <math.h>

void before(const double m[3], const double o[3], double radius, double r[1], double J[4])
{
    const double a = m[0] - o[0], b = m[1] - o[1], c = m[2] - o[2];
    const double length = sqrt(a * a + b * b + c * c);
    r[0] = radius - length;
    J[0] = 1.0;
    J[1] = a / length;
    J[2] = -b / length;
    J[3] = c / length;
}

void after(const double m[3], const double o[3], double radius, double r[1], double J[4])
{
    const double a = m[0] - o[0], b = m[1] - o[1], c = m[2] - o[2];
    const double length = sqrt(a * a + b * b + c * c);
    r[0] = radius - length;
    J[0] = 1.0;
    J[1] = a / length;
    J[2] = b / length;
    J[3] = c / length;
}
