/* Error model of a strapdown filter over a flat Earth: velocity, attitude, biases of gyros and accelerometers.
   C leads from body to frame, f is the specific force in the body. One block has a sign wrong. */
#define N 12

void error_model(const double C[3][3], const double f[3], double F[N][N])
{
    double fn[3];
    for (int i = 0; i < 3; i++)
        fn[i] = C[i][0] * f[0] + C[i][1] * f[1] + C[i][2] * f[2];
    const double cross[3][3] = {{0, -fn[2], fn[1]}, {fn[2], 0, -fn[0]}, {-fn[1], fn[0], 0}};

    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++)
            F[i][j] = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            F[i][3 + j] = cross[i][j];
            F[i][9 + j] = C[i][j];
            F[3 + i][6 + j] = C[i][j];
        }
}
