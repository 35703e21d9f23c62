#include "identify/inference/domains/position/position_domain.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "identify/loading/history/load_history.h"
#include "identify/numerics/parallel.h"
#include "mesh/numbers/median.h"
#include "skeleton/effects/placed_effects.h"
#include "skeleton/loads/dent.h"
#include "skeleton/statics/equilibrium.h"
#include "skeleton/statics/statics.h"

namespace palpate::identify {
namespace {

std::shared_ptr<const skeleton::Model> with_law(const skeleton::Model& model, skeleton::EquilibriumLaw law) {
    auto copy = std::make_shared<skeleton::Model>(model);
    copy->law = law;
    return copy;
}

/// Do effects withstand displacements at rest, as a soft support does?
bool effects_have_stiffness(const skeleton::Model& model) {
    const skeleton::PlacedEffects effects(model, skeleton::physics_of(model.effects));
    return !std::ranges::all_of(effects.curvature(effects.rest()), [](const auto& block) { return block.isZero(0); });
}

}  // namespace

PositionDomain::PositionDomain(const skeleton::Model& model, skeleton::EquilibriumLaw law, Parameters parameters,
                               const std::vector<StateReadings>& readings, int threads)
    : model_(with_law(model, law)), parameters_(std::move(parameters)), threads_(threads) {
    dent_ = model_->dent;
    take_states(readings);
    take_law();
    G_rest_ = skeleton::link_forces(*model_, rest_state(*model_));
    goes_as_inverse_ = !effects_have_stiffness(*model_);
    std::vector<double> displacements(states_.size());
    std::ranges::transform(states_, displacements.begin(), &StateReadings::displacement);
    typical_displacement_ = mesh::upper_median(std::move(displacements));
    set_model_error(0.03);
}

/// Those that are informative, with what acts in each and where their markers hang.
void PositionDomain::take_states(const std::vector<StateReadings>& readings) {
    states_.clear();
    std::ranges::copy_if(readings, std::back_inserter(states_), &StateReadings::informs_stiffness);
    const skeleton::State rest = rest_state(*model_);
    const Eigen::VectorXd effects = skeleton::effect_force(*model_, rest);
    F_.resize(model_->dofs(), static_cast<Eigen::Index>(states_.size()));
    P_.clear();
    offsets_.clear();
    dents_.clear();
    for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
        P_.push_back(std::make_shared<Eigen::SparseMatrix<double>>(
            skeleton::observation_jacobian(*model_, rest, states_[s].points)));
        F_.col(s) = skeleton::external_force(*model_, rest, states_[s].load) + effects;
        offsets_.emplace_back(Points::Zero(states_[s].rest.rows(), 3));
        dents_.push_back(skeleton::dent_motions(states_[s].load, states_[s].rest));
        offsets_[s] += dented(s, dent_);
    }
}

PositionDomain PositionDomain::over(const std::vector<StateReadings>& readings, double model_error) const {
    PositionDomain result = *this;
    result.take_states(readings);
    result.solvers_ = std::make_shared<SolverPool>(*model_, result.states_);
    result.set_model_error(model_error);
    return result;
}

/// What the model's law is solved with.
void PositionDomain::take_law() {
    solvers_ = std::make_shared<SolverPool>(*model_, states_);
    strains_ = nullptr;
    if (law() == skeleton::EquilibriumLaw::linear) {
        linear_statics_ = std::make_shared<LinearStatics>(*model_);
        links_ = linear_statics_->links();
        if (std::optional<Strains> found = strains_of(*links_)) {
            strains_ = std::make_shared<const Strains>(std::move(*found));
        }
    } else {
        links_ = std::make_shared<LinksAtRest>(*model_);
    }
}

Prediction PositionDomain::predict_linear(const Eigen::VectorXd& k) const {
    Prediction prediction;
    prediction.tangents.push_back(linear_tangent(k));
    prediction.unmeasured.resize(states_.size());
    const Eigen::MatrixXd U = prediction.tangents.front()(F_.colwise() + G_rest_ * k);
    for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
        const Eigen::VectorXd moved = *P_[s] * U.col(s);
        prediction.markers.emplace_back(states_[s].rest + offsets_[s] +
                                        moved.reshaped<Eigen::RowMajor>(moved.size() / 3, 3));
        prediction.equilibria.push_back({.state = {}, .iterations = 1, .step = U.col(s)});
    }
    return prediction;
}

