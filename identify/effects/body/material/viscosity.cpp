#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "identify/diagnosis/fit/explanation.h"
#include "identify/effects/effect.h"
#include "identify/effects/vector_words.h"
#include "identify/loading/creep.h"

namespace palpate::identify {
namespace {

/// The load that an elastic body would bear at a stage, whose own load the other effects have made `now`.
std::vector<mesh::Contact> creep_equivalent_load(const Problem& problem, int k, const std::vector<mesh::Contact>& now,
                                                 const fem::CreepLaw& creep) {
    std::vector<HeldLoad> history{{problem.stages[k].time, now}};
    for (int stage = k - 1; stage >= 0 && problem.stages[stage].probe == problem.stages[k].probe; --stage) {
        history.push_back({problem.stages[stage].time, problem.stages[stage].action.contacts});
    }
    std::ranges::reverse(history);
    return creep_equivalent_load(history, creep);
}

/// The body gives way further while a load is held, and comes back slowly.
class ViscosityEffect : public EffectHypothesis {
public:
    const EffectDescription& description() const override {
        static const EffectDescription text{
            .name = "viscosity",
            .kind = EffectKind::body,
            .meaning = "The material creeps: under a load that is held it gives way further, all moduli alike.",
            .parameters = {"creep [-]: how much the compliance grows in the end, over that at once",
                           "tau [s]: time in which it does"},
            .reveals = "an error that grows with the time that a load is held, or fades after it is taken off",
            .confused_with = {"force-gain", "plasticity", "clock"},
            .separating_probe = "hold the same load for two different times",
            .next_probe = "dwell",
            .why_unshown = "no load is read at two times after it was put on"};
        return text;
    }

    std::vector<EffectNumber> numbers(const BodyModel&, const Problem& problem) const override {
        const std::vector<double> times = informative_times(problem);
        if (times.size() < 2) return {};
        const double tau = std::log(std::sqrt(times.front() * times.back()));
        return {{.name = "creep", .unit = "1", .prior_sd = 1, .least = 0},
                {.name = "tau", .unit = "s", .start = tau, .prior_mean = tau, .prior_sd = 2, .logarithm = true}};
    }

    bool has_memory() const override { return true; }

    Action act(const Problem& problem, int k, Action action, const Eigen::VectorXd& values) const override {
        if (!problem.by_stage) return action;
        action.contacts = creep_equivalent_load(problem, k, action.contacts, {values[0], std::exp(values[1])});
        return action;
    }

    bool enforce(const Eigen::VectorXd& values, ModelSetting& setting) const override {
        setting.effects.creep = fem::CreepLaw{values[0], std::exp(values[1])};
        return false;
    }

    std::optional<ScreenedNumber> screened_number() const override {
        return ScreenedNumber{.name = "creep", .unit = "1", .value = [](double creep) { return creep; }};
    }

    std::optional<ScreenPlan> screen_plan(const BodyModel& model, const Problem& problem,
                                          const Explanation& explanation,
                                          const ForwardSolution& forward) const override {
        // The load grows in proportion to the creep: its signature is the load itself, stage by stage, for each tau.
        const std::vector<double> times = informative_times(problem);
        // From half the first time that tells of it to twice the last one, evenly in ln tau: over two decades eight lie
        // a factor of two apart. Each costs a solve in every action.
        constexpr int count = 8;
        std::vector<double> taus(count);
        for (int i = 0; i < count; ++i) {
            taus[i] = 0.5 * times.front() * std::pow(4 * times.back() / times.front(), i / (count - 1.0));
        }
        const ModelSetting setting = explanation.setting();
        ScreenPlan plan;
        plan.signatures = {
            count, [&model, &problem, &forward, setting, taus](int k, const Eigen::VectorXd& q) {
                Signatures::InAction result;
                result.forces = Eigen::MatrixXd::Zero(model.dofs(), count);
                const std::vector<mesh::Contact>& elastic = forward.actions[k].contacts;
                for (int i = 0; i < count; ++i) {
                    for (const mesh::Contact& c : creep_equivalent_load(problem, k, elastic, {1, taus[i]})) {
                        result.forces.col(i) += model.contact_force(q, setting, c);
                    }
                    for (const mesh::Contact& c : elastic) {
                        result.forces.col(i) -= model.contact_force(q, setting, c);
                    }
                    result.columns.push_back(i);
                }
                return result;
            }};
        plan.columns = [](const Eigen::MatrixXd& sensitivities) {
            return ScreenColumns{sensitivities, Eigen::VectorXd::Constant(1, 1.0), true};
        };
        // no more than a body bears that was fitted to all times alike
        plan.start = [taus](Eigen::Index i, const Eigen::VectorXd& creep) {
            return Eigen::Vector2d(std::clamp(creep[0], 0.05, 0.3), std::log(taus[i]));
        };
        return plan;
    }

    std::string sentence(const skeleton::EffectRecord& record) const override { return sentence_with(record, {}); }

    std::string sentence_with(const skeleton::EffectRecord& record, const Eigen::MatrixXd& covariance) const override {
        return fmt::format("The material creeps: under a held load its compliance grows by {} % in about {} s.",
                           number_in_words(record, 0, covariance, 100), number_in_words(record, 1, covariance));
    }

    SynthesisNeeds needs() const override { return {.dwells = true}; }

    std::string why_not_driven(int tool_places) const override {
        return tool_places > 0 ? "the force of a tool that is moved would relax; press with forces" : "";
    }
    std::optional<std::uint64_t> stream() const override { return 9; }

    std::vector<EffectSampler> samplers(SamplingContext& context, const SpecifiedNumbers& specified) const override {
        // Between the first and the last reading, so that both show.
        const std::vector<double>& dwell = context.dwell;
        const double tau = dwell.size() > 1 ? std::sqrt(dwell.front() * dwell.back()) : 1;
        const double drawn = tau * std::exp(context.random.uniform() - 0.5);
        const auto at = [=](double x) { return specified.effect({{"creep", x}, {"tau", drawn}}); };
        return {{.at = at, .start = 0.5, .most = 5, .is_specified = specified.has("creep")}};
    }

private:
    /// Times at which something of a load's duration shows, ascending; fewer than two: nothing does.
    static std::vector<double> informative_times(const Problem& problem) {
        std::vector<double> times;
        for (const Stage& stage : problem.stages) {
            const bool same_probe_loaded = std::ranges::any_of(problem.stages, [&](const Stage& other) {
                return other.probe == stage.probe && !other.action.contacts.empty();
            });
            if (same_probe_loaded && stage.time > 0) times.push_back(stage.time);
        }
        std::ranges::sort(times);
        times.erase(std::unique(times.begin(), times.end()), times.end());
        return times;
    }
};

}  // namespace

std::shared_ptr<const EffectHypothesis> viscosity_effect() { return std::make_shared<ViscosityEffect>(); }

}  // namespace palpate::identify
