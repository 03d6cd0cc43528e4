/* A car in the plane: position, yaw and speed after a step dt, and the derivative of that by the state. */
#include <math.h>

void predict(const float x[4], float dt, float xn[4], float F[4][4])
{
    const float c = cosf(x[2]);
    const float s = sinf(x[2]);
    xn[0] = x[0] + x[3] * c * dt;
    xn[1] = x[1] + x[3] * s * dt;
    xn[2] = x[2];
    xn[3] = x[3];
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 4; j++) { F[i][j] = (i == j) ? 1.0f : 0.0f; }
    }
    F[0][2] = -x[3] * s * dt;
    F[0][3] = c * dt;
    F[1][2] = x[3] * c * dt;
    F[1][3] = s * dt;
}
