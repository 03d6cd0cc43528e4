/* A quaternion (real part first) after one step of the gyroscopes, to the second order, and its length squared. */
void attitude_step(const double q[4], const double w[3], const double bias[3], double dt, double y[5])
{
    const double x = 0.5*dt*(w[0] - bias[0]);
    const double u = 0.5*dt*(w[1] - bias[1]);
    const double z = 0.5*dt*(w[2] - bias[2]);
    const double c = 1.0 - 0.5*(x*x + u*u + z*z);
    y[0] = c*q[0] - x*q[1] - u*q[2] - z*q[3];
    y[1] = c*q[1] + x*q[0] + z*q[2] - u*q[3];
    y[2] = c*q[2] + u*q[0] - z*q[1] + x*q[3];
    y[3] = c*q[3] + z*q[0] + u*q[1] - x*q[2];
    y[4] = 0.0;
    for (int i = 0; i < 4; i++) { y[4] += y[i]*y[i]; }
}
