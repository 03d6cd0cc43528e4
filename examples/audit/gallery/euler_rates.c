/* The mathematics of robot_localization issue 591: one sign in the derivative of the yaw by the pitch. */
#include <math.h>

static void rates(const double x[3], const double w[3], double dt, double xn[3])
{
    xn[0] = x[0] + (w[0] + sin(x[0]) * tan(x[1]) * w[1] + cos(x[0]) * tan(x[1]) * w[2]) * dt;
    xn[1] = x[1] + (cos(x[0]) * w[1] - sin(x[0]) * w[2]) * dt;
    xn[2] = x[2] + (sin(x[0]) / cos(x[1]) * w[1] + cos(x[0]) / cos(x[1]) * w[2]) * dt;
}

void before(const double x[3], const double w[3], double dt, double xn[3], double F[3])
{
    const double s = sin(x[0]), c = cos(x[0]), t = tan(x[1]), k = 1.0 / cos(x[1]);
    rates(x, w, dt, xn);
    F[0] = (c * k * w[1] - s * k * w[2]) * dt;
    F[1] = (s * t * k * w[1] - c * t * k * w[2]) * dt;
    F[2] = 1.0;
}

void after(const double x[3], const double w[3], double dt, double xn[3], double F[3])
{
    const double s = sin(x[0]), c = cos(x[0]), t = tan(x[1]), k = 1.0 / cos(x[1]);
    rates(x, w, dt, xn);
    F[0] = (c * k * w[1] - s * k * w[2]) * dt;
    F[1] = (s * t * k * w[1] + c * t * k * w[2]) * dt;
    F[2] = 1.0;
}
