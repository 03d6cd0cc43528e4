#include <Eigen/Dense>
using Eigen::Matrix2d; using Eigen::Matrix3d; using Eigen::Vector2d; using Eigen::Vector3d;
void update(Vector3d &x, Matrix3d &P, const Vector2d &z, double r)
{
    Eigen::Matrix<double, 2, 3> H;
    H.setZero();
    H(0, 0) = 1.0;
    H(1, 2) = 2.0;
    const Matrix2d S = H * P * H.transpose() + r * Matrix2d::Identity();
    const Eigen::Matrix<double, 3, 2> K = P * H.transpose() * S.inverse();
    x += K * (z - H * x);
    const Matrix3d IKH = Matrix3d::Identity() - K * H;
    P = IKH * P * IKH.transpose() + K * r * K.transpose();
}
