#pragma once

#include <array>
#include <vector>

#include "fem/rig/tendon_terms.h"
#include "skeleton/model/attachment/carried_point.h"

namespace palpate::skeleton {

/// A tendon that pulls at a skeleton: its first point is fixed in space, each other one hangs on the nearest link.
class PlacedTendon {
public:
    using Block = Eigen::Matrix<double, 6, 6>;

    PlacedTendon(const Model& model, fem::TendonPull pull);

    const fem::TendonPull& pull() const { return pull_; }
    /// `share`, here and below, scales its value: a load that is put on step by step.
    fem::TendonTerms terms(const State& state, double share = 1) const;
    fem::TendonFriction friction(const State& state) const;
    /// By the spheres: (6N x m) and (m x 6N).
    fem::TendonSliding sliding(const State& state) const;
    /// Adds `factor` times what is at each point to the spheres that carry it: to forces, what a gradient is (6N).
    void add(const State& state, const Points& at_points, double factor, Eigen::Ref<Eigen::VectorXd> sum) const;
    /// d^2 energy / d step^2 in exponential coordinates: calls visit(a, b, block) with a <= b, whose sum over all calls
    /// of two spheres is their block (a, b). Order and spheres of the calls are the same in every state.
    template <typename Visit>
    void for_each_block(const State& state, double share, const Visit& visit) const;

private:
    std::vector<CarriedPoint> carried(const State& state) const;  // all but the first
    Eigen::Matrix<double, 6, 1> step_to(const State& state, int sphere) const;
    Points path(const State& state) const;  // in small strain to first order

    State rest_;
    fem::TendonPull pull_;
    bool small_strain_;
    std::vector<Attachment> points_;  // all but the first
};

template <typename Visit>
void PlacedTendon::for_each_block(const State& state, double share, const Visit& visit) const {
    const fem::TendonTerms own = terms(state, share);
    const std::vector<CarriedPoint> at = carried(small_strain_ ? rest_ : state);
    const auto block_of = [&](std::size_t k, std::size_t l) -> Mat3 {
        return own.hessian.block<3, 3>(3 * static_cast<Eigen::Index>(k + 1), 3 * static_cast<Eigen::Index>(l + 1));
    };
    for (std::size_t k = 0; k < at.size(); ++k) {
        // by the points' motions, and by how a point's motion turns
        Eigen::MatrixXd turning = Eigen::MatrixXd::Zero(6 * at[k].shares(), 6 * at[k].shares());
        if (!small_strain_) turning = at[k].curvature(own.gradient.row(static_cast<Eigen::Index>(k + 1)));
        for (int i = 0; i < at[k].shares(); ++i) {
            for (int j = 0; j < at[k].shares(); ++j) {
                if (at[k].sphere(i) <= at[k].sphere(j))
                    visit(at[k].sphere(i), at[k].sphere(j), Block(turning.block<6, 6>(6 * i, 6 * j)));
            }
            for (std::size_t l = 0; l < at.size(); ++l) {
                const Eigen::Matrix<double, 6, 3> along = at[k].jacobian(i).transpose() * block_of(k, l);
                for (int j = 0; j < at[l].shares(); ++j) {
                    if (at[k].sphere(i) <= at[l].sphere(j))
                        visit(at[k].sphere(i), at[l].sphere(j), Block(along * at[l].jacobian(j)));
                }
            }
        }
    }
}

}  // namespace palpate::skeleton