TangentSolve PositionDomain::linear_tangent(const Eigen::VectorXd& k) const {
    return [law = linear_statics_, factor = linear_statics_->factor(k)](const fem::MultiVector& F) {
        return factor->solve(F);
    };
}

/// A solver on loan, with all that it hangs on.
struct PositionDomain::Borrowed {
    explicit Borrowed(const PositionDomain& domain)
        : model(domain.model_), pool(domain.solvers_), solver(std::make_unique<SolverPool::Loan>(*pool)) {}
    std::shared_ptr<const skeleton::Model> model;
    std::shared_ptr<SolverPool> pool;
    std::unique_ptr<SolverPool::Loan> solver;
};

std::shared_ptr<PositionDomain::Borrowed> PositionDomain::borrow() const { return std::make_shared<Borrowed>(*this); }

TangentSolve PositionDomain::tangent_of(std::shared_ptr<Borrowed> borrowed) {
    return [borrowed = std::move(borrowed)](const fem::MultiVector& F) -> fem::MultiVector {
        return (**borrowed->solver).solve_tangent(F);
    };
}

TangentSolve PositionDomain::factored(const skeleton::Load& load, const Eigen::VectorXd& k,
                                      const skeleton::Equilibrium& at) const {
    std::shared_ptr<Borrowed> borrowed = borrow();
    (**borrowed->solver).factor_tangent(k, load, at);
    return tangent_of(std::move(borrowed));
}

Prediction PositionDomain::advanced(const Prediction& prediction, const ErrorJacobian& jacobian,
                                    const Eigen::VectorXd& step) const {
    Prediction result{prediction.equilibria, prediction.markers, {}, prediction.unmeasured};
    if (law() == skeleton::EquilibriumLaw::linear) return result;  // which starts from nowhere
    result.tangents = prediction.tangents;
    const Eigen::MatrixXd steps = jacobian.steps(step);
    Eigen::Index column = 0;
    const auto advance = [&](skeleton::Equilibrium& at) {
        at.state = skeleton::advance(at.state, steps.col(column++));
    };
    for (std::size_t s = 0; s < result.equilibria.size(); ++s) {
        std::ranges::for_each(result.unmeasured[s], advance);
        advance(result.equilibria[s]);
    }
    return result;
}

Prediction PositionDomain::predict(const Eigen::VectorXd& theta, int threads, const Prediction* start,
                                   bool for_jacobian) const {
    const Eigen::VectorXd k = parameters_.stiffness(theta);
    if (law() == skeleton::EquilibriumLaw::linear) return predict_linear(k);

    Prediction prediction;
    prediction.equilibria.resize(states_.size());
    prediction.markers.resize(states_.size());
    prediction.unmeasured.resize(states_.size());
    if (for_jacobian) prediction.tangents.resize(states_.size());
    for_each_in_parallel(static_cast<int>(states_.size()), is_history_dependent(states_) ? 1 : threads, [&](int s) {
        std::shared_ptr<Borrowed> borrowed = borrow();
        skeleton::StaticsSolver& solver = **borrowed->solver;
        LoadHistory history = history_before(*model_, solver, k, states_, s, prediction.equilibria,
                                             start != nullptr ? &start->unmeasured[s] : nullptr);
        const skeleton::State* from = start != nullptr ? &start->equilibria[s].state : nullptr;
        skeleton::EquilibriumOptions how;
        if (start != nullptr && !start->tangents.empty()) how.nearby = start->tangents[s];
        prediction.equilibria[s] = solver.solve(k, states_[s].load, how, from, history.flowed);
        prediction.unmeasured[s] = std::move(history.unmeasured);
        if (for_jacobian) prediction.tangents[s] = tangent_of(std::move(borrowed));
        prediction.markers[s] = observe(*model_, prediction.equilibria[s], states_[s].points) + offsets_[s];
    });
    return prediction;
}

