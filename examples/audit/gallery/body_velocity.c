/* The mathematics of robot_localization pull request 233: the derivative of a rotated velocity by the yaw. */
#include <math.h>

void before(const double a[3], const double v[2], double dt, double dx[1], double J[3])
{
    const double cr = cos(a[0]), sr = sin(a[0]), cp = cos(a[1]), sp = sin(a[1]), cy = cos(a[2]), sy = sin(a[2]);
    dx[0] = (cy * cp * v[0] + (cy * sp * sr - sy * cr) * v[1]) * dt;
    J[0] = (cy * sp * cr + sy * sr) * v[1] * dt;
    J[1] = (-cy * sp * v[0] + cy * cp * sr * v[1]) * dt;
    J[2] = (-sy * cp * v[0] + (-sy * sp * sr + cy * cr) * v[1]) * dt;
}

void after(const double a[3], const double v[2], double dt, double dx[1], double J[3])
{
    const double cr = cos(a[0]), sr = sin(a[0]), cp = cos(a[1]), sp = sin(a[1]), cy = cos(a[2]), sy = sin(a[2]);
    dx[0] = (cy * cp * v[0] + (cy * sp * sr - sy * cr) * v[1]) * dt;
    J[0] = (cy * sp * cr + sy * sr) * v[1] * dt;
    J[1] = (-cy * sp * v[0] + cy * cp * sr * v[1]) * dt;
    J[2] = (-sy * cp * v[0] + (-sy * sp * sr - cy * cr) * v[1]) * dt;
}
