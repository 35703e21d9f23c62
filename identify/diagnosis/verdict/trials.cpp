#include "identify/diagnosis/verdict/trials.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "mesh/core/scaled_motion.h"
#include "mesh/geometry/sampling.h"

namespace palpate::identify {
namespace {

/// How strong an action is among those of its kind; presses before all others.
std::array<double, 3> strength_of(const Action& action) {
    double force = 0, value = 0, way = 0;
    for (const mesh::Contact& contact : action.contacts) force += contact.force.norm();
    for (const mesh::ActuatorSetting& setting : action.settings) value += std::abs(setting.value);
    for (const mesh::ToolMotion& motion : action.motions)
        way += motion.translation.array().isNaN().select(0, motion.translation).norm();
    return {force, value, way};
}

/// Collects trials that begin like the problem's own probes.
class Trials {
public:
    Trials(const BodyModel& model, const Problem& problem) : model_(model), problem_(problem) {
        for (const Stage& stage : problem.stages) {
            if (is_loaded(stage.action)) own_.push_back(stage);
            last_ = std::max(last_, stage.time);
            new_probe_ = std::max(new_probe_, stage.probe + 1);
        }
        // in turn from the strongest, one of a probe
        std::ranges::stable_sort(own_, std::greater{}, [](const Stage& s) { return strength_of(s.action); });
        std::vector<int> seen;
        std::erase_if(own_, [&](const Stage& stage) {
            if (std::ranges::find(seen, stage.probe) != seen.end()) return true;
            seen.push_back(stage.probe);
            return false;
        });
    }

    std::vector<CandidateProbe> all() {
        if (!own_.empty()) {
            if (!own_.front().action.contacts.empty()) add_loads();
            add_repeats();
            add_dwell();
            add_release();
        }
        add_turns();
        if (model_.has_cavities()) {
            all_.push_back({.probe = {.kind = "pressure"}, .states = {unloaded(0)}, .conditions = {.vented = true}});
        }
        all_.push_back({.probe = {.kind = "fiducials"}, .states = {}});
        return std::move(all_);
    }

private:
    LoadState unloaded(double time) const { return {.probe = new_probe_, .time = time}; }
    LoadState under(const std::vector<mesh::Contact>& contacts, double time) const {
        return {.probe = new_probe_, .time = time, .contacts = contacts};
    }
    /// A share of all that acts.
    LoadState under(const Action& action, double time, double share = 1) const {
        LoadState state = under(action.contacts, time);
        for (mesh::Contact& contact : state.contacts) contact.force *= share;
        for (const mesh::ToolMotion& motion : action.motions) state.motions.push_back(mesh::scaled(motion, share));
        for (const mesh::ActuatorSetting& setting : action.settings)
            state.actuations.push_back({setting.actuator, share * setting.value});
        return state;
    }
    static std::optional<mesh::Contact> contact_of(const Stage& stage) {
        if (stage.action.contacts.empty()) return std::nullopt;
        return stage.action.contacts.front();
    }

    /// Inwards and outwards at places over the markers, as strong as the own ones are on average.
    void add_loads() {
        double force = 0, radius = 0;
        int count = 0;
        for (const Stage& stage : own_) {
            for (const mesh::Contact& contact : stage.action.contacts) {
                force += contact.force.norm();
                radius += contact.radius;
                ++count;
            }
        }
        constexpr int places = 16;
        for (const int marker : mesh::farthest_points(problem_.rest.topRows(problem_.markers), places)) {
            const Vec3 at = problem_.rest.row(marker);
            const Vec3 push = -force / count * model_.normal_near(at, 0.05 * model_.size());
            for (const double sign : {1.0, -1.0}) {
                const mesh::Contact contact{.point = at, .force = sign * push, .radius = radius / count};
                all_.push_back({.probe = {.kind = "load", .contact = contact}, .states = {under({contact}, last_)}});
            }
        }
    }

    void add_repeats() {
        for (const Stage& stage : own_) {
            all_.push_back({.probe = {.kind = "repeat", .contact = contact_of(stage), .probe = stage.probe},
                            .states = {under(stage.action, stage.time)}});
        }
    }

    /// The strongest held, read at once and ten times as late as any so far.
    void add_dwell() {
        const double late = last_ > 0 ? 10 * last_ : 100, soon = 1e-3 * late;
        const Stage& stage = own_.front();
        all_.push_back({.probe = {.kind = "dwell", .contact = contact_of(stage), .times = {soon, late}},
                        .states = {under(stage.action, soon), under(stage.action, late)}});
    }

    /// The strongest half as strong again, half of that, and nothing; what is driven goes as far as it did.
    void add_release() {
        const Stage& stage = own_.front();
        const double most = stage.action.contacts.empty() ? 1 : 1.5;
        CandidateProbe trial{.probe = {.kind = "unload", .contact = contact_of(stage)},
                             .states = {under(stage.action, 1, most), under(stage.action, 2, most / 2), unloaded(3)}};
        if (trial.probe.contact) trial.probe.contact->force *= most;
        all_.push_back(std::move(trial));
    }

    void add_turns() {
        const Vec3 known = problem_.actions.empty() ? Vec3(Vec3::Zero()) : problem_.actions.front().gravity;
        for (int axis = 0; axis < 3; ++axis) {
            for (const double degrees : {90.0, 180.0}) {
                const Vec3 about = Vec3::Unit(axis);
                // The room's directions turn the other way in the body's frame.
                const Mat3 turn = Eigen::AngleAxisd(-degrees * std::numbers::pi / 180, about).toRotationMatrix();
                LoadState state = unloaded(0);
                if (!known.isZero(0)) state.gravity = turn * known;
                all_.push_back({.probe = {.kind = "orientation", .turn = BodyTurn{about, degrees}},
                                .states = {state},
                                .conditions = {.turn = turn}});
            }
        }
    }

    const BodyModel& model_;
    const Problem& problem_;
    std::vector<Stage> own_;  // one of each probe with a load, the strongest first
    double last_ = 0;         // time
    int new_probe_ = 1;
    std::vector<CandidateProbe> all_;
};

}  // namespace

std::vector<CandidateProbe> candidate_probes(const BodyModel& model, const Problem& problem) {
    return Trials(model, problem).all();
}

}  // namespace palpate::identify
