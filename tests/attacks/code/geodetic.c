#include <math.h>
#define A_WGS 6378137.0
#define F_WGS (1.0/298.257223563)
#define E2 (F_WGS*(2.0 - F_WGS))
#define DEG (M_PI/180.0)
void geodetic(const double lla[3], double ecef[3])
{
    const double s = sin(lla[0]*DEG), c = cos(lla[0]*DEG);
    const double n = A_WGS / sqrt(1.0 - E2*s*s);
    ecef[0] = (n + lla[2])*c*cos((lla[1])*DEG);
    ecef[1] = (n + lla[2])*c*sin((lla[1])*DEG);
    ecef[2] = (n*(1.0 - E2) + lla[2])*s;
}
