#include "identify/preflight/repeats.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "identify/numerics/summaries.h"

namespace palpate::identify {
namespace {

constexpr double alike = 0.02;  // of a load: what a rig reaches again

bool is_near(const Vec3& a, const Vec3& b) {
    if ((a.array().isNaN() != b.array().isNaN()).any()) return false;
    const Vec3 x = known_part(a), y = known_part(b);
    return (x - y).norm() <= alike * std::max(x.norm(), y.norm());
}

bool is_near(double a, double b) { return std::abs(a - b) <= alike * std::max(std::abs(a), std::abs(b)); }

bool act_alike(const Action& a, const Action& b) {
    return is_near(a.gravity, b.gravity) && is_near(a.pressure, b.pressure) &&
           std::ranges::equal(a.contacts, b.contacts,
                              [](const mesh::Contact& x, const mesh::Contact& y) {
                                  const double within = std::max(0.1 * std::max(x.radius, y.radius), 1e-9);
                                  return (x.point - y.point).norm() <= within && is_near(x.force, y.force);
                              }) &&
           std::ranges::equal(a.motions, b.motions,
                              [](const mesh::ToolMotion& x, const mesh::ToolMotion& y) {
                                  return x.tool == y.tool && is_near(x.translation, y.translation) &&
                                         is_near(x.rotation, y.rotation);
                              }) &&
           std::ranges::equal(a.settings, b.settings, [](const auto& x, const auto& y) {
               return x.actuator == y.actuator && is_near(x.value, y.value);
           });
}

/// Scatter of coordinates about their means over the states of a group.
void tell_scatter(const Problem& problem, const Eigen::VectorXd& error_mm, Repeat& repeat) {
    std::map<int, std::vector<Eigen::Index>> rows;  // of each coordinate
    for (Eigen::Index n = 0; n < problem.rows(); ++n) {
        if (problem.is_position(n) && std::ranges::find(repeat.states, problem.state[n]) != repeat.states.end())
            rows[problem.coordinate[n]].push_back(n);
    }
    double squares = 0, sigmas = 0;
    for (const auto& [coordinate, own] : rows) {
        if (own.size() < 2) continue;
        const Eigen::VectorXd values = error_mm(own);
        squares += (values.array() - values.mean()).square().sum();
        sigmas +=
            problem.sigma(own).squaredNorm() * static_cast<double>(own.size() - 1) / static_cast<double>(own.size());
        repeat.freedoms += static_cast<int>(own.size()) - 1;
    }
    if (repeat.freedoms == 0) return;
    repeat.sd_mm = std::sqrt(squares / repeat.freedoms);
    repeat.sigma_mm = std::sqrt(sigmas / repeat.freedoms);
}

}  // namespace

std::vector<Repeat> repeated_states(const Problem& problem, const Eigen::VectorXd& error_mm) {
    const std::vector<Stage>& stages = problem.stages;
    // Where the same acts as in an earlier stage, that one leads the group.
    std::vector<std::vector<int>> groups;
    for (int s = 0; s < static_cast<int>(stages.size()); ++s) {
        const auto found = std::ranges::find_if(groups, [&](const std::vector<int>& group) {
            return act_alike(stages[group.front()].action, stages[s].action);
        });
        if (found == groups.end()) {
            groups.push_back({s});
        } else {
            found->push_back(s);
        }
    }
    std::vector<Repeat> result;
    for (const std::vector<int>& group : groups) {
        if (group.size() < 2) continue;
        Repeat repeat{.states = group};
        repeat.loaded = is_loaded(stages[group.front()].action);
        repeat.held = repeat.loaded &&
                      std::ranges::all_of(group, [&](int s) { return stages[s].probe == stages[group.front()].probe; });
        tell_scatter(problem, error_mm, repeat);
        if (repeat.freedoms > 0) result.push_back(std::move(repeat));
    }
    return result;
}

}  // namespace palpate::identify
