// The mathematics of PX4-Autopilot pull request 22911: a row in the place of a column in Joseph's form.
#include <Eigen/Dense>
using Eigen::Matrix2f;
using Eigen::Vector2f;

void before(Matrix2f &P, const Vector2f &K, float r)
{
    float row[2] = { P(0, 0), P(0, 1) };
    for (int i = 0; i < 2; i++) {
        for (int j = 0; j < 2; j++) { P(i, j) -= K(i) * row[j]; }
    }
    float again[2] = { P(0, 0), P(0, 1) };
    for (int i = 0; i < 2; i++) {
        for (int j = 0; j < 2; j++) { P(i, j) += K(i) * r * K(j) - again[i] * K(j); }
    }
}

void after(Matrix2f &P, const Vector2f &K, float r)
{
    float row[2] = { P(0, 0), P(0, 1) };
    for (int i = 0; i < 2; i++) {
        for (int j = 0; j < 2; j++) { P(i, j) -= K(i) * row[j]; }
    }
    float column[2] = { P(0, 0), P(1, 0) };
    for (int i = 0; i < 2; i++) {
        for (int j = 0; j < 2; j++) { P(i, j) += K(i) * r * K(j) - column[i] * K(j); }
    }
}
