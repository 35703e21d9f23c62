#include "identify/diagnosis/problem.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "identify/loading/history/lagged_load.h"
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

/// The action of a state: one that is there already, or a new one.
int action_of(Problem& problem, const Stage& stage) {
    const int probe = is_loaded(stage.action) ? stage.probe : -1;
    for (std::size_t k = 0; k < problem.actions.size(); ++k) {
        if (problem.probe[k] == probe && is_same(problem.actions[k], stage.action)) return static_cast<int>(k);
    }
    problem.actions.push_back(stage.action);
    problem.probe.push_back(probe);
    return static_cast<int>(problem.actions.size()) - 1;
}

std::vector<mesh::ActuatorSetting> settings_of(const LoadState& state) {
    std::vector<mesh::ActuatorSetting> settings;
    for (const Actuation& one : state.actuations) {
        if (one.value != 0) settings.push_back({one.actuator, one.value});
    }
    return settings;
}

/// Tells tendons on their way back where they come from.
void tell_earlier_settings(const MeasurementSet& set, std::vector<Stage>& stages) {
    for (std::size_t a = 0; a < set.actuators.size(); ++a) {
        if (!mesh::may_rub(set.actuators[a])) continue;
        std::vector<double> earlier;
        for (std::size_t s = 0; s < stages.size(); ++s) {
            if (s > 0 && !set.continuous && stages[s].probe != stages[s - 1].probe) earlier.clear();
            std::vector<mesh::ActuatorSetting>& settings = stages[s].action.settings;
            const auto own = std::ranges::find(settings, static_cast<int>(a), &mesh::ActuatorSetting::actuator);
            if (own == settings.end()) {
                earlier.clear();  // it hangs loose
                continue;
            }
            own->earlier = since_largest(earlier, own->value);
            earlier.push_back(own->value);
        }
    }
}

bool is_read(const LoadState& state) {
    return std::ranges::any_of(state.readings, is_usable) || !state.reactions.empty();
}

Stage stage_of(const MeasurementSet& set, const LoadState& state) {
    return {state.probe,
            state.time,
            {.contacts = acting(state),
             .gravity = known_gravity(set, state).value_or(Vec3::Zero()),
             .pressure = known_pressure(state),
             .motions = state.motions,
             .settings = settings_of(state)}};
}

/// Fills a problem row by row.
class Rows {
public:
    explicit Rows(Problem& problem) : problem_(problem) {}

    void add(int state, int action, int coordinate, double value, double sigma, bool is_guessed, int since = -1,
             int since_state = -1) {
        measured_.push_back(value);
        sigma_.push_back(sigma);
        problem_.is_guessed.push_back(is_guessed);
        problem_.state.push_back(state);
        problem_.action.push_back(action);
        problem_.since.push_back(since);
        problem_.since_state.push_back(since_state);
        problem_.coordinate.push_back(coordinate);
        problem_.reading.push_back(reading_);
    }
    void next_reading() { ++reading_; }
    bool empty() const { return measured_.empty(); }
    void finish() {
        problem_.set_reading = problem_.reading;
        problem_.measured = Eigen::Map<Eigen::VectorXd>(measured_.data(), std::ssize(measured_));
        problem_.sigma = Eigen::Map<Eigen::VectorXd>(sigma_.data(), std::ssize(sigma_));
    }

private:
    Problem& problem_;
    std::vector<double> measured_, sigma_;
    int reading_ = 0;
};

/// The state's index; -1: there is none of that name.
int index_of(const MeasurementSet& set, const StateName& name) {
    const LoadState* state = find_state(set, name);
    return state ? static_cast<int>(state - set.states.data()) : -1;
}

/// `action`: of each state.
void add_positions(const MeasurementSet& set, double noise, const std::vector<int>& action, Rows& rows) {
    for (std::size_t s = 0; s < set.states.size(); ++s) {
        for (const Reading& reading : set.states[s].readings) {
            if (!is_usable(reading)) continue;
            const bool is_told = !std::isnan(reading.sigma);
            const double sigma = is_told ? reading.sigma : set.position_noise.value_or(noise);
            const int since_state = reading.since ? index_of(set, *reading.since) : -1;
            const int since = reading.since ? action[since_state] : -1;
            const Vec3 counted =
                reading.since ? Vec3(reading.position - set.markers[reading.marker].rest) : reading.position;
            for (int axis = 0; axis < 3; ++axis) {
                if (std::isnan(reading.position[axis])) continue;
                rows.add(static_cast<int>(s), action[s], 3 * reading.marker + axis, counted[axis], sigma,
                         !is_told && !set.position_noise, since, since_state);
            }
            rows.next_reading();
        }
    }
}

