#include "identify/fit/position_domain.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "identify/fit/lived.h"
#include "identify/parallel.h"
#include "skeleton/dent.h"
#include "skeleton/effects/placed_effects.h"
#include "skeleton/statics.h"

namespace palpate::identify {
namespace {

constexpr double readings_per_state = 6;  // that a state's coordinates count as, of the model error
constexpr int batch = 8;                  // states whose normal equations are held at once, whatever the threads

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

double square(double x) { return x * x; }

double noise_of(double sigma) { return std::isnan(sigma) ? 0 : sigma; }

/// Measured less modelled, zero for a missing coordinate (3m).
Eigen::VectorXd errors_of(const StateReadings& state, const Points& markers) {
    const Points difference = state.measured - markers;
    return difference.array().isNaN().select(0, difference).reshaped<Eigen::RowMajor>();
}

/// Adds the lower half of factor G^T S G, of a symmetric S (n x n) and a sparse G (n x P), by strips that stay in the
/// cache.
void add_congruence(double factor, const Eigen::MatrixXd& S, const Eigen::SparseMatrix<double>& G, Eigen::MatrixXd& H) {
    using Entry = Eigen::SparseMatrix<double>::InnerIterator;
    constexpr Eigen::Index width = 128;
    for (Eigen::Index begin = 0; begin < G.cols(); begin += width) {
        const Eigen::Index end = std::min(begin + width, G.cols());
        // rows begin..end of G^T S
        Eigen::MatrixXd SG = Eigen::MatrixXd::Zero(S.rows(), end - begin);
        for (Eigen::Index p = begin; p < end; ++p) {
            for (Entry g(G, p); g; ++g) SG.col(p - begin) += factor * g.value() * S.col(g.row());
        }
        const Eigen::MatrixXd GS = SG.transpose();
        // times the columns of G, not above the diagonal
        for (Eigen::Index p = 0; p < end; ++p) {
            const Eigen::Index first = std::max(begin, p), count = end - first;
            for (Entry g(G, p); g; ++g) H.col(p).segment(first, count) += g.value() * GS.col(g.row()).tail(count);
        }
    }
}

std::shared_ptr<const skeleton::Model> with_law(const skeleton::Model& model, skeleton::Law law) {
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

PositionDomain::PositionDomain(const skeleton::Model& model, skeleton::Law law, Parameters parameters,
                               const std::vector<StateReadings>& readings, int threads)
    : model_(with_law(model, law)),
      solvers_(std::make_shared<SolverPool>(*model_)),
      parameters_(std::move(parameters)),
      threads_(threads) {
    std::ranges::copy_if(readings, std::back_inserter(states_), &StateReadings::tells_stiffness);

    const skeleton::State rest = rest_state(*model_);
    const Eigen::VectorXd effects = skeleton::effect_force(*model_, rest);
    G_rest_ = skeleton::link_forces(*model_, rest);
    goes_as_inverse_ = !effects_have_stiffness(*model_);
    F_.resize(model_->dofs(), static_cast<Eigen::Index>(states_.size()));
    std::vector<double> displacements;
    for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
        P_.push_back(skeleton::observation_jacobian(*model_, rest, states_[s].points));
        F_.col(s) = skeleton::external_force(*model_, rest, states_[s].load) + effects;
        offsets_.emplace_back(Points::Zero(states_[s].rest.rows(), 3));
        displacements.push_back(states_[s].displacement);
        dents_.push_back(skeleton::dent_motions(states_[s].load, states_[s].rest));
    }
    dent_ = model_->dent;
    for (int s = 0; s < static_cast<int>(states_.size()); ++s) offsets_[s] += dented(s, dent_);
    typical_displacement_ = median(displacements);
    set_model_error(0.03);
}

int PositionDomain::coordinates() const {
    return std::accumulate(states_.begin(), states_.end(), 0,
                           [](int sum, const StateReadings& state) { return sum + state.coordinates; });
}

int PositionDomain::effective_coordinates() const {
    return std::accumulate(states_.begin(), states_.end(), 0, [](int sum, const StateReadings& state) {
        return sum + std::min(state.coordinates, static_cast<int>(readings_per_state));
    });
}

void PositionDomain::set_model_error(double rel) {
    weights_.clear();
    log_constant_ = 0;
    for (const StateReadings& state : states_) {
        const double share = std::max(1.0, state.coordinates / readings_per_state);
        const double model_variance =
            share * square(rel) * (square(state.displacement) + square(typical_displacement_ / 3));
        Eigen::VectorXd weights = Eigen::VectorXd::Zero(3 * state.rest.rows());
        for (Eigen::Index i = 0; i < state.rest.rows(); ++i) {
            const double variance = square(noise_of(state.noise[i])) + model_variance;
            for (int c = 0; c < 3; ++c) {
                if (std::isnan(state.measured(i, c))) continue;
                weights[3 * i + c] = 1 / variance;
                log_constant_ -= 0.5 * std::log(2 * std::numbers::pi * variance);
            }
        }
        weights_.push_back(std::move(weights));
    }
}

double PositionDomain::estimate_model_error(const Prediction& prediction) const {
    // rel^2 of each state; the median of a mean of six squares lies at 0.89 of its expectation
    std::vector<double> squares;
    for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
        const StateReadings& state = states_[s];
        const double noise = state.noise.unaryExpr(&noise_of).squaredNorm() / static_cast<double>(state.noise.size());
        const double left = errors_of(state, prediction.markers[s]).squaredNorm() / state.coordinates;
        squares.push_back(std::max(0.0, left - noise) /
                          (square(state.displacement) + square(typical_displacement_ / 3)));
    }
    return std::sqrt(median(squares) / 0.89);
}

Prediction PositionDomain::predict_linear(const Eigen::VectorXd& k) const {
    const SolverPool::Loan solver(*solvers_);
    const Eigen::MatrixXd U = solver->linear_steps(k, F_.colwise() + G_rest_ * k);
    Prediction prediction;
    for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
        const Eigen::VectorXd moved = P_[s] * U.col(s);
        prediction.markers.emplace_back(states_[s].rest + offsets_[s] +
                                        moved.reshaped<Eigen::RowMajor>(moved.size() / 3, 3));
        prediction.equilibria.push_back({.state = {}, .iterations = 1, .step = U.col(s)});
    }
    return prediction;
}

