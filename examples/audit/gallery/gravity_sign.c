/* The mathematics of roscopter issue 8: gravity along the body axis with its sign lost. */
#include <math.h>

void before(double pitch, double roll, double g, double a[2])
{
    a[0] = g * sin(pitch);
    a[1] = g * cos(pitch) * sin(roll);
}

void after(double pitch, double roll, double g, double a[2])
{
    a[0] = -g * sin(pitch);
    a[1] = g * cos(pitch) * sin(roll);
}
