#pragma once

#include <Eigen/SparseCore>
#include <memory>
#include <vector>

#include "fem/elements/dilatation.h"
#include "fem/large_deformation/body/element_regions.h"
#include "fem/large_deformation/body/node_weights.h"
#include "fem/large_deformation/body_equilibrium.h"
#include "fem/large_deformation/body_setting.h"
#include "fem/large_deformation/body_tangent.h"
#include "fem/rig/tendon_terms.h"
#include "fem/rig/tool_potential.h"
#include "fem/solver.h"
#include "mesh/core/volume_mesh.h"

namespace palpate::fem {

/// What a material that remembers has been through, point by point: how far it has flowed, and the greatest strain that
/// it bore; made by HyperelasticBody::state_after.
struct MaterialState;

/// A body of quadratic tetrahedra in large deformation: its elastic energy, forces, tangent and equilibria under dead
/// loads. Elements keep their volume in the mean (P2/P0), which does not lock near nu = 0.5. [Simo, Taylor & Pister
/// 1985] Degree of freedom 3 i + c is component c of node i. Const and safe from several threads; the same numbers on
/// any number of them.
class HyperelasticBody {
public:
    /// `held`: a flag per node (n). `solver`: of tangents; automatic takes a factor where it fits into the memory that
    /// is free when it is first asked for. @throws InvalidInput when elements are not quadratic or turned inside out,
    /// or too little is held to stop rigid motion.
    HyperelasticBody(mesh::VolumeMesh mesh, std::vector<char> held, Dilatation dilatation = Dilatation::mean,
                     ElementRegions regions = {}, Solver solver = Solver::automatic);
    ~HyperelasticBody();
    HyperelasticBody(HyperelasticBody&&) noexcept;

    const mesh::VolumeMesh& mesh() const;
    const std::vector<char>& held() const;
    NodeWeights points(ActsOn what, double density) const;

    /// Elastic energy and effects less the work of the dead load f (3n) [N mm]; infinite where an element is inside
    /// out.
    /// `before`, here and below: what a material that remembers had been through, under the same law; none: it is
    /// virgin. While it flows forces are no potential's gradient, and this one is near the truth.
    double potential(const Eigen::VectorXd& u, const BodySetting& setting, const Eigen::VectorXd& f,
                     const MaterialState* before = nullptr) const;
    /// Net force f - d(energy)/du on every node (3n) [N]; at held nodes minus the support's reaction.
    /// @throws SolverFailure where an element is inside out.
    Eigen::VectorXd residual(const Eigen::VectorXd& u, const BodySetting& setting, const Eigen::VectorXd& f,
                             const MaterialState* before = nullptr) const;
    /// J of all nodes, held ones too (3n x 3n), symmetric, both halves [N/mm]. Where the body flows, the
    /// consistent tangent's symmetric part.
    Eigen::SparseMatrix<double> tangent(const Eigen::VectorXd& u, const BodySetting& setting,
                                        const MaterialState* before = nullptr) const;
    /// @throws SolverFailure when J is not positive definite on the free nodes.
    std::shared_ptr<const BodyTangent> factor(const Eigen::VectorXd& u, const BodySetting& setting,
                                              const MaterialState* before = nullptr) const;
    /// What the material has been through once it stood in u; null where it does not remember. @throws as residual.
    std::shared_ptr<const MaterialState> state_after(const Eigen::VectorXd& u, const BodySetting& setting,
                                                     const MaterialState* before) const;

    /// Internal forces at unit moduli (3n x 2 materials), of the body's own material and then of each region's: the
    /// internal force is the sum of mu * column 2m + K * column 2m + 1. Effects in the material are shares of mu, and
    /// in column 2m.
    Eigen::MatrixXd modulus_forces(const Eigen::VectorXd& u, const BodySetting& setting,
                                   const MaterialState* before = nullptr) const;
    /// Internal forces of weighted elements (3n x c): column j is sum_e W(e, j) f_e; W (elements x c).
    Eigen::MatrixXd element_forces(const Eigen::VectorXd& u, const BodySetting& setting, const Eigen::MatrixXd& W,
                                   const MaterialState* before = nullptr) const;

    /// The displacement in which the net force vanishes at the free nodes: Newton's method on the potential with line
    /// search, started from the linear answer or a neighbouring state `start`, factors reused while they serve;
    /// load stepping when it fails at once. A body that yields flows at once from what it was `before`: a load that
    /// turns on its way is better put on in parts, each from the plastic state of the one before. @throws SolverFailure
    /// with iterations and residual when none was found.
    /// `guide`: the tangent of a state nearby, factored by this body; steps are taken by it for as long as they serve.
    BodyEquilibrium equilibrium(const BodySetting& setting, const Eigen::VectorXd& f, const NewtonOptions& options = {},
                                const Eigen::VectorXd* start = nullptr, const MaterialState* before = nullptr,
                                const BodyTangent* guide = nullptr) const;

    // Tools and tendons in a displacement u.

    /// Force of a tool on the body and moment about the tool's moved origin, by virtual work [N, N mm].
    Wrench wrench(const Eigen::VectorXd& u, const std::shared_ptr<const ToolPotential>& tool) const;
    /// How it changes with u, and by how much the forces on the nodes fall with a step of the pose, three translations
    /// and turns about the moved origin: d wrench/du = M^T, d residual/d pose = -M (3n x 6).
    Eigen::MatrixXd wrench_derivative(const Eigen::VectorXd& u, const std::shared_ptr<const ToolPotential>& tool) const;
    /// How it changes with the pose where the nodes stay (6 x 6).
    Eigen::Matrix<double, 6, 6> wrench_by_pose(const Eigen::VectorXd& u,
                                               const std::shared_ptr<const ToolPotential>& tool) const;
    /// Forces on the nodes (3n) that are, by tools and tendons of a given length, proportional to the Young's modulus
    /// that these know [N].
    Eigen::VectorXd grip_forces(const Eigen::VectorXd& u, const BodySetting& setting) const;
    TendonState tendon_state(const Eigen::VectorXd& u, const TendonPull& pull, bool small_strain) const;
    /// d(drawn in)/du and d(tension)/du (3n x 2).
    Eigen::MatrixXd tendon_derivative(const Eigen::VectorXd& u, const TendonPull& pull, bool small_strain) const;
    /// By how much the forces on the nodes grow with a tendon's value (3n), or with the pressure in a cavity.
    Eigen::VectorXd tendon_push(const Eigen::VectorXd& u, const TendonPull& pull, bool small_strain) const;
    /// What friction makes of it there, and how the forces of the nodes and friction follow each other: d gradient / d
    /// number (3n x m), d number / du (m x 3n). Tangents hold friction.
    TendonFriction tendon_friction(const Eigen::VectorXd& u, const TendonPull& pull, bool small_strain) const;
    TendonSliding tendon_sliding(const Eigen::VectorXd& u, const TendonPull& pull, bool small_strain) const;
    Eigen::VectorXd cavity_push(const Eigen::VectorXd& u, const mesh::PressureActuator& actuator,
                                bool small_strain) const;

    /// Does the boundary close in cavities within the body, which can be under pressure?
    bool has_cavities() const;
    /// Of each cavity [mm^3].
    Eigen::VectorXd cavity_volumes(const Eigen::VectorXd& u) const;
    /// The one that an actuator means, by its place in cavity_volumes. @throws InvalidInput where there are none.
    int find_cavity(const mesh::PressureActuator& actuator) const;
    /// Volume of all cavities together in the displacement u [mm^3]; 0 where there are none.
    double cavity_volume(const Eigen::VectorXd& u) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::fem
