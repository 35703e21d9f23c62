#include "fem/rig/round_shapes.h"

#include <cmath>

namespace palpate::fem {

namespace {

class SphereDistance final : public RigidShape {
public:
    using RigidShape::gap;
    SphereDistance(const Vec3& centre, double radius) : centre_(centre), radius_(radius) {}
    Gap gap(const Vec3& y) const override {
        const Vec3 arm = y - centre_;
        const double r = arm.norm();
        if (r == 0) return {-radius_, Vec3::UnitZ(), Mat3::Zero()};
        const Vec3 n = arm / r;
        return {r - radius_, n, (Mat3::Identity() - n * n.transpose()) / r};
    }
    double radius() const override { return radius_; }

private:
    Vec3 centre_;
    double radius_;
};

class PunchDistance final : public RigidShape {
public:
    PunchDistance(const Vec3& centre, const mesh::FlatShape& punch)
        : centre_(centre), axis_(punch.axis.normalized()), radius_(punch.radius) {}
    Gap gap(const Vec3& y) const override {
        const Vec3 arm = y - centre_;
        const double ahead = axis_.dot(arm);
        const Vec3 across = arm - ahead * axis_;
        const double rho = across.norm(), beside = rho - radius_;
        if (rho == 0 || (beside <= 0 && ahead >= beside)) return {ahead, axis_, Mat3::Zero()};
        const Vec3 out = across / rho;
        const Mat3 turning = (Mat3::Identity() - axis_ * axis_.transpose() - out * out.transpose()) / rho;
        if (ahead <= 0) return {beside, out, turning};
        // Before the face and beside it the rim is nearest.
        const double distance = std::hypot(ahead, beside);
        const Vec3 n = (ahead * axis_ + beside * out) / distance, along = (beside * axis_ - ahead * out) / distance;
        return {distance, n, (along * along.transpose() + beside * turning) / distance};
    }
    Gap gap(const Vec3& y, const Vec3& rest) const override {
        const auto across = [&](const Vec3& r) -> Vec3 { return r - axis_.dot(r) * axis_; };
        const Vec3 arm = y - centre_, out = across(arm);
        if (across(rest - centre_).norm() > radius_) return gap(y);
        const double ahead = axis_.dot(arm), rho = out.norm(), beside = rho - radius_;
        if (beside <= 0) return {ahead, axis_, Mat3::Zero()};
        // A slope of 45 degrees leads out over the rim: a gap that leapt there would let no step lead back in.
        if (ahead + beside >= 0) return gap(y);
        const Vec3 n = out / rho;
        return {ahead + beside, axis_ + n, (Mat3::Identity() - axis_ * axis_.transpose() - n * n.transpose()) / rho};
    }
    double radius() const override { return radius_; }

private:
    Vec3 centre_, axis_;
    double radius_;
};

}  // namespace

std::shared_ptr<const RigidShape> ball_shape(const Vec3& centre, double radius) {
    return std::make_shared<SphereDistance>(centre, radius);
}

std::shared_ptr<const RigidShape> punch_shape(const Vec3& centre, const mesh::FlatShape& punch) {
    return std::make_shared<PunchDistance>(centre, punch);
}

}  // namespace palpate::fem
