#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "identify/effects/effect.h"
#include "identify/effects/measurement/gains.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

/// The force sensor reads too much or too little, differently from probe to probe. What all probes share is exactly
/// another stiffness, and is left to it. Loads along one line at one place, each of its own size, are a curve of the
/// body's whatever their numbers as probes: they share a gain unless a load is repeated.
class ForceGainEffect : public EffectHypothesis {
public:
    const EffectDescription& description() const override {
        static const EffectDescription text{
            .name = "force-gain",
            .kind = EffectKind::measurement,
            .meaning =
                "The true force of a probe is a multiple of the reported one; loads of different size along one line "
                "at "
                "one place share it.",
            .parameters = {"probe<N> [-]: true over reported force of that probe"},
            .reveals = "whole probes that are off in proportion to their load, in no order of place or direction",
            .confused_with = {"stiffening", "anisotropy"},
            .separating_probe = "repeat a probe, with the sensor taken off and put back",
            .next_probe = "repeat",
            .why_unshown = "fewer than two probes have forces of their own, and one gain is a stiffness"};
        return text;
    }

    std::vector<EffectNumber> numbers(const BodyModel&, const Problem& problem) const override {
        std::vector<EffectNumber> result;
        const std::map<int, int> gains = gain_of_probes(problem);
        for (const auto& [probe, gain] : gains) {
            if (probe != gain) continue;
            result.push_back({.name = fmt::format("probe{}", probe), .unit = "1", .prior_sd = 0.3, .logarithm = true});
        }
        // a single gain is a common one
        return result.size() > 1 ? result : std::vector<EffectNumber>{};
    }

    Action act(const Problem& problem, int k, Action action, const Eigen::VectorXd& values) const override {
        if (action.contacts.empty()) return action;
        for (mesh::Contact& contact : action.contacts) contact.force *= std::exp(values[place_of(problem, k)]);
        return action;
    }

    bool is_like_mesh_error() const override { return true; }

    /// Sensors do not know how hard the body is pressed: gains that fall as the load grows are a body that stiffens.
    std::string objection(const Problem& problem, const Eigen::VectorXd& values) const override {
        const auto [slope, explained] = line_over_load(problem, values);
        constexpr double most_explained = 0.6;  // of the gains' variance; by chance once in some 600 sets of 12 probes
        if (slope < 0 && explained > most_explained) return "the gains fall as the load grows: a body that stiffens";
        return {};
    }

    std::string sentence(const skeleton::EffectRecord& record) const override { return sentence_with(record, {}); }

    std::string sentence_with(const skeleton::EffectRecord& record, const Eigen::MatrixXd& covariance) const override {
        const auto [least, most] = gain_range(record, covariance);
        return fmt::format(
            "The force sensor's gain differs between probes: the true force is {} ({}) to {} ({}) times the reported "
            "one.",
            least.in_words, least.name, most.in_words, most.name);
    }

    MeasurementSet corrected(const MeasurementSet& set, const skeleton::EffectRecord& record) const override {
        MeasurementSet result = set;
        const std::map<int, int> gains = gain_of_probes(make_problem(set, 1));
        for (LoadState& state : result.states) {
            const auto own = gains.find(state.probe);
            if (own == gains.end()) continue;
            // told of any of the probes that share it
            const auto gain = std::ranges::find_if(record.parameters, [&](const skeleton::EffectParameter& parameter) {
                return std::ranges::any_of(gains, [&](const auto& other) {
                    return other.second == own->second && parameter.name == fmt::format("probe{}", other.first);
                });
            });
            if (gain == record.parameters.end()) continue;
            for (mesh::Contact& contact : state.contacts) contact.force *= gain->value;
        }
        return result;
    }

    void hide(const skeleton::EffectRecord& record, TrueConditions& conditions) const override {
        conditions.gain = number_of(record, "gain");
    }

    std::vector<skeleton::KnownParameter> numbers_to_hide() const override { return {{"gain", "1"}}; }
    std::string why_not_driven(int) const override { return "no force is applied; press with forces"; }
    std::optional<std::uint64_t> stream() const override { return 14; }

