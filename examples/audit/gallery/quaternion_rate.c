/* The mathematics of zscilib pull request 62: the rate of a quaternion with its factors exchanged. */
static void product(const float a[4], const float b[4], float c[4])
{
    c[0] = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3];
    c[1] = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2];
    c[2] = a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1];
    c[3] = a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0];
}

void before(const float q[4], const float w[3], float dq[4])
{
    float rate[4] = { 0.0f, w[0], w[1], w[2] };
    product(rate, q, dq);
    for (int i = 0; i < 4; i++) {
        dq[i] *= 0.5f;
    }
}

void after(const float q[4], const float w[3], float dq[4])
{
    float rate[4] = { 0.0f, w[0], w[1], w[2] };
    product(q, rate, dq);
    for (int i = 0; i < 4; i++) {
        dq[i] *= 0.5f;
    }
}
