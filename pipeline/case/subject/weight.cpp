#include "pipeline/case/subject/weight.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>

#include "identify/diagnosis/fit/refit.h"
#include "identify/effects/catalogue.h"
#include "identify/loading/loads.h"
#include "mesh/errors.h"
#include "pipeline/body/reference_body.h"

namespace palpate::pipeline {
namespace {

constexpr double standard_gravity = 9806.65;  // [mm/s^2]

identify::Explanation bare(const identify::BodyModel& body) {
    identify::Explanation explanation;
    explanation.theta.resize(std::ssize(body.parameters()));
    for (Eigen::Index p = 0; p < explanation.theta.size(); ++p) explanation.theta[p] = body.parameters()[p].start;
    return explanation;
}

/// How the markers answer to gravity along each axis, linearly, in the order of the problem's rows over sigma (N x 3).
Eigen::MatrixXd sensitivities_to_gravity(const identify::BodyModel& body, identify::Problem problem) {
    const identify::Explanation explanation = bare(body);
    Eigen::MatrixXd sensitivities(problem.rows(), 3);
    for (int axis = 0; axis < 3; ++axis) {
        for (identify::Action& action : problem.actions) action.gravity = standard_gravity * Vec3::Unit(axis);
        const identify::ForwardSolution forward = identify::solve_forward(body, problem, explanation, 1);
        const Eigen::VectorXd moved = problem.pick(forward.markers) - (problem.measured - problem.displacement());
        sensitivities.col(axis) = moved.cwiseQuotient(problem.sigma);
    }
    return sensitivities;
}

/// Frames stand upright mostly: the axis that a vector may lie along, within what is known of it (P, the inverse of its
/// covariance); else its own direction.
Vec3 upright(const Vec3& v, const Mat3& P) {
    constexpr double likely = 6;  // chi^2 of two numbers, 95 %
    Vec3 best = v.normalized();
    double least = likely;
    for (int axis = 0; axis < 3; ++axis) {
        const double along = P.row(axis).dot(v);
        const double off = v.dot(P * v) - along * along / P(axis, axis);
        if (off >= least) continue;
        least = off;
        best.setZero();
        best[axis] = std::copysign(1.0, along);
    }
    return best;
}

/// The direction of gravity in large deformation: what sags far comes nearer, too, which small strain takes for a pull
/// along the body. `linear`: gravity in small strain, over the standard one.
Vec3 direction_of(const identify::BodyModel& body, const identify::Problem& problem, const Vec3& linear) {
    identify::Explanation explanation = bare(body);
    explanation.law = 1;  // of large deformation
    for (Eigen::Index p = 0; p < explanation.theta.size(); ++p)
        if (body.parameters()[p].stiffens) explanation.theta[p] -= std::log(linear.norm());
    const auto gravity = identify::find_effect("gravity");
    const auto numbers = gravity->numbers(body, problem);
    const Vec3 start = standard_gravity * linear.normalized();
    explanation.effects = {gravity};
    explanation.values = {gravity->values(
        numbers, {"gravity", {{"gx", start.x(), "mm/s^2"}, {"gy", start.y(), "mm/s^2"}, {"gz", start.z(), "mm/s^2"}}})};
    try {
        const identify::Refit fit = identify::refit(body, problem, explanation, {});
        const Vec3 found = fit.explanation.values.front();
        const Mat3 covariance = fit.covariance.bottomRightCorner<3, 3>();
        return found.isZero(0) ? start.normalized() : upright(found, covariance.inverse());
    } catch (const SolverFailure&) {
        return start.normalized();
    }
}

}  // namespace

void take_weight_as_load(identify::MeasurementSet& set, std::vector<std::string>& notes) {
    const bool is_material_specified = set.density || (set.material && std::isfinite(set.material->young));
    const bool is_read = std::ranges::any_of(set.states, [](const auto& state) { return !state.readings.empty(); });
    if (!is_material_specified || !is_read || !set.recordings.empty() ||
        std::ranges::any_of(set.states, [&](const auto& state) { return identify::is_known_to_act(set, state); }))
        return;
    const Reference reference = make_reference(set, 0);
    if (!reference.body) return;
    const identify::Problem problem = identify::make_problem(set, set.position_noise.value_or(1));
    const Eigen::MatrixXd A = sensitivities_to_gravity(*reference.body, problem);
    const Eigen::VectorXd moved = problem.displacement().cwiseQuotient(problem.sigma);
    const Eigen::Vector3d along = A.completeOrthogonalDecomposition().solve(moved);
    constexpr double most = 0.5;  // of the squared displacement: something else moved it more
    if (along.isZero(0) || (moved - A * along).squaredNorm() > most * moved.squaredNorm()) return;
    const Vec3 down = direction_of(*reference.body, problem, along);
    set.gravity = standard_gravity * down;
    notes.push_back(
        fmt::format("No state has a load: the body's weight is taken as the load, {:.0f} mm/s^2 along ({:.3f}, {:.3f}, "
                    "{:.3f}), where the readings sag to ('gravity' in set.yaml says otherwise).",
                    standard_gravity, down.x(), down.y(), down.z()));
}

}  // namespace palpate::pipeline
