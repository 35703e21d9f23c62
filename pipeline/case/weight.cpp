#include "pipeline/case/weight.h"

#include <fmt/format.h>

#include <Eigen/QR>

#include <algorithm>
#include <cmath>

#include "identify/diagnose/fit.h"
#include "identify/set/loads.h"
#include "mesh/errors.h"
#include "pipeline/reference/reference_body.h"

namespace palpate::pipeline {
namespace {

constexpr double standard_gravity = 9806.65;  // [mm/s^2]

bool is_unloaded(const identify::MeasurementSet& set, const identify::LoadState& state) {
    return std::ranges::all_of(state.contacts, [](const mesh::Contact& c) { return c.force.isZero(0); }) &&
           !identify::is_known_to_act(set, state);
}

/// How the markers answer to gravity along each axis, linearly, in the order of the problem's rows over sigma (N x 3).
Eigen::MatrixXd answers_to_gravity(const identify::BodyModel& body, identify::Problem problem) {
    identify::Explanation explanation;
    explanation.theta.resize(std::ssize(body.parameters()));
    for (Eigen::Index p = 0; p < explanation.theta.size(); ++p) explanation.theta[p] = body.parameters()[p].start;
    Eigen::MatrixXd answers(problem.rows(), 3);
    for (int axis = 0; axis < 3; ++axis) {
        for (identify::Action& action : problem.actions) action.gravity = standard_gravity * Vec3::Unit(axis);
        const identify::Played played = identify::play(body, problem, explanation, 1);
        const Eigen::VectorXd moved = problem.pick(played.markers) - (problem.measured - problem.displacement());
        answers.col(axis) = moved.cwiseQuotient(problem.sigma);
    }
    return answers;
}

}  // namespace

void take_weight_as_load(identify::MeasurementSet& set, std::vector<std::string>& notes) {
    const bool is_material_told = set.density || (set.material && std::isfinite(set.material->young));
    const bool is_read = std::ranges::any_of(set.states, [](const auto& state) { return !state.readings.empty(); });
    if (!is_material_told || !is_read || !set.recordings.empty() ||
        !std::ranges::all_of(set.states, [&](const auto& state) { return is_unloaded(set, state); }))
        return;
    const Reference reference = make_reference(set, 0);
    if (!reference.body) return;
    const identify::Problem problem = identify::make_problem(set, set.position_noise.value_or(1));
    const Eigen::MatrixXd A = answers_to_gravity(*reference.body, problem);
    const Eigen::VectorXd moved = problem.displacement().cwiseQuotient(problem.sigma);
    const Eigen::Vector3d along = A.completeOrthogonalDecomposition().solve(moved);
    constexpr double most = 0.5;  // of the squared displacement: something else moved it more
    if (along.isZero(0) || (moved - A * along).squaredNorm() > most * moved.squaredNorm()) return;
    set.gravity = standard_gravity * along.normalized();
    notes.push_back(
        fmt::format("No state has a load: the body's weight is taken as the load, {:.0f} mm/s^2 along ({:.3f}, {:.3f}, "
                    "{:.3f}), where the readings sag to ('gravity' in set.yaml says otherwise).",
                    standard_gravity, along.normalized().x(), along.normalized().y(), along.normalized().z()));
}

}  // namespace palpate::pipeline
