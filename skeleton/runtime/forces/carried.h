#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "skeleton/model/model.h"
#include "skeleton/runtime/forces/rows.h"

namespace palpate::runtime {

/// A point of the body that spheres carry, laid out to be placed again and again: the law is that of
/// skeleton::CarriedPoint. Assigning another attachment allocates only where it has more shares than any before.
class RuntimePoint {
public:
    /// `spheres`: at rest.
    void assign(const skeleton::Attachment& point, const std::vector<skeleton::Sphere>& spheres);

    /// Places it by the spheres' poses (rows of eight numbers each).
    void place(const double* pose);
    const Vec3& x() const { return x_; }  // [mm]
    const Vec3& rest() const { return rest_; }

    int shares() const { return static_cast<int>(shares_.size()); }
    int sphere(int share) const { return shares_[share].sphere; }

    /// Calls visit(sphere, force, torque) with what a force on the point does to each sphere, by virtual work.
    template <typename Visit>
    void pull_back(const Vec3& f, const Visit& visit) const;
    /// Adds to the spheres' forces (rows) what a force on the point does to each.
    void add_force(const Vec3& f, double* force) const;
    /// d x / d step of each share's sphere (3 x 6).
    void jacobians(std::vector<Eigen::Matrix<double, 3, 6>>& by_share) const;
    /// How fast it moves with the spheres (rows of velocities) [mm/s].
    Vec3 velocity(const double* velocity) const;

private:
    struct Share {
        int sphere = 0;
        double w = 0;
        Mat3 A, B;  // what `follow` has beyond the mean motion, by moves and by turns
        Vec3 Y;     // from the mean centre at rest
        // as placed:
        Vec3 y = Vec3::Zero();  // from the mean centre [mm]
        double c = 1;           // (c, v): the sphere's turn beyond the mean's
        Vec3 v = Vec3::Zero();
    };
    std::vector<Share> shares_;  // the one of most weight first
    Vec3 rest_ = Vec3::Zero(), to_rest_ = Vec3::Zero();
    Mat3 R_ = Mat3::Identity();
    Vec3 x_ = Vec3::Zero(), arm_ = Vec3::Zero();
    double n_ = 1;
};

// With e_i and h_i the force as moves and turns of share i bear it: moves of all but by the mean, turns of each by what
// its part bears and by how the mean turns with it. See skeleton::CarriedPoint.
template <typename Visit>
void RuntimePoint::pull_back(const Vec3& f, const Visit& visit) const {
    const Vec3 g = R_.transpose() * f;
    const auto moved_by = [&](const Share& s) -> Vec3 { return R_ * (s.A.transpose() * g); };
    const auto turned_by = [&](const Share& s) -> Vec3 {
        const Vec3 h = R_ * (s.B.transpose() * g);
        return s.c * h + s.v.cross(h);
    };
    Vec3 all_moves = Vec3::Zero(), N = arm_.cross(f);
    for (const Share& s : shares_) {
        const Vec3 e = moved_by(s);
        all_moves += e;
        N -= s.y.cross(e) + turned_by(s);
    }
    for (const Share& s : shares_) {
        const Vec3 force = moved_by(s) + s.w * (f - all_moves);
        const Vec3 torque = turned_by(s) + (s.w / n_) * (s.c * N + s.v.cross(N));
        visit(s.sphere, force, torque);
    }
}

inline void RuntimePoint::add_force(const Vec3& f, double* force) const {
    pull_back(f, [&](int sphere, const Vec3& own_force, const Vec3& torque) {
        moves_of(force, sphere) += own_force;
        turns_of(force, sphere) += torque;
    });
}

}  // namespace palpate::runtime
