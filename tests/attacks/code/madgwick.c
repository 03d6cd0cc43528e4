#include <math.h>
static float inv_sqrt(float x) { return 1.0f / sqrtf(x); }
void madgwick(float q[4], const float g[3], const float a[3], float beta, float dt)
{
    float q0 = q[0], q1 = q[1], q2 = q[2], q3 = q[3];
    float qDot1 = 0.5f * (-q1 * g[0] - q2 * g[1] - q3 * g[2]);
    float qDot2 = 0.5f * (q0 * g[0] + q2 * g[2] - q3 * g[1]);
    float qDot3 = 0.5f * (q0 * g[1] - q1 * g[2] + q3 * g[0]);
    float qDot4 = 0.5f * (q0 * g[2] + q1 * g[1] - q2 * g[0]);
    if (!((a[0] == 0.0f) && (a[1] == 0.0f) && (a[2] == 0.0f))) {
        float r = inv_sqrt(a[0]*a[0] + a[1]*a[1] + a[2]*a[2]);
        float ax = a[0] * r, ay = a[1] * r, az = a[2] * r;
        float _2q0 = 2.0f * q0, _4q0 = 4.0f * q0, q1q1 = q1 * q1, q2q2 = q2*q2;
        float s0 = _4q0 * q2q2 + 2.0f*q2 * ax + _4q0 * q1q1 - 2.0f*q1 * ay;
        float s1 = 4.0f*q1 * q3*q3 - 2.0f*q3 * ax + 4.0f * q0*q0 * q1 - _2q0 * ay - 4.0f*q1 + 8.0f*q1 * q1q1 + az;
        qDot1 -= beta * s0;
        qDot2 -= beta * s1;
    }
    q0 += qDot1 * dt; q1 += qDot2 * dt; q2 += qDot3 * dt; q3 += qDot4 * dt;
    float n = inv_sqrt(q0 * q0 + q1 * q1 + q2 * q2 + q3 * q3);
    q[0] = q0 * n; q[1] = q1 * n; q[2] = q2 * n; q[3] = q3 * n;
}
