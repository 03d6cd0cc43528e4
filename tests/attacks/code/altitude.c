#include <string.h>
#define N 3
static void mult(const double A[N][N], const double B[N][N], double C[N][N])
{
    for (int i = 0; i < N; ++i)
        for (int j = 0; j < N; ++j) {
            C[i][j] = 0;
            for (int k = 0; k < N; ++k) C[i][j] += A[i][k] * B[k][j];
        }
}
static void transpose(const double A[N][N], double T[N][N])
{
    for (int i = 0; i < N; i++) for (int j = 0; j < N; j++) T[j][i] = A[i][j];
}
void altitude(double x[3], double P[3][3], double acc, double dt, double q)
{
    double F[N][N] = {{1, dt, -0.5*dt*dt}, {0, 1, -dt}, {0, 0, 1}};
    double Ft[N][N], FP[N][N], out[N][N];
    x[0] += x[1]*dt + 0.5*(acc - x[2])*dt*dt;
    x[1] += (acc - x[2])*dt;
    transpose(F, Ft);
    mult(F, P, FP);
    mult(FP, Ft, out);
    out[1][1] += q*dt;
    memcpy(P, out, sizeof(out));
}
