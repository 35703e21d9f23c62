#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identify/diagnosis/fit/explanation.h"
#include "identify/effects/effect.h"
#include "identify/loading/history/lagged_load.h"
#include "mesh/numbers/median.h"
#include "mesh/text/words.h"

namespace palpate::identify {
namespace {

/// Readings and loads are stamped by clocks that differ: what is read at a time answers to the load of an earlier one.
/// Loads change evenly from state to state of a probe.
class ClockEffect : public EffectHypothesis {
public:
    const EffectDescription& description() const override {
        static const EffectDescription text{
            .name = "clock",
            .kind = EffectKind::measurement,
            .meaning = "The readings lag behind the loads by a time: each answers to the load of a while before.",
            .parameters = {"lag [s]: how much later readings are stamped than the loads that they answer to"},
            .reveals = "an error in proportion to how fast the load changes, of opposite sign as it rises and falls",
            .confused_with = {"viscosity", "plasticity", "stiffening"},
            .separating_probe = "hold each load until nothing moves any more before it is read",
            .next_probe = "dwell",
            .why_unshown = "no load changes from state to state of a probe"};
        return text;
    }

    std::vector<EffectNumber> numbers(const BodyModel&, const Problem& problem) const override {
        const double interval = typical_interval(problem);
        if (interval == 0) return {};
        // who reads states one by one would notice a lag of a whole interval
        return {{.name = "lag", .unit = "s", .prior_sd = 0.3 * interval}};
    }

    bool has_memory() const override { return true; }

    Action act(const Problem& problem, int k, Action action, const Eigen::VectorXd& values) const override {
        return problem.by_stage ? lagged(problem, k, std::move(action), values[0]) : action;
    }

    /// Its derivative has a jump at 0: readings that are late and such that are early are alternatives.
    std::optional<ScreenPlan> screen_plan(const BodyModel& model, const Problem& problem,
                                          const Explanation& explanation,
                                          const ForwardSolution& forward) const override {
        const double interval = typical_interval(problem), h = 0.1 * interval;
        const ModelSetting setting = explanation.setting();
        ScreenPlan plan;
        plan.signatures = {2, [&model, &problem, &forward, setting, h](int k, const Eigen::VectorXd& q) {
                               const Action& now = forward.actions[k];
                               const auto tools = static_cast<Eigen::Index>(now.motions.size());
                               Signatures::InAction result;
                               result.forces.resize(model.dofs(), 2);
                               result.reactions.resize(6 * tools, 2);
                               for (const int side : {0, 1}) {
                                   const double lag = side == 0 ? h : -h;
                                   const Action then = lagged(problem, k, now, lag);
                                   result.forces.col(side) =
                                       (model.residual(q, setting, then) - model.residual(q, setting, now)) / h;
                                   if (tools == 0) continue;
                                   result.reactions.col(side) =
                                       (model.reactions(q, setting, then) - model.reactions(q, setting, now)) / h;
                               }
                               result.columns = {0, 1};
                               return result;
                           }};
        plan.columns = [interval](const Eigen::MatrixXd& sensitivities) {
            return ScreenColumns{sensitivities, Eigen::VectorXd::Constant(1, 0.3 * interval), true};
        };
        plan.start = [interval](Eigen::Index side, const Eigen::VectorXd& lag) {
            const double size = std::clamp(lag[0], 0.02 * interval, 0.9 * interval);
            return Eigen::VectorXd::Constant(1, side == 0 ? size : -size);
        };
        plan.place = [](Eigen::Index side) { return static_cast<int>(side); };
        return plan;
    }

    std::string sentence(const skeleton::EffectRecord& record) const override {
        return sentence_with(record, Eigen::MatrixXd::Zero(1, 1));
    }

    std::string sentence_with(const skeleton::EffectRecord& record, const Eigen::MatrixXd& covariance) const override {
        const double lag = record.parameters[0].value;
        const std::string size = mesh::with_sd(std::abs(lag), std::sqrt(covariance(0, 0))) + " s";
        return lag >= 0 ? fmt::format("The readings lag behind the loads by {}.", size)
                        : fmt::format("The readings are stamped {} before the loads that they answer to.", size);
    }