Prediction PositionDomain::predict(const Eigen::VectorXd& theta, int threads, const Prediction* start) const {
    const Eigen::VectorXd k = parameters_.stiffness(theta);
    if (law() == skeleton::Law::linear) return predict_linear(k);

    Prediction prediction;
    prediction.equilibria.resize(states_.size());
    prediction.markers.resize(states_.size());
    for_each_in_parallel(static_cast<int>(states_.size()), remembers(states_) ? 1 : threads, [&](int s) {
        const SolverPool::Loan solver(*solvers_);
        const skeleton::FibreStates before = flowed_before(*model_, *solver, k, states_, s, prediction.equilibria);
        const skeleton::State* from = start != nullptr ? &start->equilibria[s].state : nullptr;
        prediction.equilibria[s] = solver->solve(k, states_[s].load, {}, from, before);
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
        const Eigen::VectorXd error = errors_of(states_[s], prediction.markers[s] - dented(s, dent_));  // without dents
        const Eigen::MatrixXd weighted = weights_[s].asDiagonal() * dents_[s];
        H += dents_[s].transpose() * weighted;
        g += weighted.transpose() * error;
    }
    if (H.isZero(0)) return false;
    H.diagonal().array() += square(median(moduli));
    const Eigen::Matrix<double, 6, 1> found = H.ldlt().solve(g);
    for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
        const Points more = dented(s, found - dent_);
        offsets_[s] += more;
        prediction.markers[s] += more;
    }
    dent_ = found;
    return true;
}

double PositionDomain::chi_squared(const Prediction& prediction) const {
    double sum = 0;
    for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
        sum += errors_of(states_[s], prediction.markers[s]).cwiseAbs2().dot(weights_[s]);
    }
    return sum;
}

Eigen::SparseMatrix<double> PositionDomain::observation(int s, const Prediction& prediction) const {
    if (law() == skeleton::Law::linear) return P_[s];
    return observation_jacobian(*model_, prediction.equilibria[s], states_[s].points);
}

NormalEquations PositionDomain::from_the_right(int s, const Eigen::SparseMatrix<double>& G_theta,
                                               const Prediction& prediction,
                                               const skeleton::StaticsSolver& solver) const {
    // J = P (T^-1 G_theta)
    const Eigen::MatrixXd J = observation(s, prediction) * solver.solve_tangent(Eigen::MatrixXd(G_theta));
    const Eigen::VectorXd error = errors_of(states_[s], prediction.markers[s]);
    return {J.transpose() * weights_[s].asDiagonal() * J, -J.transpose() * weights_[s].cwiseProduct(error)};
}

PositionDomain::PullBack PositionDomain::pull_back(int s, const Prediction& prediction,
                                                   const skeleton::StaticsSolver& solver) const {
    PullBack result{s, solver.solve_tangent(Eigen::MatrixXd(observation(s, prediction).transpose())), {}};
    result.XWX.noalias() = result.X * (weights_[s].asDiagonal() * result.X.transpose());
    return result;
}

