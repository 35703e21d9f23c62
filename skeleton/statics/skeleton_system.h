#pragma once

#include <map>
#include <optional>
#include <vector>

#include "skeleton/effects/placed_effects.h"
#include "skeleton/links/branches.h"
#include "skeleton/links/placed/placed_links.h"
#include "skeleton/loads/load.h"
#include "skeleton/statics/matrices/tangent_matrix.h"

namespace palpate::skeleton {

/// The net forces in a state, and the potential that they come from.
struct Balance {
    double potential = 0;  // [N mm]
    double rounding = 0;   // how well it is known [N mm]
    Eigen::VectorXd net;   // (6N), zero at held spheres [N, N mm]
    double largest = 0;    // of them [N], torques over the mean link length
};

/// A model's equations of equilibrium with held spheres eliminated, ready to be evaluated and factored for many
/// stiffnesses k (ordered as stiffness_vector), states and loads; its effects are in force.
class SkeletonSystem {
public:
    /// Keeps what it needs of the model. `effects`: all that are in force.
    /// @throws InvalidInput when no sphere is held or some hang on no held one, or as PlacedEffects.
    SkeletonSystem(const Model& model, const fem::Effects& effects);

    const Model& body() const { return body_; }  // spheres, links and law; held are those that nothing releases
    const PlacedEffects& effects() const { return effects_; }
    /// Where a search for an equilibrium begins: at rest, or grown from there.
    const State& start() const { return start_; }
    const PlacedLinks& links() const { return links_; }
    double length() const { return length_; }  // mean of the links [mm]

    /// How much of the effects is in force, but of those that hold the supports, and how far parts of the material have
    /// grown; 1 if not told otherwise.
    void scale_effects(double share);
    /// What the links' fibres had been through (12L); empty, as it is if not told otherwise: nothing.
    void remember(const FibreStates& before);
    const FibreStates& before() const { return before_; }

    Balance balance(const Eigen::VectorXd& k, const State& state, const Load& load) const;
    /// Largest force of a load, or of the effects at rest, on a free sphere or in a link [N].
    double largest_load(const Eigen::VectorXd& k, const State& state, const Load& load) const;
    /// Largest force on a free sphere, torques over the mean link length [N].
    double largest_force(const Eigen::VectorXd& f) const;
    /// What rounding of positions and angles leaves of forces that cancel [N].
    double force_rounding(const Eigen::VectorXd& k) const;
    /// Largest stiffness of links and effects, those of angles over the mean link length squared [N/mm].
    double stiffest(const Eigen::VectorXd& k) const;
    /// How much of a step can be made at once, (0, 1]: no sphere turns by more than half a radian, no link's ends part
    /// by more than half its length.
    double step_limit(const State& state, const Eigen::VectorXd& step) const;
    /// A state after a share of a step; along branches where there are some.
    State advance(const State& state, const Eigen::VectorXd& step, double share) const;

    /// Makes room for the couplings of a load's points and of the cavities that it presses apart.
    void prepare(const Load& load);
    /// Assembles the tangent; without a load the links' and effects' alone. By the linear law links change as where
    /// they are not strained, whatever the state.
    void assemble(const Eigen::VectorXd& k, const State& state, const Load* load = nullptr) {
        assemble(k, state, load, body_.law == EquilibriumLaw::linear);
    }
    /// The tangent at the start, of links that are not strained: where parts have grown they are, and may give way.
    void assemble_unstrained(const Eigen::VectorXd& k) { assemble(k, start_, nullptr, true); }
    /// Factors tangent + shift [N/mm] * metric, which makes turning and moving comparable.
    std::optional<BlockCholesky::BadPivot> factor(double shift);
    /// Factors the tangent. @throws SolverFailure naming the sphere that it does not keep in place.
    void factor_stable(const Eigen::VectorXd& k);
    [[noreturn]] void fail_at(const BlockCholesky::BadPivot& pivot, const Eigen::VectorXd& k) const;

    /// Solves with the last factor (6N x p); rows of held spheres are ignored, and zero in the result.
    Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const;
    Eigen::VectorXd metric_times(const Eigen::VectorXd& step) const;

private:
    void assemble(const Eigen::VectorXd& k, const State& state, const Load* load, bool unstrained);
    int coupling(int a, int b);
    void add_pairs(const std::vector<std::array<int, 2>>& pairs, const std::vector<int>& couplings,
                   const std::vector<BlockCholesky::Block>& blocks);

    Model body_;
    PlacedEffects effects_;
    PlacedLinks links_;
    State start_;
    std::optional<fem::Effects> growing_;  // in force, where parts of the material have grown
    FibreStates before_;
    double effect_share_ = 1;
    double effect_load_ = 0, effect_stiffness_ = 0;        // largest at rest [N, N/mm]
    std::vector<int> coupling_of_pair_;                    // of the effects, -1: one sphere alone, or an end is held
    std::vector<int> coupling_of_cell_;                    // the same, of the pairs of the volumes
    std::vector<int> free_;                                // spheres
    std::vector<int> block_of_;                            // place in `free_` of each sphere, -1: held
    std::vector<int> coupling_of_;                         // of each link, -1: an end is held
    std::vector<std::array<int, 2>> couplings_;            // of free spheres, by their places
    std::map<std::array<int, 2>, int> place_of_coupling_;  // of each pair of spheres a < b
    double length_ = 1, reach_ = 0;                        // largest coordinate [mm]
    BlockCholesky::Vec6 metric_;
    std::unique_ptr<TangentMatrix> matrix_;  // none: not assembled yet, or with other couplings
    Branches branches_;
};

}  // namespace palpate::skeleton
