// The mathematics of PX4-ECL pull request 763: the sign of the correction by the rotation of the Earth.
#include <Eigen/Dense>
using Eigen::Matrix3f;
using Eigen::Vector3f;

Vector3f before(const Vector3f &angle, const Matrix3f &R, const Vector3f &earth, float dt)
{
    Vector3f corrected = angle + R.transpose() * earth * dt;
    return corrected;
}

Vector3f after(const Vector3f &angle, const Matrix3f &R, const Vector3f &earth, float dt)
{
    Vector3f corrected = angle - R.transpose() * earth * dt;
    return corrected;
}
