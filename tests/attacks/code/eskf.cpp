#include <Eigen/Dense>
using namespace Eigen;
static Matrix3d skew(const Vector3d &v)
{
    Matrix3d S;
    S << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
    return S;
}
Matrix<double, 6, 6> eskf(const Matrix<double, 6, 6> &P, const Matrix3d &R, const Vector3d &a, double dt, double q)
{
    Matrix<double, 6, 6> F = Matrix<double, 6, 6>::Identity();
    F.block<3, 3>(3, 0) = -R * skew(a) * dt;
    F.topLeftCorner<3, 3>() -= skew(a) * dt;
    Matrix<double, 6, 6> Q = Matrix<double, 6, 6>::Zero();
    Q.block<3, 3>(3, 3) = q * Matrix3d::Identity();
    return F * P * F.transpose() + Q * dt * dt;
}