/// The largest component of what a tool's sensor reads in any state.
double largest_reaction(const MeasurementSet& set, int tool, Vec3 ReactionReading::*what) {
    double most = 0;
    for (const LoadState& state : set.states) {
        for (const ReactionReading& reading : state.reactions) {
            if (reading.tool != tool) continue;
            for (const double x : reading.*what) most = std::isnan(x) ? most : std::max(most, std::abs(x));
        }
    }
    return most;
}

/// The forces, then the moments; after all positions, so that these are numbered as the set numbers them.
void add_reactions(const MeasurementSet& set, const std::vector<int>& action, Rows& rows) {
    constexpr double guess = 0.01;  // of the largest reading: what a load cell of moderate class errs by
    for (std::size_t s = 0; s < set.states.size(); ++s) {
        for (const ReactionReading& reading : set.states[s].reactions) {
            const int channel = static_cast<int>(set.markers.size()) + 2 * reading.tool;
            const auto add = [&](int at, Vec3 ReactionReading::*what, double sigma) {
                if ((reading.*what).array().isNaN().all()) return;
                if (std::isnan(sigma)) sigma = std::max(guess * largest_reaction(set, reading.tool, what), 1e-12);
                for (int axis = 0; axis < 3; ++axis) {
                    if (std::isnan((reading.*what)[axis])) continue;
                    rows.add(static_cast<int>(s), action[s], 3 * at + axis, (reading.*what)[axis], sigma, false);
                }
                rows.next_reading();
            };
            add(channel, &ReactionReading::force,
                std::isnan(reading.sigma) ? set.reaction_noise.value_or(missing) : reading.sigma);
            add(channel + 1, &ReactionReading::moment, set.moment_noise.value_or(missing));
        }
    }
}

}  // namespace

Problem make_problem(const MeasurementSet& set, double noise) {
    Problem problem;
    problem.continuous = set.continuous;
    if (set.material) problem.declared_poisson = set.material->poisson;
    for (const LoadState& state : set.states) problem.stages.push_back(stage_of(set, state));
    tell_earlier_settings(set, problem.stages);
    problem.markers = static_cast<int>(set.markers.size());
    problem.rig = std::make_shared<Rig>(Rig{set.tools, set.actuators});
    problem.rest = Points::Zero(problem.markers + 2 * std::ssize(set.tools), 3);
    for (int m = 0; m < problem.markers; ++m) problem.rest.row(m) = set.markers[m].rest;
    std::vector<int> action(set.states.size(), -1);
    std::vector<char> counts_here(set.states.size());
    for (std::size_t s = 0; s < set.states.size(); ++s) {
        if (!is_read(set.states[s])) continue;
        counts_here[s] = 1;
        for (const Reading& reading : set.states[s].readings)
            if (reading.since) counts_here[index_of(set, *reading.since)] = 1;
    }
    for (std::size_t s = 0; s < set.states.size(); ++s) {
        if (counts_here[s]) action[s] = action_of(problem, problem.stages[s]);
    }
    Rows rows(problem);
    add_positions(set, noise, action, rows);
    add_reactions(set, action, rows);
    if (rows.empty()) {
        throw InvalidInput(fmt::format(
            "measurement set '{}' has no labelled reading; positions.csv needs rows that name a marker", set.name));
    }
    rows.finish();
    return problem;
}

Problem make_problem(const MeasurementSet& set) {
    constexpr double guess = 0.01, least = 1e-12;  // of the displacement; [mm], where nothing moved
    const Problem problem = make_problem(set, 1);
    return make_problem(set, std::max(guess * problem.rms_mm(problem.displacement()), least));
}

MeasurementSet without_readings(const MeasurementSet& set, const std::vector<int>& readings) {
    MeasurementSet result = set;
    int number = 0;
    for (LoadState& state : result.states) {
        std::erase_if(state.readings, [&](const Reading& reading) {
            return is_usable(reading) && std::ranges::binary_search(readings, number++);
        });
    }
    return result;
}

}  // namespace palpate::identify
