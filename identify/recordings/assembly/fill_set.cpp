#include "identify/recordings/assembly/fill_set.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "identify/numerics/summaries.h"
#include "identify/recordings/assembly/rest_markers.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

constexpr double by_noise = 3;  // sd

/// A state's point in the mesh's frame; of points in a plane the third coordinate is NaN.
Vec3 registered(const ProbeRecording& probe, const RigidMotion& frame, Vec3 at) {
    if (!probe.is_planar) return frame(at);
    at.z() = 0;
    Vec3 moved = frame(at);
    moved.z() = missing;
    return moved;
}

class SetFiller {
public:
    SetFiller(const ImportMap& map, const std::vector<ProbeStates>& probes, const RestState& rest,
              const StateFrames& frames, ImportReport& report)
        : map_(map), probes_(probes), rest_(rest), frames_(frames), report_(report), set_(map.set) {}

    MeasurementSet filled() {
        index_of_ = add_markers(map_, probes_, rest_, rest_frame(), set_, report_);
        std::size_t frame = 0;
        for (const ProbeStates& probe : probes_) {
            check_values(probe);
            for (const ImportedState& state : probe.states) add_state(probe, state, frames_.of_state[frame++]);
            tell_drift(probe);
        }
        return std::move(set_);
    }

private:
    /// Frame of the rest's first state.
    const RigidMotion& rest_frame() const {
        std::size_t before = 0;
        for (const ProbeStates& probe : probes_) {
            if (probe.probe == rest_.probe) break;
            before += probe.states.size();
        }
        return frames_.of_state[before];
    }

    /// Values that act where points have moved need a state in which they have not.
    void check_values(const ProbeStates& probe) const {
        if (probe.probe->values.empty() || probe.probe->values_act_always || probe.states.size() > 1) return;
        throw InvalidInput(
            fmt::format("{}: probe {} has one state, and its values act in those in which the points have left "
                        "their first place. Say 'while: always' in its entry of 'files'.",
                        map_.file.filename().string(), probe.probe->probe));
    }

    void add_state(const ProbeStates& probe, const ImportedState& imported, const RigidMotion& frame) {
        LoadState state{.probe = imported.probe, .time = imported.time};
        const StateName rest{rest_.state.probe, rest_.state.time};
        // Places that files tell are the marker's own: what has moved from there is a position.
        const bool counts_from_state = map_.reads_displacements && !rest_.is_of_files;
        const bool is_rest = state.probe == rest.probe && state.time == rest.time;
        for (std::size_t p = 0; p < imported.points.size(); ++p) {
            if (counts_from_state && is_rest) break;  // they count from here
            const auto marker = index_of_.find(probe.probe->points[p].name);
            const SteadyPoint& point = imported.points[p];
            if (marker == index_of_.end() || point.at.array().isNaN().all()) continue;
            const Vec3 at = registered(*probe.probe, frame, point.at);
            if (at.array().isNaN().all()) continue;
            const bool is_known = point.sigma > 0;
            state.readings.push_back(
                {.marker = marker->second,
                 .position = at,
                 .sigma = is_known ? std::max(least_position_noise, frame.scale * point.sigma) : missing,
                 .since = counts_from_state ? std::optional(rest) : std::nullopt});
        }
        for (std::size_t u = 0; u < map_.uses.size(); ++u) add_use(probe, imported, frame, u, state);
        set_.states.push_back(std::move(state));
    }

    /// What a channel says in a state, tared; nothing where it says nothing.
    std::optional<SteadyValue> value_in(const ProbeStates& probe, const ImportedState& state, std::size_t u) const {
        const MappedUse& use = map_.uses[u];
        SteadyValue value = state.values[u];
        if (value.samples == 0) return std::nullopt;
        const bool is_a_number = probe.probe->channel(use.channel) == nullptr;
        if (is_a_number && !probe.probe->values_act_always && !state.has_moved) value.mean = 0;
        if (use.tare) value.mean -= probe.states.front().values[u].mean;
        if (std::isfinite(use.sigma)) value.sigma = use.sigma;
        return value;
    }

    void add_use(const ProbeStates& probe, const ImportedState& imported, const RigidMotion& frame, std::size_t u,
                 LoadState& state) {
        const MappedUse& use = map_.uses[u];
        if (!use.points.empty()) {
            add_motion_of_points(probe, imported, frame, use, state);
            return;
        }
        const auto value = value_in(probe, imported, u);
        if (!value) return;
        switch (use.kind) {
            case MappedUse::Kind::force: {
                // what a load cell reads at rest is its noise
                const bool is_noise = !imported.has_moved && std::abs(value->mean) <= by_noise * value->sigma;
                if (!is_noise && value->mean != 0)
                    state.contacts.push_back({use.at, value->mean * use.axis, use.radius});
                break;
            }
            case MappedUse::Kind::motion: {
                mesh::ToolMotion& motion = motion_of(use, state);
                (use.is_about ? motion.rotation : motion.translation) += value->mean * use.axis;
                break;
            }
            case MappedUse::Kind::reaction:
                add_reaction(use, *value, state);
                break;
            case MappedUse::Kind::actuation:
                if (value->mean != 0)
                    state.actuations.push_back({use.target, value->mean, value->sigma > 0 ? value->sigma : missing});
                break;
        }
    }

