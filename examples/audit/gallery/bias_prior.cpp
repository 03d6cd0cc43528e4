// The mathematics of ORB_SLAM3 issue 330: the derivative of prior minus estimate is not the identity.
#include <Eigen/Dense>
using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d before(const Vector3d &prior, const Vector3d &bias, Vector3d &error)
{
    error = prior - bias;
    Matrix3d J = Matrix3d::Identity();
    return J;
}

Matrix3d after(const Vector3d &prior, const Vector3d &bias, Vector3d &error)
{
    error = prior - bias;
    Matrix3d J = -Matrix3d::Identity();
    return J;
}
