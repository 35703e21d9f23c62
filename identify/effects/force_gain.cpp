#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "identify/effects/catalogue.h"

namespace palpate::identify {
namespace {

/// The force sensor reads too much or too little, differently from probe to probe. What all probes share is exactly
/// another stiffness, and is left to it.
class ForceGainEffect : public Effect {
public:
    const EffectDescription& description() const override {
        static const EffectDescription text{
            .name = "force-gain",
            .kind = EffectKind::measurement,
            .meaning = "The true force of a probe is its reported one times a gain of its own.",
            .parameters = {"probe<N> [-]: true over reported force of that probe"},
            .reveals = "whole probes that are off in proportion to their load, in no order of place or direction",
            .confused_with = {"stiffening", "anisotropy"},
            .separating_probe = "repeat a probe, with the sensor taken off and put back",
            .next_probe = "repeat"};
        return text;
    }

    std::vector<EffectNumber> numbers(const BodyModel&, const Problem& problem) const override {
        std::vector<EffectNumber> result;
        for (const int probe : probes(problem)) {
            result.push_back({.name = fmt::format("probe{}", probe), .unit = "1", .prior_sd = 0.3, .logarithm = true});
        }
        // a single gain is a common one
        return result.size() > 1 ? result : std::vector<EffectNumber>{};
    }

    Action act(const Problem& problem, int k, Action action, const Eigen::VectorXd& values) const override {
        if (!problem.loaded(k)) return action;
        for (mesh::Contact& contact : action.contacts) contact.force *= std::exp(values[place_of(problem, k)]);
        return action;
    }

    Eigen::MatrixXd force(const BodyModel& model, const Problem& problem, const Setting& setting, int k,
                          const Eigen::VectorXd& q, const Eigen::VectorXd& values) const override {
        Eigen::MatrixXd G = Eigen::MatrixXd::Zero(model.dofs(), values.size());
        if (!problem.loaded(k)) return G;
        for (const mesh::Contact& contact : act(problem, k, problem.actions[k], values).contacts) {
            G.col(place_of(problem, k)) += model.contact_force(q, setting, contact);
        }
        return G;
    }

    std::string sentence(const skeleton::Effect& told) const override {
        const auto [least, most] = std::ranges::minmax_element(told.parameters, {}, &skeleton::EffectParameter::value);
        return fmt::format(
            "The force sensor's gain differs between probes: the true force is {:.2f} ({}) to {:.2f} ({}) times the "
            "reported one.",
            least->value, least->name, most->value, most->name);
    }

    MeasurementSet corrected(const MeasurementSet& set, const skeleton::Effect& told) const override {
        MeasurementSet result = set;
        for (LoadState& state : result.states) {
            const auto gain = std::ranges::find(told.parameters, fmt::format("probe{}", state.probe),
                                                &skeleton::EffectParameter::name);
            if (gain == told.parameters.end()) continue;
            for (mesh::Contact& contact : state.contacts) contact.force *= gain->value;
        }
        return result;
    }

private:
    static std::vector<int> probes(const Problem& problem) {
        std::set<int> found;
        for (std::size_t k = 0; k < problem.actions.size(); ++k) {
            if (problem.loaded(static_cast<int>(k))) found.insert(problem.probe[k]);
        }
        return {found.begin(), found.end()};
    }

    static Eigen::Index place_of(const Problem& problem, int k) {
        const std::vector<int> all = probes(problem);
        return std::ranges::find(all, problem.probe[k]) - all.begin();
    }
};

}  // namespace

std::shared_ptr<const Effect> force_gain_effect() { return std::make_shared<ForceGainEffect>(); }

}  // namespace palpate::identify
