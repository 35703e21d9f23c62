#include "identify/diagnosis/verdict/trials.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "identify/diagnosis/verdict/further_loads.h"
#include "identify/diagnosis/verdict/probe_kinds.h"
#include "mesh/core/scaled_motion.h"
#include "mesh/geometry/sampling.h"

namespace palpate::identify {
namespace {

/// How strong an action is among those of its kind; presses before all others.
std::array<double, 3> strength_of(const Action& action) {
    const LoadSizes sizes = sizes_of(action);
    return {sizes.force, sizes.setting, sizes.way};
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
            all_.push_back({.probe = {.kind = probe_kinds::pressure},
                            .asks = "open the cavities, and read the unloaded body",
                            .states = {unloaded(0)},
                            .conditions = {.vented = true}});
        }
        all_.push_back({.probe = {.kind = probe_kinds::fiducials},
                        .asks = "read markers that are fixed next to the supports",
                        .states = {}});
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
        MeanPush push;
        for (const Stage& stage : own_)
            for (const mesh::Contact& contact : stage.action.contacts) push.count(contact);
        constexpr int places = 16;  // each is played twice under every explanation: the price of a finer search
        for (const int marker : mesh::farthest_points(problem_.rest.topRows(problem_.markers), places)) {
            const mesh::Contact inwards = push.at(model_, problem_.rest.row(marker));
            for (const double sign : {1.0, -1.0}) {
                mesh::Contact contact = inwards;
                contact.force *= sign;
                all_.push_back({.probe = {.kind = probe_kinds::load, .contact = contact},
                                .asks = "press and read all markers",
                                .states = {under({contact}, last_)}});
            }
        }
    }

    void add_repeats() {
        for (const Stage& stage : own_) {
            all_.push_back({.probe = {.kind = probe_kinds::repeat, .contact = contact_of(stage), .probe = stage.probe},
                            .asks = fmt::format("repeat probe {}", stage.probe),
                            .states = {under(stage.action, stage.time)}});
        }
    }

    /// The strongest held.
    void add_dwell() {
        const auto [soon, late] = dwell_times(last_);
        const Stage& stage = own_.front();
        all_.push_back({.probe = {.kind = probe_kinds::dwell, .contact = contact_of(stage), .times = {soon, late}},
                        .asks = fmt::format("hold one load, and read it after {:.3g} s and after {:.3g} s", soon, late),
                        .states = {under(stage.action, soon), under(stage.action, late)}});
    }

    /// The strongest half as strong again, half of that, and nothing; what is driven goes as far as it did.
    void add_release() {
        const Stage& stage = own_.front();
        const bool is_pressed = !stage.action.contacts.empty();
        const double most = is_pressed ? overload : 1;
        CandidateProbe trial{
            .probe = {.kind = probe_kinds::load_removed, .contact = contact_of(stage)},
            .asks = fmt::format("{}, and read the body again at half {} and once it is off",
                                is_pressed ? "load once more, stronger" : "drive it once more as far as ever",
                                is_pressed ? "the load" : "of that"),
            .states = {under(stage.action, 1, most), under(stage.action, 2, most / 2), unloaded(3)}};
        if (trial.probe.contact) trial.probe.contact->force *= most;
        all_.push_back(std::move(trial));
    }

    void add_turns() {
        const Vec3 known = problem_.actions.empty() ? Vec3(Vec3::Zero()) : problem_.actions.front().gravity;
        for (int axis = 0; axis < 3; ++axis) {
            for (const double degrees : {90.0, 180.0}) {
                const Vec3 about = Vec3::Unit(axis);
                const Mat3 turn = room_of_turned(about, degrees);
                LoadState state = unloaded(0);
                if (!known.isZero(0)) state.gravity = turn * known;
                all_.push_back({.probe = {.kind = probe_kinds::orientation, .turn = BodyTurn{about, degrees}},
                                .asks = fmt::format("read the unloaded body turned by {:.0f} degrees about ({:.3g}, "
                                                    "{:.3g}, {:.3g}), with its support",
                                                    degrees, about.x(), about.y(), about.z()),
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
