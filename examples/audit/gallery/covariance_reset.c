/* The mathematics of ardupilot pull request 19529: the column of a covariance is reset, and its row is not. */
void before(float P[3][3], float variance)
{
    for (int i = 0; i < 3; i++) { P[i][2] = 0.0f; }
    P[2][2] = variance;
}

void after(float P[3][3], float variance)
{
    for (int i = 0; i < 3; i++) { P[i][2] = 0.0f; }
    for (int i = 0; i < 3; i++) { P[2][i] = 0.0f; }
    P[2][2] = variance;
}
