#include "identify/preflight/prospects/experiments.h"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "mesh/core/scaled_motion.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

bool is_driven(const LoadState& state) {
    return std::ranges::any_of(state.contacts, [](const auto& c) { return !c.force.isZero(0); }) ||
           !state.motions.empty() ||
           std::ranges::any_of(state.actuations, [](const Actuation& a) { return a.value != 0; });
}

/// How large a load is next to others of its kind.
double size_of(const LoadState& state) {
    double size = 0;
    for (const mesh::Contact& contact : state.contacts) size += contact.force.norm();
    if (size > 0) return size;
    for (const mesh::ToolMotion& motion : state.motions)
        size += motion.translation.array().isNaN().select(0, motion.translation).norm();
    if (size > 0) return size;
    for (const Actuation& one : state.actuations) size += std::abs(one.value);
    return size;
}

/// What acts, `share` times as much, at a probe of its own; nothing is read yet.
LoadState scaled(const LoadState& state, double share, int probe, double time) {
    LoadState result = state;
    result.probe = probe;
    result.time = time;
    result.readings.clear();
    result.reactions.clear();
    result.field.clear();
    for (mesh::Contact& contact : result.contacts) contact.force *= share;
    for (mesh::ToolMotion& motion : result.motions) motion = mesh::scaled(motion, share);
    for (Actuation& one : result.actuations) one.value *= share;
    return result;
}

/// Collects what a set lacks.
class Experiments {
public:
    Experiments(const BodyModel& model, const MeasurementSet& set, const Problem& problem)
        : model_(model), set_(set), problem_(problem) {
        std::set<int> seen;
        for (const LoadState& state : set.states) {
            next_probe_ = std::max(next_probe_, state.probe + 1);
            last_ = std::max(last_, state.time);
            has_unloaded_ |= !is_driven(state) && !state.readings.empty();
            if (is_driven(state)) own_.push_back(state);
        }
        // the strongest of each probe
        std::ranges::stable_sort(own_, std::greater{}, size_of);
        std::erase_if(own_, [&](const LoadState& state) { return !seen.insert(state.probe).second; });
        constexpr std::size_t most = 8;  // in an hour
        if (own_.size() > most) own_.resize(most);
    }

    std::vector<Experiment> all() {
        if (!has_unloaded_) add("unload", "Read all markers with nothing pressing, pulling or driving", {LoadState{}});
        add_turns();
        if (!own_.empty()) {
            add_levels();
            add_repeats();
            add_places();
            add_dwell();
            add_release();
        }
        if (model_.has_cavities()) {
            add("pressure", "Read the unloaded pose once more with its cavities open to the air", {LoadState{}});
            all_.back().conditions.front().vented = true;
        }
        return std::move(all_);
    }

private:
    void add(const std::string& kind, const std::string& words, std::vector<LoadState> states) {
        int probe = next_probe_;
        int last = 0;
        for (std::size_t s = 0; s < states.size(); ++s) {
            // states without a probe get their own; those of one probe keep one
            if (states[s].probe <= 0) {
                states[s].probe = probe++;
            } else {
                if (s == 0 || states[s].probe != last) ++probe;
                last = states[s].probe;
                states[s].probe = probe - 1;
            }
        }
        const std::size_t count = states.size();
        all_.push_back({kind, words, std::move(states), std::vector<ProbeConditions>(count)});
    }

    void add_turns() {
        const Vec3 known = set_.gravity.value_or(Vec3::Zero());
        std::vector<LoadState> states;
        std::vector<ProbeConditions> conditions;
        for (const int axis : {0, 1, 2}) {
            // The room's directions turn the other way in the body's frame.
            const Mat3 turn = Eigen::AngleAxisd(-std::numbers::pi / 2, Vec3::Unit(axis)).toRotationMatrix();
            LoadState state;
            if (!known.isZero(0)) state.gravity = turn * known;
            states.push_back(state);
            conditions.push_back({.turn = turn});
        }
        add("orientation",
            "Turn the body with its supports by 90 degrees about x, about y, about z, and read it unloaded each time",
            states);
        all_.back().conditions = conditions;
    }

    void add_levels() {
        // Where probes have several levels already there is less to gain, which the evidence tells.
        std::vector<LoadState> states;
        for (const LoadState& state : own_) {
            for (const double share : {1.0 / 3, 2.0 / 3}) states.push_back(scaled(state, share, 0, state.time));
        }
        add("levels", fmt::format("Take {} at one third and at two thirds of the load as well", probes()), states);
    }