    std::vector<EffectSampler> samplers(SamplingContext& context, const SpecifiedNumbers& specified) const override {
        if (context.baseline.size() < 3) {
            throw InvalidInput("effect 'force-gain' is of every second probe: ask for two probes at least");
        }
        return gain_samplers(context, specified);
    }

private:
    using Loads = std::vector<int>;  // of a probe, as actions

    /// The first probe of those that share a gain, of each.
    static std::map<int, int> gain_of_probes(const Problem& problem) {
        std::map<int, Loads> loads;
        for (int k = 0; k < static_cast<int>(problem.actions.size()); ++k) {
            if (!problem.actions[k].contacts.empty()) loads[problem.probe[k]].push_back(k);
        }
        std::map<int, int> gains;
        for (const auto& entry : loads) {
            const int probe = entry.first;
            const Loads& own = entry.second;
            const auto first = std::ranges::find_if(gains, [&](const auto& other) {
                return other.first == other.second &&
                       are_a_curve(problem.actions[loads.at(other.first).front()], problem.actions[own.front()]);
            });
            const bool is_repeated =
                first != gains.end() && std::ranges::any_of(gains, [&](const auto& other) {
                    return other.second == first->first && share_a_load(problem, loads.at(other.first), own);
                });
            gains[probe] = first == gains.end() || is_repeated ? probe : first->first;
        }
        return gains;
    }

    /// Forces at the same places along the same lines?
    static bool are_a_curve(const Action& a, const Action& b) {
        constexpr double parallel = 0.999;  // cosine: within 2.6 degrees
        return std::ranges::equal(a.contacts, b.contacts, [](const mesh::Contact& one, const mesh::Contact& other) {
            return (one.point - other.point).norm() <= 1e-3 * one.radius + 1e-6 &&
                   std::abs(one.force.dot(other.force)) >= parallel * one.force.norm() * other.force.norm();
        });
    }

    /// Is there a load in both, of the same size?
    static bool share_a_load(const Problem& problem, const Loads& a, const Loads& b) {
        constexpr double alike = 0.02;  // of the force: what a hand or a robot repeats to
        const auto is_same = [](const mesh::Contact& one, const mesh::Contact& other) {
            return (one.force - other.force).norm() <= alike * one.force.norm();
        };
        return std::ranges::any_of(a, [&](int k) {
            return std::ranges::any_of(b, [&](int l) {
                return std::ranges::equal(problem.actions[k].contacts, problem.actions[l].contacts, is_same);
            });
        });
    }

    struct Line {
        double slope = 0;
        double explained = 0;  // share of the variance
    };
    /// ln gain over the logarithm of a probe's largest force.
    static Line line_over_load(const Problem& problem, const Eigen::VectorXd& values) {
        Eigen::VectorXd load = Eigen::VectorXd::Zero(values.size());
        for (std::size_t k = 0; k < problem.actions.size(); ++k) {
            if (problem.actions[k].contacts.empty()) continue;
            double& most = load[place_of(problem, static_cast<int>(k))];
            for (const mesh::Contact& c : problem.actions[k].contacts) most = std::max(most, c.force.norm());
        }
        const Eigen::ArrayXd x = load.array().log() - load.array().log().mean();
        const Eigen::ArrayXd y = values.array() - values.mean();
        const double xx = x.square().sum(), yy = y.square().sum(), xy = (x * y).sum();
        if (!(xx > 0 && yy > 0)) return {};
        return {xy / xx, xy * xy / (xx * yy)};
    }

    /// Among the numbers, of an action's gain.
    static Eigen::Index place_of(const Problem& problem, int k) {
        const std::map<int, int> gains = gain_of_probes(problem);
        const int own = gains.at(problem.probe[k]);
        return std::ranges::count_if(gains,
                                     [&](const auto& each) { return each.first == each.second && each.first < own; });
    }
};

}  // namespace

std::shared_ptr<const EffectHypothesis> force_gain_effect() { return std::make_shared<ForceGainEffect>(); }

}  // namespace palpate::identify
