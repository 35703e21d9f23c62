#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "fem/large_deformation/body/unknowns.h"
#include "fem/rig/tendon_terms.h"

namespace palpate::fem {

/// The path of a tendon in a body of finite elements: its first point is fixed in space, elements carry the others.
struct TendonPath {
    /// @throws InvalidInput when a point but the first lies outside of the body by more than half an edge.
    TendonPath(const mesh::VolumeMesh& mesh, const mesh::TendonActuator& tendon);
    std::vector<std::vector<std::pair<int, double>>> carriers;  // of each point: nodes and what they weigh
    std::vector<int> nodes;                                     // all of them, each once
};

/// Paths of tendons in one body, each found once. Safe from several threads.
class TendonPaths {
public:
    const TendonPath& operator()(const mesh::VolumeMesh& mesh,
                                 const std::shared_ptr<const mesh::TendonActuator>& tendon) const;

private:
    mutable std::mutex mutex_;
    mutable std::map<std::shared_ptr<const mesh::TendonActuator>, std::unique_ptr<const TendonPath>> known_;
};

/// A tendon that pulls at a body.
class PlacedTendon {
public:
    PlacedTendon(const TendonPath& path, TendonPull pull, bool small_strain)
        : path_(path), pull_(std::move(pull)), small_strain_(small_strain) {}

    const TendonPull& pull() const { return pull_; }
    TendonTerms terms(const Eigen::VectorXd& u) const;
    /// Pi [N mm]; adds `factor` dPi/du to `sum` (3n).
    double add_gradient(const Eigen::VectorXd& u, double factor, Eigen::VectorXd& sum) const;
    /// Adds d^2 Pi / du^2.
    void add_hessian(const Eigen::VectorXd& u, const Unknowns& unknowns, LowerMatrix& K) const;

    /// d(drawn in)/du and d(tension)/du (3n x 2).
    Eigen::MatrixXd derivative(const Eigen::VectorXd& u) const;
    /// - d gradient / d value (3n).
    Eigen::VectorXd push(const Eigen::VectorXd& u) const;
    TendonFriction friction(const Eigen::VectorXd& u) const;
    /// By the nodes: (3n x m) and (m x 3n).
    TendonSliding sliding(const Eigen::VectorXd& u) const;

private:
    Points place(const Eigen::VectorXd& u) const;
    void add(const Points& at_points, Eigen::Ref<Eigen::VectorXd> sum) const;

    const TendonPath& path_;
    TendonPull pull_;
    bool small_strain_;
};

}  // namespace palpate::fem
