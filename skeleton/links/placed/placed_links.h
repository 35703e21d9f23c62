#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "skeleton/links/fibres/history_law.h"
#include "skeleton/links/full_link.h"
#include "skeleton/links/placed/grown_links.h"
#include "skeleton/links/placed/placed_volumes.h"
#include "skeleton/links/sections/section_law.h"
#include "skeleton/model/stiffness_order.h"

namespace palpate::skeleton {

/// Propagation of what fibres have been through from one state to the next, to first order. With z the three numbers
/// of each fibre (36L), as FibreState orders them,
///   d net force = force_by_flow dz_before, dz = flow_by_step step + flow_by_flow dz_before.
struct FlowDerivatives {
    Eigen::SparseMatrix<double> force_by_flow;  // [N] (6N x 36L)
    Eigen::SparseMatrix<double> flow_by_step;   // (36L x 6N)
    Eigen::SparseMatrix<double> flow_by_flow;   // (36L x 36L)
};

/// A model's links, with the effects in force that are in the material or in the links themselves. At stiffness
/// (kE, kF, kT) a link's energy is
///   s (kE e_E + kF e_F + kT e_T + torsion kF e_T + shear kE e_S + L^2 sum_j K_j (w(lambda_j) / 3 + p(lambda_j)))
/// with e_E, e_F, e_T as link_terms has them (a full link's as full_link_terms, with those of its other stiffnesses),
/// e_S of Shear, and over the fibres, of stiffnesses K_j (fibre_shares), w of the material
/// effects at the link's middle (uniaxial) and p of yielding and damage (history_terms). The factor of w is mu V = kE
/// L^2 / 3 for kE = E A / L, and E = 3 mu as the material keeps its volume. s is the material's scale: the mean over
/// the fibres in each slice of the link, whose softnesses add up. Where effects make a section's law (SectionLaw) of a
/// link, that is its law for what they do, with no fibres of theirs. So all is linear in the stiffnesses, conservative,
/// and the same after any rigid motion. Full links come with what keeps their spheres' volumes (PlacedVolumes).
class PlacedLinks {
public:
    PlacedLinks(const Model& model, const fem::Effects& effects);

    /// Energies at unit stiffness, each with all that goes with it. `before`, here and below: what the fibres had
    /// been through. @throws SolverFailure when ends of the link or of a fibre coincide.
    LinkTerms terms(size_t link, const LinkPose& ends, bool with_hessian, const FibreStates& before = {}) const;
    LinkTerms terms(size_t link, const State& state, bool with_hessian, const FibreStates& before = {}) const {
        return terms(link, pose(links_[link], state), with_hessian, before);
    }
    /// The sum of their second derivatives at stiffness k, at a third of the cost.
    Mat12 hessian(size_t link, const Stiffnesses& k, const LinkPose& ends, const FibreStates& before = {}) const;

    /// Terms and second derivatives as the linear law has them, whatever the link's neighbours: at rest, or as long as
    /// the material has grown (straight_poses), and strained by nothing.
    LinkTerms linear_terms(size_t link, const FibreStates& before = {}) const;
    Mat12 linear_hessian(size_t link, const Stiffnesses& k, const FibreStates& before = {}) const;

    const StiffnessOrder& order() const { return order_; }
    const PlacedVolumes& volumes() const { return volumes_; }
    /// s of each link; empty where no effect is in force.
    const std::vector<double>& scales() const { return scales_; }

    /// d net force / d k in a state (6N x stiffnesses, in their order): each column the force at unit stiffness.
    Eigen::SparseMatrix<double> forces(const State& state, const FibreStates& before = {}) const;
    /// The same after a step from rest (6N), to first order; how a link's forces change is that of its
    /// linear_terms.
    Eigen::SparseMatrix<double> linear_forces(const Eigen::VectorXd& step, const FibreStates& before = {}) const;

    /// What the fibres have been through once they stood in a state (12L); empty when nothing remembers.
    FibreStates flowed(const State& state, const FibreStates& before = {}) const;
    /// Its derivatives in a state at stiffnesses k. @pre the material remembers.
    FlowDerivatives flow_derivatives(const Eigen::VectorXd& k, const State& state,
                                     const FibreStates& before = {}) const;

    /// A link's stiffnesses at rest, with what effects add to them.
    Stiffnesses rest_stiffness(size_t link, const Stiffnesses& k) const;
    /// Largest force of a link's fibres at rest, at stiffnesses k [N]: of prestress, or what has flowed.
    double largest_rest_force(const Eigen::VectorXd& k, const FibreStates& before = {}) const;

private:
    double scale_of(const Link& link, const FibreOffsets& offsets, const fem::Effects& effects) const;
    bool has_law(size_t link) const { return !laws_.empty() && laws_[link].in_force; }
    /// A link without its natural strains.
    Link straight(size_t link) const;
    FullLink coupled(const Link& link, size_t place, const LinkPose& ends) const;
    LinkTerms terms_of(const Link& link, size_t place, const LinkPose& ends, bool with_hessian,
                       const FibreStates& before) const;
    Mat12 hessian_of(const Link& link, size_t place, const Stiffnesses& k, const LinkPose& ends,
                     const FibreStates& before) const;
    LinkFibre fibre(size_t link, int j, const LinkPose& ends) const;
    StretchTerms fibre_terms(size_t link, int j, double stretch, bool with_second, const FibreStates& before) const;
    void add_effects(size_t link, const LinkPose& ends, const FibreStates& before, bool with_hessian,
                     LinkTerms& terms) const;
    template <typename ForcesOf>
    Eigen::SparseMatrix<double> assembled(const ForcesOf& forces_of,
                                          std::vector<Eigen::Triplet<double>> of_volumes) const;

    StiffnessOrder order_;
    PlacedVolumes volumes_;
    std::vector<Link> links_;
    std::vector<Vec3> directions_;  // at rest (L)
    State rest_;
    std::vector<LinkPose> linear_poses_;                                // (L)
    std::vector<std::shared_ptr<const fem::MaterialEffect>> material_;  // those with an energy of their own
    HistoryLaw history_;
    double torsion_, shear_;
    bool plain_;                         // no effect is in force
    std::vector<double> scales_;         // s (L); empty when plain
    std::vector<SectionLaw> laws_;       // (L); empty where no effect acts in sections
    std::vector<char> in_sections_;      // of each effect in material_
    std::vector<FibreOffsets> offsets_;  // (L); empty when no fibre has an energy
    std::vector<FibreLengths> lengths_;  // where nothing strains them; the same
    std::vector<FibreShares> shares_;    // the same
};

}  // namespace palpate::skeleton
