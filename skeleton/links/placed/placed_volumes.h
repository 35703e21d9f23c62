#pragma once

#include <Eigen/SparseCore>
#include <array>
#include <vector>

#include "skeleton/links/link_energy.h"
#include "skeleton/model/link_pose.h"

namespace palpate::skeleton {

/// What keeps the spheres' cells at their volume. The faces of a cell are the sections of its links, and each moves
/// with half of its link's elongation s (FullLink), so at unit stiffness a sphere's energy is
///   1/2 V theta^2,  theta = 1/2 sum_l A_l s_l / V:
/// Hooke's law has a first constant of Lame beside what the links bear. Paper's links have no sections, and no such
/// energy. Conservative, and the same after any rigid motion. Effects that scale the material's stiffness scale it too.
class PlacedVolumes {
public:
    using Block = Eigen::Matrix<double, 6, 6>;

    PlacedVolumes(const Model& model, const fem::Effects& effects);

    bool empty() const { return cells_.empty(); }
    /// Spheres a < b, or a == b, that share a cell: where the second derivative has its blocks.
    const std::vector<std::array<int, 2>>& pairs() const { return pairs_; }

    /// `k`, here and below: all stiffnesses, as stiffness_vector orders them. [N mm]
    double energy(const Eigen::VectorXd& k, const State& state) const;
    /// - d energy / d step (6N).
    Eigen::VectorXd force(const Eigen::VectorXd& k, const State& state) const;
    /// The block (a, b) of d^2 energy / d step^2 of each pair.
    std::vector<Block> curvature(const Eigen::VectorXd& k, const State& state) const {
        return curvature(k, poses(state));
    }
    /// The same in the linear law (PlacedLinks::linear_terms).
    std::vector<Block> linear_curvature(const Eigen::VectorXd& k) const { return curvature(k, linear_poses_); }

    /// Adds d net force / d k to the triplets of a matrix (6N x stiffnesses).
    void add_forces(const State& state, std::vector<Eigen::Triplet<double>>& entries) const;
    /// The same after a step from rest, to first order.
    void add_linear_forces(const Eigen::VectorXd& step, std::vector<Eigen::Triplet<double>>& entries) const;

private:
    struct Cell {
        int sphere = 0;
        Eigen::Index place = 0;  // of its stiffness in k
        double volume = 0;       // [mm^3]
        double scale = 1;        // of the material
        std::vector<int> links;
    };
    // A link's elongation now, times half of its section; and how it changes with the step of its ends.
    struct Swelling {
        double volume = 0;
        Vec12 gradient = Vec12::Zero();
    };
    std::vector<LinkPose> poses(const State& state) const;  // (L)
    std::vector<Swelling> swellings(const std::vector<LinkPose>& poses) const;
    std::vector<Block> curvature(const Eigen::VectorXd& k, const std::vector<LinkPose>& poses) const;
    // theta V, and its derivative where it is not zero: a sphere and six entries each.
    using Gradient = std::vector<std::pair<int, Eigen::Matrix<double, 6, 1>>>;
    Gradient gradient_of(const Cell& cell, const std::vector<Swelling>& swellings, double& change) const;

    std::vector<Link> links_;
    State rest_;
    std::vector<LinkPose> linear_poses_;
    std::vector<Cell> cells_;
    std::vector<std::array<int, 2>> pairs_;
    std::vector<std::vector<int>> pair_of_;  // of each cell: of each pair of its spheres, in the order of Gradient
    std::vector<int> pair_of_link_;          // (a, b) of each link, (a, a) and (b, b), -1 for a link of no cell (3L)
};

}  // namespace palpate::skeleton
