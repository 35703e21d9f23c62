#include "identify/diagnosis/problem.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "identify/numerics/summaries.h"

namespace palpate::identify {
namespace {

void relieve(Action& action) {
    action.contacts.clear();
    action.motions.clear();
    action.settings.clear();
}

/// How many rows `counts` holds for.
template <class Counts>
Eigen::Index count_where(Eigen::Index rows, const Counts& counts) {
    Eigen::Index count = 0;
    for (Eigen::Index n = 0; n < rows; ++n) count += counts(n) ? 1 : 0;
    return count;
}

/// rms of those values of the rows (N) that `counts` holds for; NaN where it holds for none.
template <class Counts>
double rms_where(const Eigen::VectorXd& values, const Counts& counts) {
    double sum = 0;
    int count = 0;
    for (Eigen::Index n = 0; n < values.size(); ++n) {
        if (!counts(n)) continue;
        sum += values[n] * values[n];
        ++count;
    }
    return count > 0 ? std::sqrt(sum / count) : missing;
}

}  // namespace

bool is_same(const Action& a, const Action& b) {
    const auto same_contact = [](const mesh::Contact& x, const mesh::Contact& y) {
        return x.point == y.point && x.force == y.force && x.radius == y.radius;
    };
    const auto same_or_free = [](const Vec3& x, const Vec3& y) {
        return ((x.array() == y.array()) || (x.array().isNaN() && y.array().isNaN())).all();
    };
    const auto same_motion = [&](const mesh::ToolMotion& x, const mesh::ToolMotion& y) {
        return x.tool == y.tool && same_or_free(x.translation, y.translation) && same_or_free(x.rotation, y.rotation);
    };
    const auto same_setting = [](const mesh::ActuatorSetting& x, const mesh::ActuatorSetting& y) {
        return x.actuator == y.actuator && x.value == y.value && x.earlier == y.earlier;
    };
    return a.gravity == b.gravity && a.pressure == b.pressure &&
           std::ranges::equal(a.contacts, b.contacts, same_contact) &&
           std::ranges::equal(a.motions, b.motions, same_motion) &&
           std::ranges::equal(a.settings, b.settings, same_setting);
}

bool is_loaded(const Action& action) {
    return !action.contacts.empty() || !action.motions.empty() || !action.settings.empty();
}

LoadSizes sizes_of(const Action& action) {
    LoadSizes sizes;
    for (const mesh::Contact& contact : action.contacts) sizes.force += contact.force.norm();
    for (const mesh::ToolMotion& motion : action.motions) sizes.way += known_part(motion.translation).norm();
    for (const mesh::ActuatorSetting& setting : action.settings) sizes.setting += std::abs(setting.value);
    return sizes;
}

Eigen::VectorXd Problem::pick(const std::vector<Points>& channels) const {
    Eigen::VectorXd result(rows());
    for (Eigen::Index n = 0; n < rows(); ++n) {
        result[n] = channels[action[n]](channel(n), coordinate[n] % 3);
        if (is_difference(n)) result[n] -= channels[since[n]](channel(n), coordinate[n] % 3);
    }
    return result;
}

Eigen::VectorXd Problem::displacement() const {
    Eigen::VectorXd result = measured;
    if (discretisation.size() > 0) result += discretisation;
    for (Eigen::Index n = 0; n < rows(); ++n) result[n] -= origin(n);
    return result;
}

void Problem::correct_for(Eigen::VectorXd error) {
    if (discretisation.size() > 0) measured += discretisation;
    discretisation = std::move(error);
    if (discretisation.size() > 0) measured -= discretisation;
}

Problem Problem::with_rows(const std::vector<char>& keep) const {
    Problem result;
    result.actions = actions;
    result.probe = probe;
    result.stages = stages;
    result.continuous = continuous;
    result.by_stage = by_stage;
    result.declared_poisson = declared_poisson;
    result.markers = markers;
    result.rig = rig;
    result.rest = rest;
    std::vector<int> kept;
    int last = -1, number = -1;
    for (int n = 0; n < static_cast<int>(rows()); ++n) {
        if (!keep[n]) continue;
        if (reading[n] != last) ++number;
        last = reading[n];
        kept.push_back(n);
        result.state.push_back(state[n]);
        result.action.push_back(action[n]);
        result.since.push_back(since[n]);
        result.since_state.push_back(since_state[n]);
        result.coordinate.push_back(coordinate[n]);
        result.reading.push_back(number);
        result.set_reading.push_back(set_reading[n]);
        result.is_guessed.push_back(is_guessed[n]);
    }
    result.measured = measured(kept);
    result.sigma = sigma(kept);
    if (discretisation.size() > 0) result.discretisation = discretisation(kept);
    return result;
}

Problem Problem::without_actions(const std::vector<char>& drop) const {
    std::vector<char> keep(rows());
    for (Eigen::Index n = 0; n < rows(); ++n) keep[n] = !drop[action[n]] && !(is_difference(n) && drop[since[n]]);
    Problem result = with_rows(keep);
    for (Eigen::Index n = 0; n < rows(); ++n) {
        if (drop[action[n]]) relieve(result.stages[state[n]].action);
    }
    if (by_stage) {  // every stage stays
        for (std::size_t k = 0; k < actions.size(); ++k) {
            if (drop[k]) relieve(result.actions[k]);
        }
        return result;
    }
    result.actions.clear();
    result.probe.clear();
    std::vector<int> number(actions.size(), -1);
    for (std::size_t k = 0; k < actions.size(); ++k) {
        if (drop[k]) continue;
        number[k] = static_cast<int>(result.actions.size());
        result.actions.push_back(actions[k]);
        result.probe.push_back(probe[k]);
    }
    for (int& k : result.action) k = number[k];
    for (int& k : result.since)
        if (k >= 0) k = number[k];
    return result;
}

int Problem::before(int k) const {
    if (k == 0) return -1;
    return continuous || stages[k].probe == stages[k - 1].probe ? k - 1 : -1;
}

Problem Problem::stage_by_stage() const {
    Problem result = *this;
    result.by_stage = true;
    result.action = state;
    result.since = since_state;
    result.actions.clear();
    result.probe.clear();
    std::set<int> loaded_probes;
    for (const Stage& stage : stages) {
        if (is_loaded(stage.action)) loaded_probes.insert(stage.probe);
    }
    for (const Stage& stage : stages) {
        result.actions.push_back(stage.action);
        result.probe.push_back(loaded_probes.contains(stage.probe) ? stage.probe : -1);
    }
    return result;
}

int Problem::action_in(const Problem& other, int k) const {
    int like = -1, most_similar = -1;
    for (std::size_t j = 0; j < other.actions.size(); ++j) {
        if (!is_same(other.actions[j], actions[k])) continue;
        int alike = 0;
        if (other.probe[j] == probe[k]) ++alike;
        if (by_stage && other.by_stage && other.stages[j].probe == stages[k].probe) {
            alike += other.stages[j].time == stages[k].time ? 2 : 1;
        }
        if (alike <= most_similar) continue;
        most_similar = alike;
        like = static_cast<int>(j);
    }
    return like;
}

Eigen::Index Problem::count_positions() const {
    return count_where(rows(), [this](Eigen::Index n) { return is_position(n); });
}

Eigen::Index Problem::count_forces() const {
    return count_where(rows(), [this](Eigen::Index n) { return is_force(n); });
}

double Problem::rms_mm(const Eigen::VectorXd& values) const {
    return known_part(rms_where(values, [this](Eigen::Index n) { return is_position(n); }));
}

double Problem::rms_n(const Eigen::VectorXd& values) const {
    return rms_where(values, [this](Eigen::Index n) { return is_force(n); });
}

double Problem::relative(const Eigen::VectorXd& error) const {
    const double moved = rms_mm(displacement());
    if (moved > 0) return rms_mm(error) / moved;
    const double force = rms_n(measured);
    return force > 0 ? rms_n(error) / force : missing;
}

}  // namespace palpate::identify
