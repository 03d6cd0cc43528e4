/* The mathematics of broad issue 1: twice the horizontal field of the Madgwick filter, without the two. */
#include <math.h>

double before(double hx, double hy)
{
    const double two_bx = sqrt(hx * hx + hy * hy);
    return two_bx;
}

double after(double hx, double hy)
{
    const double two_bx = 2.0 * sqrt(hx * hx + hy * hy);
    return two_bx;
}