    MeasurementSet corrected(const MeasurementSet& set, const skeleton::EffectRecord& record) const override {
        const double lag = number_of(record, "lag");
        MeasurementSet result = set;
        for (std::size_t first = 0; first < set.states.size();) {
            std::size_t end = first;
            std::vector<double> times;
            for (; end < set.states.size() && set.states[end].probe == set.states[first].probe; ++end)
                times.push_back(set.states[end].time);
            const LoadState nothing;
            for (std::size_t s = first; s < end; ++s) {
                const InstantBetween at = place_among(times, set.states[s].time - lag);
                const LoadState& before = at.before < 0 ? nothing : set.states[first + at.before];
                const LoadState& after = set.states[first + at.after];
                LoadState& state = result.states[s];
                state.contacts = between(before.contacts, after.contacts, at.share);
                state.motions = between(before.motions, after.motions, at.share, std::move(state.motions));
                state.actuations.clear();
                for (const mesh::ActuatorSetting& one : between(settings_of(before), settings_of(after), at.share)) {
                    const auto own = std::ranges::find(after.actuations, one.actuator, &Actuation::actuator);
                    state.actuations.push_back(
                        {one.actuator, one.value, own == after.actuations.end() ? missing : own->sigma});
                }
            }
            first = end;
        }
        return result;
    }

    void hide(const skeleton::EffectRecord& record, TrueConditions& conditions) const override {
        conditions.lag = number_of(record, "lag");
    }

    SynthesisNeeds needs() const override { return {.changing_loads = true}; }
    std::vector<skeleton::KnownParameter> numbers_to_hide() const override { return {{"lag", "s"}}; }
    std::optional<std::uint64_t> stream() const override { return 16; }

    /// In shares of the time between loads, which is a second unless told.
    std::vector<EffectSampler> samplers(SamplingContext& context, const SpecifiedNumbers& specified) const override {
        const double interval = context.dwell.empty() ? 1 : context.dwell.front();
        const auto at = [=](double x) { return specified.effect({{"lag", x * interval}}); };
        return {{.at = at, .start = 0.2, .most = 0.9, .is_specified = specified.has("lag")}};
    }

private:
    /// Gravity and cavities' pressure are of a pose, and do not lag.
    static bool is_loaded_otherwise(const Action& a, Action b) {
        b.gravity = a.gravity;
        b.pressure = a.pressure;
        return !is_same(a, b);
    }

    /// Median time between states of a probe whose loads differ [s]; 0: there are none.
    static double typical_interval(const Problem& problem) {
        std::vector<double> intervals;
        for (std::size_t s = 1; s < problem.stages.size(); ++s) {
            const Stage &before = problem.stages[s - 1], &now = problem.stages[s];
            if (before.probe == now.probe && now.time > before.time && is_loaded_otherwise(before.action, now.action))
                intervals.push_back(now.time - before.time);
        }
        return intervals.empty() ? 0 : mesh::upper_median(std::move(intervals));
    }

    /// What acted a while before action k, which the other effects have made `now`.
    static Action lagged(const Problem& problem, int k, Action now, double lag) {
        int first = k;
        while (first > 0 && problem.stages[first - 1].probe == problem.stages[k].probe) --first;
        std::vector<double> times;
        for (int s = first; s < std::ssize(problem.stages) && problem.stages[s].probe == problem.stages[k].probe; ++s)
            times.push_back(problem.stages[s].time);
        const InstantBetween at = place_among(times, problem.stages[k].time - lag);
        const Action nothing, own = now;
        const auto action_at = [&](int i) -> const Action& {
            if (i < 0) return nothing;
            return first + i == k ? own : problem.stages[first + i].action;
        };
        const Action &before = action_at(at.before), &after = action_at(at.after);
        now.contacts = between(before.contacts, after.contacts, at.share);
        now.motions = between(before.motions, after.motions, at.share, std::move(now.motions));
        now.settings = between(before.settings, after.settings, at.share);
        return now;
    }

    static std::vector<mesh::ActuatorSetting> settings_of(const LoadState& state) {
        std::vector<mesh::ActuatorSetting> settings;
        settings.reserve(state.actuations.size());
        for (const Actuation& one : state.actuations) settings.push_back({one.actuator, one.value});
        return settings;
    }
};

}  // namespace

std::shared_ptr<const EffectHypothesis> clock_effect() { return std::make_shared<ClockEffect>(); }

}  // namespace palpate::identify
