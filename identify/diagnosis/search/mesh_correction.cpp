#include "identify/diagnosis/search/mesh_correction.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identify/diagnosis/statistics/discretisation.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

/// Change of the mesh's error after which it is computed anew, rms over sigma. The next change is a third of it or
/// less, 0.1, which alters a whitened rms of 1 by half a per cent.
constexpr double much_for_noise = 0.3;

/// Where a fit leaves more than noise its equilibria are not the body's, and a closer correction is none.
double much_next_to(const Refit& fit) { return much_for_noise * std::max(1.0, fit.whitened_rms); }

double rms_over_sigma(const Problem& problem, const Eigen::VectorXd& v) {
    return std::sqrt(v.cwiseQuotient(problem.sigma).squaredNorm() / static_cast<double>(v.size()));
}

struct Solved {
    Explanation explanation;
    ForwardSolution forward;
};

/// The baseline with the numbers that are believed before the measurements, but for its stiffness, which has no belief.
Solved believed(const BodyModel& model, const Problem& problem, const Refit& baseline, int threads) {
    Explanation explanation = baseline.explanation;
    for (Eigen::Index p = 0; p < explanation.theta.size(); ++p) {
        const StiffnessParameter& parameter = model.parameters()[p];
        if (!parameter.stiffens) explanation.theta[p] = parameter.prior_mean;
    }
    try {
        return {explanation, solve_forward(model, problem, explanation, threads, &baseline.forward.q)};
    } catch (const SolverFailure&) {
        return {baseline.explanation, baseline.forward};
    }
}

}  // namespace

double correct_for_mesh(const BodyModel& model, Problem& problem, const Explanation& explanation,
                        const ForwardSolution& forward, int threads) {
    const Eigen::VectorXd before = problem.measured;
    problem.correct_for(discretisation_error(model, problem, explanation, forward, threads));
    return rms_over_sigma(problem, problem.measured - before);
}

void correct_baselines_for_mesh(const BodyModel& model, Problem& problem, Baselines& baselines, int threads) {
    Solved at = believed(model, problem, baselines.best(), threads);
    constexpr int most_rounds = 4;  // each changes a third as much as the one before, or less
    for (int round = 0; round < most_rounds; ++round) {
        const double change = correct_for_mesh(model, problem, at.explanation, at.forward, threads);
        if (change == 0) return;
        baselines.refit(problem);
        if (change < much_next_to(baselines.best())) return;
        at = {baselines.best().explanation, baselines.best().forward};
    }
}

bool shows_next_to(const Refit& fit, const Problem& problem, const Eigen::VectorXd& change) {
    return change.size() > 0 && rms_over_sigma(problem, change) >= much_next_to(fit);
}

std::string note_of_correction(const Problem& problem) {
    if (problem.discretisation.size() == 0 || rms_over_sigma(problem, problem.discretisation) < much_for_noise)
        return {};
    const double mm = problem.rms_mm(problem.discretisation), share = problem.relative(problem.discretisation);
    const bool of_forces = mm == 0;
    if (!of_forces && mm < problem.rms_sigma()) return {};
    std::string note = fmt::format(
        "The error of the body's mesh, {:.3g} {} rms or {:.2g} % of the {}, was computed with shorter edges and taken "
        "off the readings.",
        of_forces ? problem.rms_n(problem.discretisation) : mm, of_forces ? "N" : "mm", 100 * share,
        of_forces ? "forces" : "displacement");
    // Halved edges leave up to a third of it: a fifteenth of the displacement, more than most effects are worth.
    constexpr double most = 0.2;
    if (share > most) {
        note +=
            " That is too much to correct reliably: shorter elements (--edge-length) reduce it to a quarter where they "
            "are half as long.";
    }
    return note;
}

}  // namespace palpate::identify
