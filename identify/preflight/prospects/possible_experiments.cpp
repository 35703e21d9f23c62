#include "identify/preflight/prospects/possible_experiments.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "identify/diagnosis/verdict/further_loads.h"
#include "identify/diagnosis/verdict/probe_kinds.h"
#include "identify/numerics/summaries.h"
#include "mesh/core/scaled_motion.h"

namespace palpate::identify {
namespace {

// As the file of a check names them.
constexpr const char* unloaded_pose = "unload";
constexpr const char* load_removed = "release";

bool is_driven(const LoadState& state) {
    return has_contact_force(state) || !state.motions.empty() ||
           std::ranges::any_of(state.actuations, [](const Actuation& a) { return a.value != 0; });
}

/// How large a load is next to others of its kind.
double size_of(const LoadState& state) {
    double size = 0;
    for (const mesh::Contact& contact : state.contacts) size += contact.force.norm();
    if (size > 0) return size;
    for (const mesh::ToolMotion& motion : state.motions) size += known_part(motion.translation).norm();
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
        if (!has_unloaded_)
            add(unloaded_pose, "Read all markers with nothing pressing, pulling or driving", {LoadState{}});
        add_turns();
        if (!own_.empty()) {
            add_levels();
            add_repeats();
            add_places();
            add_dwell();
            add_release();
        }
        if (model_.has_cavities()) {
            add(probe_kinds::pressure, "Read the unloaded pose once more with its cavities open to the air",
                {LoadState{}});
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
            const Mat3 turn = room_of_turned(Vec3::Unit(axis), 90);
            LoadState state;
            if (!known.isZero(0)) state.gravity = turn * known;
            states.push_back(state);
            conditions.push_back({.turn = turn});
        }
        add(probe_kinds::orientation,
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
        add(probe_kinds::repeat, fmt::format("Repeat {}, each set up anew", probes()), states);
    }

    /// Pushes at places over the markers that no probe has pressed, as strong as the own ones are on average.
    void add_places() {
        MeanPush push;
        Points touched(0, 3);
        for (const LoadState& state : own_) {
            for (const mesh::Contact& contact : state.contacts) {
                push.count(contact);
                touched.conservativeResize(touched.rows() + 1, 3);
                touched.row(touched.rows() - 1) = contact.point;
            }
        }
        if (!push.is_known() || problem_.markers == 0) return;
        constexpr int places = 6;  // a choice: each costs a solve here, and a minute of who measures
        std::vector<int> far;      // in turn the marker that lies furthest from what is touched
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
            LoadState state;
            state.time = last_;
            state.contacts = {push.at(model_, point)};
            states.push_back(state);
            at += fmt::format("{}({:.3g}, {:.3g}, {:.3g})", at.empty() ? "" : ", ", point.x(), point.y(), point.z());
        }
        add(probe_kinds::load, fmt::format("Press inwards with {:.2g} N at {} mm", push.force(), at), states);
    }

    /// The strongest held, read at once and ten times as late as any so far.
    void add_dwell() {
        const auto [soon, late] = dwell_times(last_);
        add(probe_kinds::dwell,
            fmt::format("Hold the load of probe {}, and read it after {:g} s and after {:g} s", own_.front().probe,
                        soon, late),
            {scaled(own_.front(), 1, 1, soon), scaled(own_.front(), 1, 1, late)});
    }

    /// The strongest half as strong again, and taken off.
    void add_release() {
        LoadState off;
        off.probe = 1;
        off.time = 2;
        add(load_removed,
            fmt::format("Load as in probe {} and half as much again, take it off, and read the unloaded pose",
                        own_.front().probe),
            {scaled(own_.front(), overload, 1, 1), off});
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

}  // namespace

std::vector<Experiment> possible_experiments(const BodyModel& model, const MeasurementSet& set,
                                             const Problem& problem) {
    return Experiments(model, set, problem).all();
}

}  // namespace palpate::identify