    static mesh::ToolMotion& motion_of(const MappedUse& use, LoadState& state) {
        auto found = std::ranges::find(state.motions, use.target, &mesh::ToolMotion::tool);
        if (found == state.motions.end()) {
            state.motions.push_back({.tool = use.target});
            found = state.motions.end() - 1;
        }
        for (const int axis : use.free) found->translation[axis] = missing;
        return *found;
    }

    static void add_reaction(const MappedUse& use, const SteadyValue& value, LoadState& state) {
        auto found = std::ranges::find(state.reactions, use.target, &ReactionReading::tool);
        if (found == state.reactions.end()) {
            state.reactions.push_back({.tool = use.target});
            found = state.reactions.end() - 1;
        }
        Eigen::Index axis = 0;
        use.axis.cwiseAbs().maxCoeff(&axis);
        (use.is_about ? found->moment : found->force)[axis] = value.mean * (use.axis[axis] < 0 ? -1 : 1);
        if (!use.is_about && value.sigma > 0)
            found->sigma = std::max({least_force_noise, value.sigma, known_part(found->sigma)});
    }

    /// Places of some points in a state, in the mesh's frame; of those in a plane with z 0.
    static Points places_of(const std::vector<std::string>& names, const ProbeRecording& probe,
                            const ImportedState& state, const RigidMotion& frame) {
        Points places(std::ssize(names), 3);
        for (std::size_t i = 0; i < names.size(); ++i) {
            const auto point = std::ranges::find(probe.points, names[i], &RecordedPoint::name);
            Vec3 at = Vec3::Constant(missing);
            if (point != probe.points.end())
                at = registered(probe, frame, state.points[static_cast<std::size_t>(point - probe.points.begin())].at);
            if (probe.is_planar) at.z() = 0;
            places.row(static_cast<Eigen::Index>(i)) = at.transpose();
        }
        return places;
    }

    /// A tool goes where points on it go.
    void add_motion_of_points(const ProbeStates& probe, const ImportedState& imported, const RigidMotion& frame,
                              const MappedUse& use, LoadState& state) const {
        const Points before = places_of(use.points, *rest_.probe, rest_.state, rest_frame()),
                     after = places_of(use.points, *probe.probe, imported, frame);
        if (!before.allFinite() || !after.allFinite()) return;
        mesh::ToolMotion& motion = motion_of(use, state);
        const Vec3 origin = set_.tools[static_cast<std::size_t>(use.target)].origin;
        Vec3 moved = (after - before).colwise().mean().transpose();
        if (use.turns) {
            const Registration fit =
                probe.probe->is_planar ? fit_counterparts_in_plane(before, after) : fit_counterparts(before, after);
            const Eigen::AngleAxisd turn(fit.motion.R);
            motion.rotation += turn.angle() * turn.axis();
            moved = fit.motion(origin) - origin;
        }
        for (int axis = 0; axis < 3; ++axis) motion.translation[axis] += moved[axis];
    }

    /// What load cells read where nothing loads the body, against the first time.
    void tell_drift(const ProbeStates& probe) {
        for (std::size_t u = 0; u < map_.uses.size(); ++u) {
            const MappedUse& use = map_.uses[u];
            const bool is_a_force = use.kind == MappedUse::Kind::force || use.kind == MappedUse::Kind::reaction;
            if (!is_a_force || !probe.probe->channel(use.channel)) continue;
            const SteadyValue& first = probe.states.front().values[u];
            const ImportedState* last = nullptr;
            for (const ImportedState& state : probe.states)
                if (state.is_back && state.values[u].samples > 0) last = &state;
            if (!last || last == &probe.states.front() || first.samples == 0) continue;
            const double drift = last->values[u].mean - first.mean, sd = std::hypot(last->values[u].sigma, first.sigma);
            if (std::abs(drift) <= by_noise * sd) continue;
            report_.notes.push_back(
                fmt::format("Probe {}: without load '{}' reads {:.3g} {} more at {:.4g} s than at {:.4g} s ({:.2g} "
                            "sd): the load cell "
                            "drifts, or the body has not come back.",
                            probe.probe->probe, use.channel, drift, use.is_about ? "N mm" : "N", last->time,
                            probe.states.front().time, std::abs(drift) / sd));
        }
    }

    const ImportMap& map_;
    const std::vector<ProbeStates>& probes_;
    const RestState& rest_;
    const StateFrames& frames_;
    ImportReport& report_;
    MeasurementSet set_;
    std::map<std::string, int> index_of_;  // marker by the point's name
};

}  // namespace

MeasurementSet filled_set(const ImportMap& map, const std::vector<ProbeStates>& probes, const RestState& rest,
                          const StateFrames& frames, ImportReport& report) {
    return SetFiller(map, probes, rest, frames, report).filled();
}

}  // namespace palpate::identify
