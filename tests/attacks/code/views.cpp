#include <Eigen/Dense>
using Eigen::Matrix3d; using Eigen::Vector3d;
Matrix3d views(const Matrix3d &M, const Vector3d &v, double a)
{
    Matrix3d A = v * M.row(0);
    Matrix3d B = M.col(1) * v.transpose();
    double d = M.row(2) * v;
    Eigen::Matrix<double, 2, 2> C = M.bottomRightCorner<2, 2>() * M.block(0, 1, 2, 2);
    A.topLeftCorner(2, 2) += C.transpose();
    A.col(0) *= a; d += M.row(0).head<2>().sum();
    B.col(0) = M.row(1).transpose() * d;
    A.block<1, 3>(2, 0) = v.transpose();
    Vector3d e = v.cwiseProduct(v);
    return A + (B + Matrix3d::Identity()).inverse() + C.determinant() * M + a * Matrix3d(e.asDiagonal());
}
