#include "fem/effects/material/stiffening.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identify/diagnosis/search/screen_plan.h"
#include "identify/effects/effect.h"
#include "identify/effects/vector_words.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

/// c2 up to which the fit's number, asinh(c2 / usual), is proportional to it; beyond, to its logarithm: tissue that is
/// hardly strained may well be a hundred times as steep as rubber that is.
constexpr double usual = 1.4;
/// c3 / c2, about. Exponential laws, W = mu/2b (exp b(I - 3) - 1), have c3 = 4/3 c2^2: 4 at c2 = 3, 40 at 30.
constexpr double usual_ratio = 10;

/// A material that grows stiffer as it is stretched: Yeoh's law, C20 = c2 mu and C30 = c3 mu beside mu/2. The numbers
/// are the coefficients themselves, as the screen sees them.
class Coefficients : public EffectHypothesis {
public:
    const EffectDescription& description() const override {
        static const EffectDescription text{
            .name = "stiffening",
            .kind = EffectKind::body,
            .meaning = "The material grows stiffer the more it is strained (Yeoh: C20 = c2 mu, C30 = c3 mu).",
            .parameters = {"c2, c3 [-]: Yeoh's second and third coefficients over the shear modulus"},
            .reveals = "an error that grows faster than the load, at least with its square",
            .confused_with = {"contact", "force-gain", "volume"},
            .separating_probe = "push and pull at one place, at three levels of load",
            .next_probe = "load"};
        return text;
    }

    std::vector<EffectNumber> numbers(const BodyModel&, const Problem&) const override {
        return {{.name = "c2", .unit = "1", .prior_sd = 3, .least = 0},
                {.name = "c3", .unit = "1", .prior_sd = 30, .least = 0}};
    }

    bool enforce(const Eigen::VectorXd& values, ModelSetting& setting) const override {
        setting.effects.material.push_back(std::make_shared<fem::Stiffening>(values[0], values[1]));
        return true;
    }

    std::string sentence(const skeleton::EffectRecord& record) const override { return sentence_with(record, {}); }

    std::string sentence_with(const skeleton::EffectRecord& record, const Eigen::MatrixXd& covariance) const override {
        return fmt::format("The material stiffens as it is strained: Yeoh coefficients of {} and {} over mu.",
                           number_in_words(record, 0, covariance), number_in_words(record, 1, covariance));
    }
};

/// The same as the fit sees it.
class StiffeningEffect : public Coefficients {
public:
    std::vector<EffectNumber> numbers(const BodyModel&, const Problem&) const override {
        return {{.name = "c2", .unit = "1", .prior_sd = 1.5, .least = 0},
                {.name = "c3",
                 .unit = "1",
                 .start = std::log(usual_ratio),
                 .prior_mean = std::log(usual_ratio),
                 .prior_sd = 1.5}};
    }

    bool enforce(const Eigen::VectorXd& values, ModelSetting& setting) const override {
        const double c2 = usual * std::sinh(values[0]);
        setting.effects.material.push_back(std::make_shared<fem::Stiffening>(c2, c2 * std::exp(values[1])));
        return true;
    }

    skeleton::EffectRecord record(const std::vector<EffectNumber>& numbers,
                                  const Eigen::VectorXd& values) const override {
        skeleton::EffectRecord result = EffectHypothesis::record(numbers, values);
        result.parameters[0].value = usual * std::sinh(values[0]);
        result.parameters[1].value = result.parameters[0].value * std::exp(values[1]);
        return result;
    }

    Eigen::VectorXd values(const std::vector<EffectNumber>& numbers,
                           const skeleton::EffectRecord& record) const override {
        if (record.parameters.empty()) return EffectHypothesis::values(numbers, record);
        const Eigen::VectorXd coefficients = Coefficients::values(numbers, record);
        constexpr double nothing = 1e-9;  // of the other one
        const double c2 = std::max(coefficients[0], nothing * coefficients[1]);
        const double ratio = c2 > 0 ? std::max(coefficients[1] / c2, nothing) : usual_ratio;
        return Eigen::Vector2d(std::asinh(c2 / usual), std::log(ratio));
    }

    // It goes with a softer start, which is far from the fit without it.
    bool evades_screen() const override { return true; }

    // A coarse mesh is off by more where it is strained more.
    bool is_like_mesh_error() const override { return true; }

    std::optional<ScreenedNumber> screened_number() const override { return ScreenedNumber{}; }

    std::optional<ScreenPlan> screen_plan(const BodyModel& model, const Problem& problem,
                                          const Explanation& explanation,
                                          const ForwardSolution& forward) const override {
        // Either coefficient for itself, each over its prior. The linearisation promises more than there is: a refit
        // begins with little.
        static const Coefficients coefficients;
        ScreenPlan plan = screen_plan_by_numbers(coefficients, model, problem, explanation, forward);
        plan.columns = [columns = plan.columns](const Eigen::MatrixXd& sensitivities) {
            const ScreenColumns both = columns(sensitivities);
            return ScreenColumns{both.columns * both.prior_sd.asDiagonal(), Eigen::VectorXd::Ones(1), true};
        };
        plan.start = [](Eigen::Index, const Eigen::VectorXd&) { return Eigen::Vector2d(0.2, std::log(usual_ratio)); };
        return plan;
    }

    std::optional<std::uint64_t> stream() const override { return 7; }

    std::vector<EffectSampler> samplers(SamplingContext& context, const SpecifiedNumbers& specified) const override {
        if (context.in_small_strain()) {
            throw InvalidInput("effect 'stiffening' does not show in small strain; leave --linear out");
        }
        const bool is_specified = specified.has_any({"c2", "c3"});
        const auto at = [=](double x) {
            // Soft tissue and rubber: the third coefficient some ten times the second.
            const double c = is_specified ? 0 : x;
            return specified.effect({{"c2", c}, {"c3", 10 * c}});
        };
        return {{.at = at, .start = 3, .most = 300, .is_specified = is_specified}};
    }
};

}  // namespace

std::shared_ptr<const EffectHypothesis> stiffening_effect() { return std::make_shared<StiffeningEffect>(); }

}  // namespace palpate::identify
