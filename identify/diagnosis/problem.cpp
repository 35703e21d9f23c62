#include "identify/diagnosis/problem.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "identify/loading/lagged_load.h"
#include "identify/loading/loads.h"
#include "mesh/errors.h"

namespace palpate::identify {
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

namespace {

std::vector<mesh::Contact> acting(const LoadState& state) {
    std::vector<mesh::Contact> contacts;
    std::ranges::copy_if(state.contacts, std::back_inserter(contacts),
                         [](const mesh::Contact& c) { return !c.force.isZero(0); });
    return contacts;
}

bool counts(const Reading& reading) { return reading.marker >= 0 && !reading.position.array().isNaN().all(); }

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

bool is_read(const LoadState& state) { return std::ranges::any_of(state.readings, counts) || !state.reactions.empty(); }

Stage stage_of(const MeasurementSet& set, const LoadState& state) {
    return {state.probe,
            state.time,
            {.contacts = acting(state),
             .gravity = known_gravity(set, state).value_or(Vec3::Zero()),
             .pressure = known_pressure(state),
             .motions = state.motions,
             .settings = settings_of(state)}};
}

void relieve(Action& action) {
    action.contacts.clear();
    action.motions.clear();
    action.settings.clear();
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
            if (!counts(reading)) continue;
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

bool is_loaded(const Action& action) {
    return !action.contacts.empty() || !action.motions.empty() || !action.settings.empty();
}

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
    const double rms = rms_where(values, [this](Eigen::Index n) { return is_position(n); });
    return std::isnan(rms) ? 0 : rms;
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