    void add_repeats() {
        std::vector<LoadState> states;
        for (const LoadState& state : own_) states.push_back(scaled(state, 1, 0, state.time));
        add("repeat", fmt::format("Repeat {}, each set up anew", probes()), states);
    }

    /// Pushes at places over the markers that no probe has pressed, as strong as the own ones are on average.
    void add_places() {
        double force = 0, radius = 0;
        int count = 0;
        Points touched(0, 3);
        for (const LoadState& state : own_) {
            for (const mesh::Contact& contact : state.contacts) {
                force += contact.force.norm();
                radius += contact.radius;
                ++count;
                touched.conservativeResize(count, 3);
                touched.row(count - 1) = contact.point;
            }
        }
        if (count == 0 || problem_.markers == 0) return;
        constexpr int places = 6;
        std::vector<int> far;  // in turn the marker that lies furthest from what is touched
        Points rest = problem_.rest.topRows(problem_.markers);
        for (Eigen::Index m = 0; m < rest.rows(); ++m) {
            const std::optional<Vec3>& anchor = set_.markers[static_cast<std::size_t>(m)].anchor;
            if (anchor) rest.row(m) = anchor->transpose();  // on the body, where a finger can press
        }
        for (int i = 0; i < std::min(places, problem_.markers); ++i) {
            Eigen::Index furthest = 0;
            double most = -1;
            for (Eigen::Index m = 0; m < rest.rows(); ++m) {
                const double near = (touched.rowwise() - rest.row(m)).rowwise().norm().minCoeff();
                if (near > most) {
                    most = near;
                    furthest = m;
                }
            }
            far.push_back(static_cast<int>(furthest));
            touched.conservativeResize(touched.rows() + 1, 3);
            touched.row(touched.rows() - 1) = rest.row(furthest);
        }
        std::vector<LoadState> states;
        std::string at;
        for (const int m : far) {
            const Vec3 point = rest.row(m);
            const Vec3 push = -force / count * model_.normal_near(point, 0.05 * model_.size());
            LoadState state;
            state.time = last_;
            state.contacts = {{.point = point, .force = push, .radius = radius / count}};
            states.push_back(state);
            at += fmt::format("{}({:.3g}, {:.3g}, {:.3g})", at.empty() ? "" : ", ", point.x(), point.y(), point.z());
        }
        add("load", fmt::format("Press inwards with {:.2g} N at {} mm", force / count, at), states);
    }

    /// The strongest held, read at once and ten times as late as any so far.
    void add_dwell() {
        const double late = last_ > 0 ? 10 * last_ : 100, soon = 1e-3 * late;
        add("dwell",
            fmt::format("Hold the load of probe {}, and read it after {:g} s and after {:g} s", own_.front().probe,
                        soon, late),
            {scaled(own_.front(), 1, 1, soon), scaled(own_.front(), 1, 1, late)});
    }

    /// The strongest half as strong again, and taken off.
    void add_release() {
        LoadState off;
        off.probe = 1;
        off.time = 2;
        add("release",
            fmt::format("Load as in probe {} and half as much again, take it off, and read the unloaded pose",
                        own_.front().probe),
            {scaled(own_.front(), 1.5, 1, 1), off});
    }

    std::string probes() const {
        std::string names;
        for (const LoadState& state : own_) names += fmt::format("{}{}", names.empty() ? "" : ", ", state.probe);
        return (own_.size() == 1 ? "probe " : "probes ") + names;
    }

    const BodyModel& model_;
    const MeasurementSet& set_;
    const Problem& problem_;
    std::vector<LoadState> own_;
    int next_probe_ = 1;
    double last_ = 0;
    bool has_unloaded_ = false;
    std::vector<Experiment> all_;
};

/// The set with an experiment that reads every marker, and of each tool that touches what the set reads of it.
MeasurementSet with_states(const MeasurementSet& set, const Experiment& experiment) {
    MeasurementSet result = set;
    for (LoadState state : experiment.states) {
        for (std::size_t m = 0; m < set.markers.size(); ++m)
            state.readings.push_back({.marker = static_cast<int>(m), .position = set.markers[m].rest});
        for (const mesh::ToolMotion& motion : state.motions) {
            for (const LoadState& other : set.states) {
                const auto read = std::ranges::find(other.reactions, motion.tool, &ReactionReading::tool);
                if (read == other.reactions.end()) continue;
                state.reactions.push_back(*read);
                break;
            }
        }
        result.states.push_back(state);
    }
    return result;
}

