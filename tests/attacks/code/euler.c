#include <math.h>
void euler(const double q[4], double R[3][3], double rpy[3])
{
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    R[0][0] = 1 - 2*(y*y + z*z); R[0][1] = 2*(x*y - w*z); R[0][2] = 2*(x*z + w*y);
    R[1][0] = 2*(x*y + w*z); R[1][1] = 1 - 2*(x*x + z*z); R[1][2] = 2*(y*z - w*x);
    R[2][0] = 2*(x*z - w*y); R[2][1] = 2*(y*z + w*x); R[2][2] = 1 - 2*(x*x + y*y);
    double sp = -R[2][0];
    if (sp > 1.0) sp = 1.0; else if (sp < -1.0) sp = -1.0;
    rpy[0] = atan2(R[2][1], R[2][2]);
    rpy[1] = fabs(sp) < 1 ? asin(sp) : (sp > 0) ? M_PI/2 : -M_PI/2;
    rpy[2] = atan2(R[1][0], R[0][0]);
}
