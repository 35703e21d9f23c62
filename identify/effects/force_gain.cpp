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

    /// A number for every probe explains whatever differs from probe to probe. So it has to be needed, and sensors do
    /// not know how hard the body is pressed: gains that fall as the load grows are a body that stiffens.
    std::string objection(const Problem& problem, const Eigen::VectorXd& values, bool enough_without) const override {
        if (enough_without) return "what is left without gains is noise already";
        const auto [slope, explained] = line_over_load(problem, values);
        constexpr double most_explained = 0.6;  // of the gains' variance; by chance once in some 600 sets of 12 probes
        if (slope < 0 && explained > most_explained) return "the gains fall as the load grows: a body that stiffens";
        return {};
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

    struct Line {
        double slope = 0;
        double explained = 0;  // share of the variance
    };
    /// ln gain over the logarithm of a probe's largest force.
    static Line line_over_load(const Problem& problem, const Eigen::VectorXd& values) {
        Eigen::VectorXd load = Eigen::VectorXd::Zero(values.size());
        for (std::size_t k = 0; k < problem.actions.size(); ++k) {
            if (!problem.loaded(static_cast<int>(k))) continue;
            double& most = load[place_of(problem, static_cast<int>(k))];
            for (const mesh::Contact& c : problem.actions[k].contacts) most = std::max(most, c.force.norm());
        }
        const Eigen::ArrayXd x = load.array().log() - load.array().log().mean();
        const Eigen::ArrayXd y = values.array() - values.mean();
        const double xx = x.square().sum(), yy = y.square().sum(), xy = (x * y).sum();
        if (!(xx > 0 && yy > 0)) return {};
        return {xy / xx, xy * xy / (xx * yy)};
    }

    static Eigen::Index place_of(const Problem& problem, int k) {
        const std::vector<int> all = probes(problem);
        return std::ranges::find(all, problem.probe[k]) - all.begin();
    }
};

}  // namespace

std::shared_ptr<const Effect> force_gain_effect() { return std::make_shared<ForceGainEffect>(); }

}  // namespace palpate::identify
