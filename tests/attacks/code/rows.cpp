#include <Eigen/Dense>
using Eigen::Matrix3d; using Eigen::Vector3d;
Vector3d rows(const Matrix3d &M, const Vector3d &v, double s)
{
    Matrix3d A = M;
    A.row(1) = v.transpose() * s;
    A.col(2) += M.row(0).transpose();
    Vector3d d = A.diagonal();
    double t = A.trace() + v.sum() + v.squaredNorm() + v.head<2>().norm();
    d(0) += t;
    d.tail<2>() *= 2.0;
    return d.cwiseProduct(v) + A.transpose() * v.normalized();
}
