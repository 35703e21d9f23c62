#include <fmt/format.h>

#include <cmath>

#include "identify/effects/effect.h"
#include "identify/effects/vector_words.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

/// The body keeps its volume more, or less, than the set declares. Without a declared ratio every explanation fits it.
class VolumeEffect : public EffectHypothesis {
public:
    const EffectDescription& description() const override {
        static const EffectDescription text{
            .name = "volume",
            .kind = EffectKind::body,
            .meaning = "Poisson's ratio differs from the one that the set declares.",
            .parameters = {"poisson [-]: Poisson's ratio"},
            .reveals = "sides that bulge more or less than they should under a squeeze",
            .confused_with = {"stiffening", "anisotropy"},
            .separating_probe = "squeeze the body and read the bulge at its sides",
            .next_probe = "load",
            .why_unshown = "the set declares no Poisson's ratio that readings could contradict; the fit finds one"};
        return text;
    }

    // The declared ln(1 - 2 nu), which is as it is, and the true one.
    std::vector<EffectNumber> numbers(const BodyModel& model, const Problem& problem) const override {
        const bool has_ratio = place_in(model) < std::ssize(model.parameters());
        if (std::isnan(problem.declared_poisson) || !has_ratio) return {};
        const double declared = std::log(1 - 2 * problem.declared_poisson);
        return {{.name = "declared", .unit = "1", .start = declared, .prior_mean = declared, .prior_sd = 1e-6},
                {.name = "poisson", .unit = "1", .start = declared, .prior_mean = declared, .prior_sd = 1}};
    }

    bool enforce(const Eigen::VectorXd& values, ModelSetting& setting) const override {
        if (setting.theta.size() > compressibility) setting.theta[compressibility] += values[1] - values[0];
        return true;
    }

    skeleton::EffectRecord record(const std::vector<EffectNumber>&, const Eigen::VectorXd& values) const override {
        return {name(), {{"poisson", 0.5 * (1 - std::exp(values[1])), "1"}}};
    }

    Eigen::VectorXd values(const std::vector<EffectNumber>& numbers,
                           const skeleton::EffectRecord& record) const override {
        Eigen::Vector2d result(numbers[0].start, numbers[1].start);
        if (!record.parameters.empty()) result[1] = std::log(1 - 2 * record.parameters[0].value);
        return result;
    }

    std::string sentence(const skeleton::EffectRecord& record) const override { return sentence_with(record, {}); }

    std::string sentence_with(const skeleton::EffectRecord& record, const Eigen::MatrixXd& covariance) const override {
        return fmt::format("The body keeps its volume otherwise than declared: Poisson's ratio is {}.",
                           number_in_words(record, 0, covariance));
    }

    SynthesisNeeds needs() const override { return {.specified_poisson = true}; }

    void hide(const skeleton::EffectRecord& record, TrueConditions& conditions) const override {
        EffectHypothesis::hide(record, conditions);  // which refuses what is out of range
        conditions.setting.theta[compressibility] =
            std::log(1 - 2 * number_of(record, "poisson"));  // Young's modulus stays
    }

    std::optional<std::uint64_t> stream() const override { return 4; }

    /// Poisson's ratio. What is not quite incompressible changes little when it becomes so, more when it becomes a
    /// sponge.
    std::vector<EffectSampler> samplers(SamplingContext& context, const SpecifiedNumbers& specified) const override {
        if (context.is_skeleton()) {
            throw InvalidInput(
                "effect 'volume' is of a solid: the links of a skeleton have no volume that could resist; "
                "hide another effect, or probe a mesh");
        }
        const double now = 1 - 2 * *context.poisson;
        const bool stiffer = context.random.uniform() < 0.5 || now > 0.3;
        const auto at = [=](double x) {
            const double furthest = stiffer ? 0.002 : 0.6;  // nu = 0.499, 0.2
            const double then = std::pow(now, 1 - x) * std::pow(furthest, x);
            return specified.effect({{"poisson", 0.5 * (1 - then)}});
        };
        return {{.at = at, .start = 0.5, .most = 1, .is_specified = specified.has("poisson")}};
    }

private:
    static constexpr Eigen::Index compressibility = 1;  // place in the reference body's theta
    static std::ptrdiff_t place_in(const BodyModel& model) {
        const auto& all = model.parameters();
        return std::ranges::find(all, "compressibility", &StiffnessParameter::name) - all.begin();
    }
};

}  // namespace

std::shared_ptr<const EffectHypothesis> volume_effect() { return std::make_shared<VolumeEffect>(); }

}  // namespace palpate::identify
