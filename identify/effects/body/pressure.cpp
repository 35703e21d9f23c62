#include <fmt/format.h>

#include <cmath>

#include "identify/effects/effect.h"
#include "identify/effects/vector_words.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

/// Pressure in the closed cavities of the body.
class PressureEffect : public EffectHypothesis {
public:
    const EffectDescription& description() const override {
        static const EffectDescription text{
            .name = "pressure",
            .kind = EffectKind::body,
            .meaning = "The closed cavities of the body are under pressure, in every state.",
            .parameters = {"pressure [MPa]: in the cavities, above that outside"},
            .reveals = "walls round a cavity that bulge without any load",
            .confused_with = {"prestress", "gravity"},
            .separating_probe = "change the pressure, and read the unloaded pose again",
            .next_probe = "pressure",
            .why_unshown = "the body has no closed cavity"};
        return text;
    }

    std::vector<EffectNumber> numbers(const BodyModel& model, const Problem&) const override {
        if (!model.has_cavities()) return {};
        Eigen::VectorXd theta(std::ssize(model.parameters()));
        for (Eigen::Index p = 0; p < theta.size(); ++p) theta[p] = model.parameters()[p].start;
        constexpr double strong = 0.1;  // of Young's modulus: walls give way to more
        return {{.name = "pressure",
                 .unit = "MPa",
                 .prior_sd = strong * model.young({.law = 0, .theta = theta, .effects = {}})}};
    }

    bool enforce(const Eigen::VectorXd& values, ModelSetting& setting) const override {
        setting.effects.pressure += values[0];
        return true;
    }

    Eigen::VectorXd under(const ProbeConditions& conditions, const Eigen::VectorXd& values) const override {
        return conditions.vented ? Eigen::VectorXd(0 * values) : values;
    }

    std::string sentence(const skeleton::EffectRecord& record) const override { return sentence_with(record, {}); }

    std::string sentence_with(const skeleton::EffectRecord& record, const Eigen::MatrixXd& covariance) const override {
        return fmt::format("The cavities are under a pressure of {} kPa.",
                           number_in_words(record, 0, covariance, 1000));
    }

    std::optional<std::uint64_t> stream() const override { return 2; }

    std::vector<EffectSampler> samplers(SamplingContext& context, const SpecifiedNumbers& specified) const override {
        if (!context.model.has_cavities()) {
            throw InvalidInput(
                "effect 'pressure' acts in closed cavities, and this body has none; give a surface with a "
                "closed shell inside, or hide another effect");
        }
        const double unit = 0.02 * context.stiffness;
        const double sign = context.random.uniform() < 0.3 ? -1 : 1;  // mostly it is pumped up
        const auto at = [=](double x) { return specified.effect({{"pressure", x * sign * unit}}); };
        return {{.at = at, .is_specified = specified.has("pressure"), .acts_at_rest = true}};
    }
};

}  // namespace

std::shared_ptr<const EffectHypothesis> pressure_effect() { return std::make_shared<PressureEffect>(); }

}  // namespace palpate::identify
