#pragma once

#include <Eigen/SparseCore>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "identify/fit/link_signatures.h"

namespace palpate::identify {

/// T^-1 F (6N x n), of F (6N x n), with the factored tangent T = -dr/dx of an equilibrium; keeps alive what it needs.
using TangentSolve = std::function<fem::Block(const fem::Block& F)>;

/// What comes before a state, where the material remembers, and how it hands on what has flowed.
struct Life {
    int before = -1;  // state that went before; -1: the body was new
    skeleton::FlowSlopes flow;
};

/// Derivatives J = dd / dtheta of the errors d = (measured - modelled) / sigma at one theta, by its equilibria.
///
/// In equilibrium r(x, k) = f_ext + G k = 0, effects in the links (G) and others (f_ext) included, so dx/dk = T^-1 G
/// with the tangent T = -dr/dx, and a marker moves by P T^-1 G dk/dtheta: exact, for one factorisation a state (linear
/// law: one in all). J^T J (P x P) is not made; its products cost two solves a state and column.
///
/// Where the material remembers, what had flowed by then, z, changes with theta too, and pulls: T dx = G dk + pulls dz.
/// So states are gone through in their order, and transposed products in the opposite one.
class Slopes {
public:
    /// What a state contributes.
    struct State {
        LinkSignatures G;                                      // dr/dk
        std::shared_ptr<const Eigen::SparseMatrix<double>> P;  // d markers / d step (3m x 6N); none: nobody read it
        Eigen::VectorXd weights;                               // W, 1 / sigma^2 (3m)
        Eigen::VectorXd errors;                                // measured - modelled (3m)
        std::optional<Life> life = {};                         // where the material remembers
    };

    /// `states`: with those that nobody read, where one that was read lived through them before. `dk`: dk/dtheta.
    /// `tangents`: of each state, or one for all.
    Slopes(std::vector<State> states, const Eigen::SparseMatrix<double>& dk, std::vector<TangentSolve> tangents,
           int threads);

    Eigen::VectorXd gradient() const;                                 // of half the chi^2, J^T d (P)
    Eigen::MatrixXd curvature_times(const Eigen::MatrixXd& V) const;  // J^T J V, of V (P x n)
    /// J^T D (P x n), of what the errors of each state that was read may be (3m x n), over sigma.
    Eigen::MatrixXd transposed_times(const std::vector<Eigen::MatrixXd>& D) const;
    /// How the states follow a step of theta, to first order: T^-1 G dk/dtheta step, a column each, unread ones too
    /// (6N x states).
    Eigen::MatrixXd steps(const Eigen::VectorXd& step) const;
    // Of the states that were read, numbered without the others.
    int count_read() const { return static_cast<int>(read_.size()); }
    /// How a state's markers follow steps of theta, V (P x n), to first order (3m x n).
    Eigen::MatrixXd moved_markers(int state, const Eigen::MatrixXd& V) const;
    const Eigen::VectorXd& weights(int state) const { return states_[read_[state]].weights; }
    const Eigen::VectorXd& errors(int state) const { return states_[read_[state]].errors; }

private:
    using States = std::vector<int>;
    /// States that are solved for at once, with n columns each.
    std::vector<States> together(Eigen::Index n) const;
    const TangentSolve& tangent(const States& states) const;
    fem::Block moved(const States& states, const fem::Block& K) const;   // T^-1 G K, state after state
    fem::Block pulled(const States& states, const fem::Block& F) const;  // sum of G^T T^-1 F
    // The same for states that were lived through: of each up to `last`, and of all.
    std::vector<fem::Block> lived(int last, const fem::Block& K) const;
    fem::Block pulled_through(std::vector<fem::Block> F) const;
    bool remembers() const { return states_.front().life.has_value(); }
    /// P^T W P X of a state, zero for one that nobody read.
    static fem::Block seen(const State& state, const fem::Block& X);

    std::vector<State> states_;
    std::vector<int> read_;
    Eigen::SparseMatrix<double> dk_;  // (stiffnesses x P)
    std::vector<TangentSolve> tangents_;
    int threads_;
};

}  // namespace palpate::identify
