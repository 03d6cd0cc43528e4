#include <math.h>
static inline float sq(float v) { return v*v; }
static float constrain(float v, float lo, float hi) { return v < lo ? lo : (v > hi ? hi : v); }
void joseph(float x[3], float P[3][3], const float H[3], float z, float R)
{
    float S = R, PH[3], K[3], innov = z;
    int i, j;
    for (i = 0; i != 3; ++i) {
        PH[i] = 0.0f;
        for (j = 0; j < 3; j++) PH[i] += P[i][j]*H[j];
    }
    for (i = 2; i >= 0; i--) S += H[i]*PH[i];
    for (i = 0; i < 3; i++) { K[i] = PH[i]/S; innov -= H[i]*x[i]; }
    for (i = 0; i < 3; i++) x[i] += K[i]*innov;
    for (i = 0; i < 3; i++)
        for (j = i; j < 3; j++) {
            P[i][j] = P[i][j] - K[i]*PH[j] - PH[i]*K[j] + K[i]*K[j]*S;
            P[j][i] = P[i][j];
        }
    x[2] = constrain(x[2], -sq(2.0f), sq(2.0f));
}