Points PositionDomain::dented(int s, const Eigen::Matrix<double, 6, 1>& dent) const {
    const Eigen::VectorXd moved = dents_[s] * dent;
    return moved.reshaped<Eigen::RowMajor>(moved.size() / 3, 3);
}

bool PositionDomain::fit_dents(const Eigen::VectorXd& theta, Prediction& prediction) {
    std::vector<double> moduli;
    const Eigen::VectorXd k = parameters_.stiffness(theta);
    for (Eigen::Index l = 0; l < std::ssize(model_->links); ++l) {
        const skeleton::Link& link = model_->links[l];
        if (link.section && link.section->area > 0) moduli.push_back(k[3 * l] * link.length / link.section->area);
    }
    if (moduli.empty()) return false;
    Eigen::Matrix<double, 6, 6> H = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> g = Eigen::Matrix<double, 6, 1>::Zero();
    for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
        const Eigen::VectorXd error = errors(s, prediction.markers[s] - dented(s, dent_));  // without dents
        const Eigen::MatrixXd weighted = weights_[s].asDiagonal() * dents_[s];
        H += dents_[s].transpose() * weighted;
        g += weighted.transpose() * error;
    }
    if (H.isZero(0)) return false;
    H.diagonal().array() += Eigen::numext::abs2(mesh::upper_median(moduli));
    const Eigen::Matrix<double, 6, 1> found = H.ldlt().solve(g);
    for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
        const Points more = dented(s, found - dent_);
        offsets_[s] += more;
        prediction.markers[s] += more;
    }
    dent_ = found;
    return true;
}

Eigen::VectorXd PositionDomain::errors(int s, const Points& markers) const {
    const Points difference = states_[s].measured - markers;
    return difference.array().isNaN().select(0, difference).reshaped<Eigen::RowMajor>();
}

double PositionDomain::chi_squared(const Prediction& prediction) const {
    double sum = 0;
    for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
        sum += errors(s, prediction.markers[s]).cwiseAbs2().dot(weights_[s]);
    }
    return sum;
}

double PositionDomain::squared_distance(const Prediction& prediction) const {
    double sum = 0;
    for (int s = 0; s < static_cast<int>(states_.size()); ++s) sum += errors(s, prediction.markers[s]).squaredNorm();
    return sum;
}

double PositionDomain::common_factor(const Eigen::VectorXd& theta) const {
    if (!goes_as_inverse_) return 0;

    // measured displacement = what links pull at rest + scale x that of the loads, weighted least squares
    const Eigen::VectorXd k = parameters_.stiffness(theta);
    Eigen::MatrixXd F(F_.rows(), F_.cols() + 1);
    F << F_, G_rest_ * k;
    Eigen::MatrixXd U;
    if (linear_statics_) {
        U = linear_tangent(k)(F);
    } else {
        try {
            U = SolverPool::Loan(*solvers_)->linear_steps(k, F);
        } catch (const SolverFailure&) {
            return 0;  // stressed so much that it buckles at rest; large rotations may still find where it stands
        }
    }
    double up = 0, down = 0;
    for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
        const Eigen::VectorXd modelled = *P_[s] * U.col(s), pulled = *P_[s] * U.rightCols<1>();
        const Eigen::VectorXd weighted = weights_[s].cwiseProduct(modelled);
        const Points rest = states_[s].rest + pulled.reshaped<Eigen::RowMajor>(pulled.size() / 3, 3);
        up += weighted.dot(errors(s, rest));
        down += weighted.dot(modelled);
    }
    return up > 0 ? std::log(down / up) : 0;
}

PositionDomain PositionDomain::linearised(const Eigen::VectorXd& theta, const Prediction& prediction) const {
    PositionDomain result = *this;
    result.model_ = with_law(*model_, skeleton::EquilibriumLaw::linear);
    result.take_law();
    const Prediction linear = result.predict_linear(parameters_.stiffness(theta));
    for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
        result.offsets_[s] += prediction.markers[s] - linear.markers[s];
    }
    return result;
}

}  // namespace palpate::identify
