// The mathematics of gtsam pull request 505: a Coriolis correction that stays in the navigation frame.
#include <Eigen/Dense>
using Eigen::Matrix3d;
using Eigen::Vector3d;

Vector3d before(const Matrix3d &R, const Vector3d &earth, const Vector3d &v, double dt)
{
    Vector3d dv = earth.cross(v) * (-2.0 * dt);
    return dv;
}

Vector3d after(const Matrix3d &R, const Vector3d &earth, const Vector3d &v, double dt)
{
    Vector3d nav = earth.cross(v) * (-2.0 * dt);
    Vector3d dv = R.transpose() * nav;
    return dv;
}

Vector3d wanted(const Matrix3d &R, const Vector3d &earth, const Vector3d &v, double dt)
{
    return -2.0 * dt * (R.transpose() * earth.cross(v));
}
