static void mul(const double *A, const double *B, double *C, int n, int m, int p)
{
    for (int i = 0; i < n; i++)
        for (int j = 0; j < p; j++) {
            double s = 0.0;
            for (int k = 0; k < m; k++) s += A[i*m + k]*B[k*p + j];
            C[i*p + j] = s;
        }
}
void flat(const double F[4], const double P[4], double y[4])
{
    double FP[4], Ft[4] = {F[0], F[2], F[1], F[3]};
    mul(F, P, FP, 2, 2, 2);
    mul(FP, Ft, y, 2, 2, 2);
}
