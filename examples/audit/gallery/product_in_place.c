/* The mathematics of ardupilot pull request 3323: a product of quaternions in place that reads what it has written. */
void before(float a[4], const float b[4])
{
    const float w1 = a[0], x1 = a[1], y1 = a[2];
    a[0] = w1 * b[0] - x1 * b[1] - y1 * b[2] - a[3] * b[3];
    a[1] = w1 * b[1] + x1 * b[0] + y1 * b[3] - a[3] * b[2];
    a[2] = w1 * b[2] - x1 * b[3] + y1 * b[0] + a[3] * b[1];
    a[3] = w1 * b[3] + a[1] * b[2] - y1 * b[1] + a[3] * b[0];
}

void after(float a[4], const float b[4])
{
    const float w1 = a[0], x1 = a[1], y1 = a[2], z1 = a[3];
    a[0] = w1 * b[0] - x1 * b[1] - y1 * b[2] - z1 * b[3];
    a[1] = w1 * b[1] + x1 * b[0] + y1 * b[3] - z1 * b[2];
    a[2] = w1 * b[2] - x1 * b[3] + y1 * b[0] + z1 * b[1];
    a[3] = w1 * b[3] + x1 * b[2] - y1 * b[1] + z1 * b[0];
}
