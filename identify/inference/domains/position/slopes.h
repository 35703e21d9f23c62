#pragma once

#include <Eigen/SparseCore>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "identify/inference/domains/position/links/link_signatures.h"

namespace palpate::identify {

/// T^-1 F (6N x n), of F (6N x n), with the factored tangent T = -dr/dx of an equilibrium; keeps alive what it needs.
using TangentSolve = std::function<fem::MultiVector(const fem::MultiVector& F)>;

/// Predecessor of a state of a history-dependent material, and the derivatives of its plastic flow.
struct FlowHistory {
    int before = -1;  // state that went before; -1: the body was new
    skeleton::FlowDerivatives flow;
};

/// Derivatives J = dd / dtheta of the errors d = (measured - modelled) / sigma at one theta, by its equilibria.
///
/// In equilibrium r(x, k) = f_ext + G k = 0, effects in the links (G) and others (f_ext) included, so dx/dk = T^-1 G
/// with the tangent T = -dr/dx, and a marker moves by P T^-1 G dk/dtheta: exact, for one factorisation a state (linear
/// law: one in all). J^T J (P x P) is not made; its products cost two solves a state and column.
///
/// For a history-dependent material the plastic strain z at the start of a state depends on theta as well: T dx = G dk
/// + force_by_flow dz. So states are gone through in their order, and transposed products in the opposite one.
class ErrorJacobian {
public:
    /// What a state contributes.
    struct State {
        LinkSignatures G;                                      // dr/dk
        std::shared_ptr<const Eigen::SparseMatrix<double>> P;  // d markers / d step (3m x 6N); none: it was not read
        Eigen::VectorXd weights;                               // W, 1 / sigma^2 (3m)
        Eigen::VectorXd errors;                                // measured - modelled (3m)
        std::optional<FlowHistory> history = {};               // where the material remembers
    };

    /// `states`: with those that were not read, where one that was read lived through them before. `dk`: dk/dtheta.
    /// `tangents`: of each state, or one for all.
    ErrorJacobian(std::vector<State> states, const Eigen::SparseMatrix<double>& dk, std::vector<TangentSolve> tangents,
                  int threads);

    Eigen::VectorXd gradient() const;                                 // of half the chi^2, J^T d (P)
    Eigen::MatrixXd curvature_times(const Eigen::MatrixXd& V) const;  // J^T J V, of V (P x n)
    /// J^T D (P x n), of what the errors of each state that was read may be (3m x n), over sigma.
    Eigen::MatrixXd transposed_times(const std::vector<Eigen::MatrixXd>& D) const;
    /// How the states follow a step of theta, to first order: T^-1 G dk/dtheta step, a column each, unmeasured ones too
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
    fem::MultiVector moved(const States& states, const fem::MultiVector& K) const;   // T^-1 G K, state after state
    fem::MultiVector pulled(const States& states, const fem::MultiVector& F) const;  // sum of G^T T^-1 F
    // The same for states that were lived through: of each up to `last`, and of all.
    std::vector<fem::MultiVector> moved_through(int last, const fem::MultiVector& K) const;
    fem::MultiVector pulled_through(std::vector<fem::MultiVector> F) const;
    bool is_history_dependent() const { return states_.front().history.has_value(); }
    /// P^T W P X of a state, zero for one that was not read.
    static fem::MultiVector seen(const State& state, const fem::MultiVector& X);

    std::vector<State> states_;
    std::vector<int> read_;
    Eigen::SparseMatrix<double> dk_;  // (stiffnesses x P)
    std::vector<TangentSolve> tangents_;
    int threads_;
};

}  // namespace palpate::identify
