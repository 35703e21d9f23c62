#include "identify/diagnosis/problem.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "identify/loading/loads.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

std::vector<mesh::Contact> acting(const LoadState& state) {
    std::vector<mesh::Contact> contacts;
    std::ranges::copy_if(state.contacts, std::back_inserter(contacts),
                         [](const mesh::Contact& c) { return !c.force.isZero(0); });
    return contacts;
}

bool same(const Action& a, const Action& b) {
    const auto same_contact = [](const mesh::Contact& x, const mesh::Contact& y) {
        return x.point == y.point && x.force == y.force && x.radius == y.radius;
    };
    return a.gravity == b.gravity && a.pressure == b.pressure &&
           std::ranges::equal(a.contacts, b.contacts, same_contact);
}

bool counts(const Reading& reading) { return reading.marker >= 0 && !reading.position.array().isNaN().all(); }

/// The action of a state: one that is there already, or a new one.
int action_of(Problem& problem, const Stage& stage) {
    const int probe = stage.action.contacts.empty() ? -1 : stage.probe;
    for (std::size_t k = 0; k < problem.actions.size(); ++k) {
        if (problem.probe[k] == probe && same(problem.actions[k], stage.action)) return static_cast<int>(k);
    }
    problem.actions.push_back(stage.action);
    problem.probe.push_back(probe);
    return static_cast<int>(problem.actions.size()) - 1;
}

Stage stage_of(const MeasurementSet& set, const LoadState& state) {
    return {state.probe,
            state.time,
            {.contacts = acting(state),
             .gravity = known_gravity(set, state).value_or(Vec3::Zero()),
             .pressure = known_pressure(state)}};
}

}  // namespace

Problem make_problem(const MeasurementSet& set, double noise) {
    Problem problem;
    problem.continuous = set.continuous;
    if (set.material) problem.declared_poisson = set.material->poisson;
    for (const LoadState& state : set.states) problem.stages.push_back(stage_of(set, state));
    problem.rest.resize(static_cast<Eigen::Index>(set.markers.size()), 3);
    for (std::size_t m = 0; m < set.markers.size(); ++m) {
        problem.rest.row(static_cast<Eigen::Index>(m)) = set.markers[m].rest;
    }
    std::vector<double> measured, sigma;
    int reading_number = 0;
    for (std::size_t s = 0; s < set.states.size(); ++s) {
        const LoadState& state = set.states[s];
        if (std::ranges::none_of(state.readings, counts)) continue;
        const int action = action_of(problem, problem.stages[s]);
        for (const Reading& reading : state.readings) {
            if (!counts(reading)) continue;
            for (int axis = 0; axis < 3; ++axis) {
                if (std::isnan(reading.position[axis])) continue;
                measured.push_back(reading.position[axis]);
                sigma.push_back(std::isnan(reading.sigma) ? set.position_noise.value_or(noise) : reading.sigma);
                problem.is_guessed.push_back(std::isnan(reading.sigma) && !set.position_noise);
                problem.state.push_back(static_cast<int>(s));
                problem.action.push_back(action);
                problem.coordinate.push_back(3 * reading.marker + axis);
                problem.reading.push_back(reading_number);
            }
            ++reading_number;
        }
    }
    if (measured.empty()) {
        throw InvalidInput(fmt::format(
            "measurement set '{}' has no labelled reading; positions.csv needs rows that name a marker", set.name));
    }
    problem.set_reading = problem.reading;
    problem.measured = Eigen::Map<Eigen::VectorXd>(measured.data(), std::ssize(measured));
    problem.sigma = Eigen::Map<Eigen::VectorXd>(sigma.data(), std::ssize(sigma));
    return problem;
}

MeasurementSet without_readings(const MeasurementSet& set, const std::vector<int>& readings) {
    MeasurementSet result = set;
    int number = 0;
    for (LoadState& state : result.states) {
        std::erase_if(state.readings, [&](const Reading& reading) {
            return counts(reading) && std::ranges::binary_search(readings, number++);
        });
    }
    return result;
}

Eigen::VectorXd Problem::pick(const std::vector<Points>& positions) const {
    Eigen::VectorXd result(rows());
    for (Eigen::Index n = 0; n < rows(); ++n) {
        result[n] = positions[action[n]](coordinate[n] / 3, coordinate[n] % 3);
    }
    return result;
}

Eigen::VectorXd Problem::displacement() const {
    Eigen::VectorXd result = measured;
    if (discretisation.size() > 0) result += discretisation;
    for (Eigen::Index n = 0; n < rows(); ++n) result[n] -= rest(coordinate[n] / 3, coordinate[n] % 3);
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
    for (Eigen::Index n = 0; n < rows(); ++n) keep[n] = !drop[action[n]];
    Problem result = with_rows(keep);
    for (Eigen::Index n = 0; n < rows(); ++n) {
        if (!keep[n]) result.stages[state[n]].action.contacts.clear();
    }
    if (by_stage) {  // every stage stays
        for (std::size_t k = 0; k < actions.size(); ++k) {
            if (drop[k]) result.actions[k].contacts.clear();
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
    result.actions.clear();
    result.probe.clear();
    std::set<int> loaded_probes;
    for (const Stage& stage : stages) {
        if (!stage.action.contacts.empty()) loaded_probes.insert(stage.probe);
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
        if (!same(other.actions[j], actions[k])) continue;
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

double Problem::rms_sigma() const { return std::sqrt(sigma.squaredNorm() / static_cast<double>(sigma.size())); }

}  // namespace palpate::identify
