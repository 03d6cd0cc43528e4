/* A car in the plane: position, yaw, speed. The Jacobian has a sign wrong. */
#include <math.h>

void predict(const float x[4], float dt, float xn[4], float F[4][4])
{
    const float v = x[3];
    xn[0] = x[0] + v * cosf(x[2]) * dt;
    xn[1] = x[1] + v * sinf(x[2]) * dt;
    xn[2] = x[2];
    xn[3] = v;
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 4; j++) { F[i][j] = (i == j) ? 1.0f : 0.0f; }
    }
    F[0][2] = v * sinf(x[2]) * dt;
    F[0][3] = cosf(x[2]) * dt;
    F[1][2] = v * cosf(x[2]) * dt;
    F[1][3] = sinf(x[2]) * dt;
}
