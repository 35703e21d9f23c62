#include "identify/inference/maximum/fit_map.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "identify/numerics/conjugate_gradients.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

/// The start, or if nothing stands there, all stiffnesses threefold until something does.
Prediction first_prediction(const PositionDomain& domain, int threads, Eigen::VectorXd& theta) {
    constexpr int tries = 6;  // up to 729 times as stiff: what even that does not bear is told as a failure
    for (int i = 0;; ++i) {
        try {
            return domain.predict(theta, threads, nullptr, true);
        } catch (const SolverFailure&) {
            if (i == tries) throw;
            theta.array() += std::log(3.0);
        }
    }
}

std::optional<Prediction> try_prediction(const PositionDomain& domain, int threads, const Eigen::VectorXd& theta,
                                         const Prediction& near) {
    try {
        return domain.predict(theta, threads, &near, true);
    } catch (const SolverFailure&) {
        return std::nullopt;
    }
}

constexpr double most_numbers = 4e6;          // of a spectrum's vectors
constexpr double forcing = 1e-2;              // of what a step promises, that it may leave,
constexpr double of_nothing = 0.1;            // or of a fall that is none
constexpr double roughly = 1e-2;              // of what a promise tells
constexpr int products_of_a_promise = 60;     // at most: a bound of its cost
constexpr int stale = 12;                     // products of steps, after which the spectrum is found anew, at least
constexpr double column_cost_ratio = 3;       // products with a column after another, to one of a spectrum's
constexpr int on_the_way = 128;               // directions of a spectrum that is there to precondition
constexpr double sufficient_decrease = 0.05;  // of what a step promises
constexpr double good_decrease = 0.5;         // the same, to damp less from then on
constexpr double first_damping = 1e-3;        // after a step that fell short, of the largest eigenvalue
constexpr double most_damping = 1e9;          // the same

struct Step {
    Eigen::VectorXd dv;
    double promised = 0;  // fall of half of chi^2 and prior
    int products = 0;
};

/// As many directions as memory and time allow.
SpectrumOptions whole_spectrum(int P) {
    SpectrumOptions options;
    options.largest = std::min(options.largest, static_cast<int>(most_numbers / P));
    return options;
}

/// Fewer, which conjugate gradients make up for.
SpectrumOptions leading_part(int P) {
    SpectrumOptions options = whole_spectrum(P);
    options.largest = std::min(options.largest, on_the_way);
    return options;
}

/// Products of steps that are worth another spectrum.
int worth_a_spectrum(const Spectrum& spectrum, Eigen::Index P) {
    const int columns =
        std::max(stale, static_cast<int>(static_cast<double>(spectrum.values.size()) / column_cost_ratio));
    return static_cast<int>(std::min<Eigen::Index>(columns, P / 8));
}

/// Falls below it are none: the tolerance, or where numbers are too many for a spectrum, so much for each.
double nothing(const FitOptions& options, const Spectrum& spectrum, int P) {
    return options.tolerance * (spectrum.is_whole ? 1 : P);
}

/// (1 + damping + A) dv = -g by conjugate gradients, preconditioned by the spectrum of an A nearby. `none`: a fall that
/// is not worth a product.
Step damped_step(const SymmetricProduct& A, const Eigen::VectorXd& g, double damping, const Spectrum& near,
                 double none) {
    const ShiftedSolution solution = solve_shifted(
        A, 1 + damping, -g, near, {.left = forcing, .enough = 2 * none, .products = static_cast<int>(g.size())});
    Step step{solution.X, 0, solution.products};
    // -g dv - dv (1 + A) dv / 2, and (1 + A) dv = -g - left - damping dv
    step.promised = (step.dv.dot(solution.left.col(0) - g) + damping * step.dv.squaredNorm()) / 2;
    return step;
}

bool stalls(const std::vector<double>& trace, const FitOptions& options) {
    const auto past = static_cast<std::size_t>(options.patience);
    return past > 0 && trace.size() > past && trace[trace.size() - 1 - past] - trace.back() < 100 * options.tolerance;
}

}  // namespace

SymmetricProduct whitened_curvature(const ErrorJacobian& jacobian, const LogNormalPrior& prior) {
    return [&](const Eigen::MatrixXd& V) { return prior.gradients_by_v(jacobian.curvature_times(prior.coloured(V))); };
}

double promised_chi_squared(const PositionDomain& domain, const LogNormalPrior& prior, const FitResult& fit,
                            double sharper) {
    const ErrorJacobian jacobian = domain.jacobian(fit.theta, fit.prediction);
    const SymmetricProduct A = whitened_curvature(jacobian, prior);
    const Eigen::VectorXd of_errors = prior.gradients_by_v(jacobian.gradient()),
                          g = of_errors + prior.whitened(fit.theta);
    const Spectrum near{sharper * fit.spectrum.values, fit.spectrum.vectors};
    const ShiftedSolution step = solve_shifted(A, 1, -g, near, {.left = roughly, .products = products_of_a_promise});
    // A dv = -g - left - dv
    const Eigen::VectorXd dv = step.X.col(0);
    return domain.chi_squared(fit.prediction) + dv.dot(2 * of_errors - g - step.left.col(0) - dv);
}