NormalEquations PositionDomain::from_the_left(int s, const Eigen::SparseMatrix<double>& G_theta,
                                              const Prediction& prediction, const PullBack& pull_back,
                                              double ratio) const {
    // J^T W J = G_theta^T (X W X^T) G_theta
    const Eigen::VectorXd error = errors_of(states_[s], prediction.markers[s]);
    NormalEquations result{Eigen::MatrixXd::Zero(G_theta.cols(), G_theta.cols()), {}};
    add_congruence(ratio, pull_back.XWX, G_theta, result.H);
    result.g = -G_theta.transpose() * (pull_back.X * weights_[s].cwiseProduct(error));
    return result;
}

/// By the linear law states with the same markers share a pull-back but for one factor, where their weights do.
std::optional<double> PositionDomain::weight_ratio(int s, int other) const {
    if (s == other) return 1;
    if (law() != skeleton::Law::linear || states_[s].markers != states_[other].markers) return std::nullopt;
    const double ratio = weights_[s].sum() / weights_[other].sum();
    if (!weights_[s].isApprox(ratio * weights_[other], 1e-12)) return std::nullopt;
    return ratio;
}

NormalEquations PositionDomain::normal_equations(const Eigen::VectorXd& theta, const Prediction& prediction) const {
    const Eigen::VectorXd k = parameters_.stiffness(theta);
    const Eigen::SparseMatrix<double> dk = parameters_.derivative(k);
    const int P = parameters_.size(), states = static_cast<int>(states_.size());
    NormalEquations sum{Eigen::MatrixXd::Zero(P, P), Eigen::VectorXd::Zero(P)};

    // the linear law has one tangent for all states
    const SolverPool::Loan shared(*solvers_);
    const bool linear = law() == skeleton::Law::linear;
    if (linear) shared->factor_tangent(k, states_[0].load, prediction.equilibria[0]);

    // and states that read the same markers share the way back
    std::optional<PullBack> common;
    if (linear && P > 3 * states_[0].rest.rows()) common = pull_back(0, prediction, *shared);

    for (int first = 0; first < states; first += batch) {
        std::vector<NormalEquations> parts(std::min(batch, states - first));
        for_each_in_parallel(static_cast<int>(parts.size()), threads_, [&](int i) {
            const int s = first + i;
            const Eigen::SparseMatrix<double> G_theta = skeleton::link_forces(*model_, prediction.equilibria[s]) * dk;
            const SolverPool::Loan own(*solvers_);
            if (!linear) own->factor_tangent(k, states_[s].load, prediction.equilibria[s]);
            const skeleton::StaticsSolver& solver = linear ? *shared : *own;
            if (P <= 3 * states_[s].rest.rows()) {
                parts[i] = from_the_right(s, G_theta, prediction, solver);
            } else if (const auto ratio = common ? weight_ratio(s, common->state) : std::nullopt) {
                parts[i] = from_the_left(s, G_theta, prediction, *common, *ratio);
            } else {
                parts[i] = from_the_left(s, G_theta, prediction, pull_back(s, prediction, solver), 1);
            }
        });
        for (const NormalEquations& part : parts) {
            sum.H += part.H;
            sum.g += part.g;
        }
    }
    sum.H.triangularView<Eigen::StrictlyUpper>() = sum.H.transpose();
    return sum;
}

double PositionDomain::common_factor(const Eigen::VectorXd& theta) const {
    if (!goes_as_inverse_) return 0;

    // measured displacement = what links pull at rest + scale x that of the loads, weighted least squares
    const SolverPool::Loan solver(*solvers_);
    const Eigen::VectorXd k = parameters_.stiffness(theta);
    Eigen::MatrixXd F(F_.rows(), F_.cols() + 1);
    F << F_, G_rest_ * k;
    const Eigen::MatrixXd U = solver->linear_steps(k, F);
    double up = 0, down = 0;
    for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
        const Eigen::VectorXd modelled = P_[s] * U.col(s), pulled = P_[s] * U.rightCols<1>();
        const Eigen::VectorXd weighted = weights_[s].cwiseProduct(modelled);
        const Points rest = states_[s].rest + pulled.reshaped<Eigen::RowMajor>(pulled.size() / 3, 3);
        up += weighted.dot(errors_of(states_[s], rest));
        down += weighted.dot(modelled);
    }
    return up > 0 ? std::log(down / up) : 0;
}

PositionDomain PositionDomain::linearised(const Eigen::VectorXd& theta, const Prediction& prediction) const {
    PositionDomain result = *this;
    result.model_ = with_law(*model_, skeleton::Law::linear);
    result.solvers_ = std::make_shared<SolverPool>(*result.model_);
    const Prediction linear = result.predict_linear(parameters_.stiffness(theta));
    for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
        result.offsets_[s] += prediction.markers[s] - linear.markers[s];
    }
    return result;
}

}  // namespace palpate::identify
