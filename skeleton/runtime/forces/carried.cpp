#include "skeleton/runtime/forces/carried.h"

#include <algorithm>

#include "skeleton/model/state.h"

namespace palpate::runtime {

void RuntimePoint::assign(const skeleton::Attachment& point, const std::vector<skeleton::Sphere>& spheres) {
    rest_ = point.rest;
    Vec3 X = Vec3::Zero();
    for (const skeleton::SphereInfluence& share : point.shares) X += share.weight * spheres[share.sphere].center;
    to_rest_ = rest_ - X;
    shares_.clear();
    for (const skeleton::SphereInfluence& share : point.shares) {
        Share own;
        own.sphere = share.sphere;
        own.w = share.weight;
        own.A = share.follow.leftCols<3>() - share.weight * Mat3::Identity();
        own.B = share.follow.rightCols<3>() + share.weight * skeleton::skew(to_rest_);
        own.Y = spheres[share.sphere].center - X;
        shares_.push_back(own);
    }
    std::iter_swap(shares_.begin(), std::ranges::max_element(shares_, {}, &Share::w));
}

void RuntimePoint::place(const double* pose) {
    const Eigen::Quaterniond reference = orientation_of(pose, shares_.front().sphere);
    const auto alike = [&](const Share& s) {
        Eigen::Quaterniond q = orientation_of(pose, s.sphere);
        if (q.dot(reference) < 0) q.coeffs() = -q.coeffs();
        return q;
    };
    Vec3 mean = Vec3::Zero();
    Eigen::Vector4d sum = Eigen::Vector4d::Zero();
    for (const Share& s : shares_) {
        mean += s.w * moves_of(pose, s.sphere);
        sum += s.w * alike(s).coeffs();
    }
    n_ = sum.norm();
    const Eigen::Quaterniond q(Eigen::Vector4d(sum / n_));
    R_ = q.toRotationMatrix();
    Vec3 arm = to_rest_;
    for (Share& s : shares_) {
        s.y = moves_of(pose, s.sphere) - mean;
        const Eigen::Quaterniond beyond = alike(s) * q.conjugate();
        s.c = beyond.w();
        s.v = beyond.vec();
        arm += s.A * (R_.transpose() * s.y - s.Y) + 2 * s.B * (R_.transpose() * s.v);
    }
    arm_ = R_ * arm;
    x_ = mean + arm_;
}

void RuntimePoint::jacobians(std::vector<Eigen::Matrix<double, 3, 6>>& by_share) const {
    by_share.resize(shares_.size());
    for (int axis = 0; axis < 3; ++axis) {
        std::size_t i = 0;
        pull_back(Vec3::Unit(axis), [&](int, const Vec3& force, const Vec3& torque) {
            by_share[i++].row(axis) << force.transpose(), torque.transpose();
        });
    }
}

Vec3 RuntimePoint::velocity(const double* velocity) const {
    Vec3 sum = Vec3::Zero();
    for (int axis = 0; axis < 3; ++axis) {
        pull_back(Vec3::Unit(axis), [&](int sphere, const Vec3& force, const Vec3& torque) {
            sum[axis] += force.dot(moves_of(velocity, sphere)) + torque.dot(turns_of(velocity, sphere));
        });
    }
    return sum;
}

}  // namespace palpate::runtime