/// Signatures in states where the body is turned or vented: an effect's numbers are others there.
void turn_numbers(const BodyModel& model, const Problem& problem, const Experiment& experiment, int first_state,
                  EffectSignature& signature) {
    const std::vector<EffectNumber> numbers = signature.effect->numbers(model, problem);
    const Eigen::Index p = std::ssize(numbers);
    if (p == 0 || signature.columns.alternatives() != 1 || signature.columns.columns.cols() != p) return;
    for (Eigen::Index n = 0; n < problem.rows(); ++n) {
        const int added = problem.state[n] - first_state;
        if (added < 0) continue;
        const ProbeConditions& conditions = experiment.conditions[static_cast<std::size_t>(added)];
        if (conditions.turn.isIdentity(0) && !conditions.vented) continue;
        Eigen::MatrixXd map(p, p);
        const Eigen::VectorXd none = signature.effect->under(conditions, Eigen::VectorXd::Zero(p));
        for (Eigen::Index j = 0; j < p; ++j)
            map.col(j) = signature.effect->under(conditions, Eigen::VectorXd::Unit(p, j)) - none;
        signature.columns.columns.row(n) = signature.columns.columns.row(n).eval() * map;
    }
}

}  // namespace

std::vector<Experiment> possible_experiments(const BodyModel& model, const MeasurementSet& set,
                                             const Problem& problem) {
    return Experiments(model, set, problem).all();
}

std::vector<ExperimentProspect> experiment_prospects(const BodyModel& model, const MeasurementSet& set, double noise,
                                                     const Explanation& guess,
                                                     const std::vector<EffectProspect>& before,
                                                     const std::vector<Experiment>& experiments,
                                                     const DiagnoseOptions& options) {
    std::vector<std::shared_ptr<const EffectHypothesis>> effects;
    for (const EffectProspect& one : before)
        if (!one.effect->sets_readings_aside() && !one.effect->is_of_links()) effects.push_back(one.effect);
    std::vector<ExperimentProspect> result;
    const auto try_out = [&](const Experiment& experiment) {
        const MeasurementSet more = with_states(set, experiment);
        Problem problem = make_problem(more, noise);
        const LinearPoint point = linearise(model, problem, guess, options.mesh_error, options.refit.threads);
        const auto first = static_cast<int>(set.states.size());
        const Eigen::VectorXd answered = problem.pick(point.forward.markers);
        for (Eigen::Index n = 0; n < problem.rows(); ++n)
            if (problem.state[n] >= first) problem.measured[n] = answered[n];
        std::vector<EffectSignature> signatures = signatures_at(model, problem, point, effects, options.refit.threads);
        for (EffectSignature& signature : signatures) turn_numbers(model, problem, experiment, first, signature);
        const std::vector<EffectProspect> after = effect_prospects(model, problem, point.all, signatures, options);

        ExperimentProspect prospect{.experiment = experiment};
        for (const EffectProspect& then : after) {
            const EffectProspect& now = *std::ranges::find(before, then.effect, &EffectProspect::effect);
            constexpr double enough = 0.5;      // of the cases
            constexpr double noticeable = 0.8;  // of the strength: a fifth less
            const bool eases = then.least < noticeable * now.least || then.share > now.share + (1 - noticeable);
            if (!then.why_not.empty() || !eases) continue;
            prospect.gains.push_back({then.effect->name(), now.share, then.share, now.least, then.least});
            if (then.share >= enough && now.share < enough) prospect.opens.push_back(then.effect->name());
        }
        if (!prospect.gains.empty()) result.push_back(std::move(prospect));
    };
    for (const Experiment& experiment : experiments) {
        try {
            try_out(experiment);
        } catch (const SolverFailure&) {  // more than the body bears, as far as is known: none to propose
        }
    }
    const auto worth = [](const ExperimentProspect& one) {
        double eased = 0;  // a factor of ten of one effect is as good as that of another
        for (const ExperimentGain& gain : one.gains) {
            constexpr double most = 10;
            const double now = std::min(gain.least_before, 1e4), then = std::max(gain.least_after, 1e-4);
            eased += std::log(std::clamp(now / then, 1.0, most));
        }
        return std::pair(one.opens.size(), eased);
    };
    std::ranges::stable_sort(result, std::greater{}, worth);
    return result;
}

}  // namespace palpate::identify