FitResult fit_map(const PositionDomain& domain, const LogNormalPrior& prior, const Eigen::VectorXd& start, int threads,
                  const FitOptions& options) {
    const int P = domain.parameters().size();
    FitResult fit;
    fit.theta = start;
    fit.prediction = first_prediction(domain, threads, fit.theta);
    fit.chi_squared = domain.chi_squared(fit.prediction);
    fit.evaluations = 1;
    const auto half = [&] { return fit.chi_squared / 2 + prior.half_square(fit.theta); };
    fit.trace.push_back(half());

    std::optional<ErrorJacobian> jacobian;
    double damping = 0;
    double reach = 1;                      // of a step: less where slopes alone promise too much
    bool moved = true;                     // or the slopes still hold
    bool known = options.near != nullptr;  // the spectrum, well enough
    if (known) fit.spectrum = *options.near;
    int products = 0;  // of steps, since the spectrum was found
    Eigen::VectorXd g;
    while (fit.iterations < options.iterations) {
        // Gauss-Newton's quadratic of half of chi^2 and prior, in v
        if (moved) {
            jacobian.reset();  // its solvers serve again
            jacobian.emplace(domain.jacobian(fit.theta, fit.prediction));
            g = prior.gradients_by_v(jacobian->gradient()) + prior.whitened(fit.theta);
        }
        const SymmetricProduct A = whitened_curvature(*jacobian, prior);
        if (!known) {
            fit.spectrum = leading_spectrum(A, P, leading_part(P), fit.spectrum.vectors);
            products = 0;
        }
        if (stalls(fit.trace, options)) {
            fit.converged = true;
            break;
        }
        const double largest = fit.spectrum.values.size() > 0 ? fit.spectrum.values[0] : 1;
        ++fit.iterations;

        // its least, damped; none left to gain without damping is the end
        const double none = nothing(options, fit.spectrum, P);
        const Step step = damped_step(A, g, damping, fit.spectrum, of_nothing * none);
        products += step.products;
        known = !fit.spectrum.is_whole || products <= worth_a_spectrum(fit.spectrum, P);
        const double to_gain = damping == 0 ? step.promised : g.dot(fit.spectrum.inverse(1, g).col(0)) / 2;
        if (to_gain < none) {
            fit.converged = true;
            fit.trace.push_back(fit.trace.back());
            break;
        }

        // some of the way there, no ratio larger than e
        const Eigen::VectorXd whole = prior.coloured(step.dv);
        const double share = std::min(reach, 1 / whole.cwiseAbs().maxCoeff());
        const Eigen::VectorXd theta = fit.theta + share * whole;
        std::optional<Prediction> trial =
            try_prediction(domain, threads, theta, domain.advanced(fit.prediction, *jacobian, theta - fit.theta));
        ++fit.evaluations;
        double fall = -1, chi_squared = 0;  // of half of chi^2 and prior
        if (trial) {
            chi_squared = domain.chi_squared(*trial);
            fall = (fit.chi_squared - chi_squared) / 2 + prior.half_square(fit.theta) - prior.half_square(theta);
        }
        const double promised = step.promised * share * (2 - share);
        moved = fall > sufficient_decrease * promised;
        if (moved) {
            // a parabola through both ends, 2 promised steep at the start, tells where its least lies
            const double bend = 2 * step.promised * share - fall;
            reach = bend > 0 ? std::clamp(step.promised * share * share / bend, 0.1, 1.0) : 1;
            fit.theta = theta;
            fit.prediction = std::move(*trial);
            fit.chi_squared = chi_squared;
            fit.trace.push_back(half());
            if (fall > good_decrease * promised)
                damping = damping > first_damping * first_damping * largest ? damping / 10 : 0;
        } else {
            fit.trace.push_back(fit.trace.back());
            if (damping > most_damping * largest) break;
            damping = std::max(4 * damping, first_damping * largest);
        }
    }

    // what is known there
    const bool has_hope = fit.spectrum.is_whole || whole_spectrum(P).largest >= 2 * on_the_way;  // of a whole one
    if (options.final_spectrum && has_hope) {
        if (moved && !fit.converged) {
            jacobian.reset();
            jacobian.emplace(domain.jacobian(fit.theta, fit.prediction));
        }
        fit.spectrum =
            leading_spectrum(whitened_curvature(*jacobian, prior), P, whole_spectrum(P), fit.spectrum.vectors);
    }
    fit.prediction.tangents.clear();
    return fit;
}

}  // namespace palpate::identify
