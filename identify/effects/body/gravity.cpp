#include "fem/effects/point/gravity.h"

#include <fmt/format.h>

#include <cmath>

#include "identify/effects/effect.h"
#include "identify/effects/vector_words.h"

namespace palpate::identify {
namespace {

constexpr double g0 = 9810;  // [mm/s^2]; the fit's numbers are multiples of it

/// The weight of the body. Direction and size are both free: a rig may be tilted, a phantom afloat. It is there in
/// every state, loaded or not.
class GravityEffect : public EffectHypothesis {
public:
    const EffectDescription& description() const override {
        static const EffectDescription text{
            .name = "gravity",
            .kind = EffectKind::body,
            .meaning = "The body's own weight acts in every state, and the rest shape is the one without it.",
            .parameters = {"gx, gy, gz [mm/s^2]: acceleration; 9810 is the earth's"},
            .reveals = "an error that is there without any load, largest far from the supports",
            .confused_with = {"prestress", "misalignment", "pressure"},
            .separating_probe = "read the unloaded pose with the body turned into two or three orientations",
            .next_probe = "orientation"};
        return text;
    }

    std::vector<EffectNumber> numbers(const BodyModel&, const Problem&) const override {
        std::vector<EffectNumber> result;
        // 1 g in any direction: a third of its square falls to each component.
        const double prior_sd = 1 / std::sqrt(3.0);
        for (const char* axis : {"gx", "gy", "gz"}) {
            result.push_back({.name = axis, .unit = "mm/s^2", .prior_sd = prior_sd});
        }
        return result;
    }

    /// The earth's: from 9764 on mountains at the equator to 9834 at the pole. [Hirt et al. 2013]
    std::optional<MagnitudePrior> magnitude() const override { return MagnitudePrior{9800 / g0, 20 / g0}; }

    bool enforce(const Eigen::VectorXd& values, ModelSetting& setting) const override {
        setting.effects.points.push_back(std::make_shared<fem::Gravity>(g0 * values.head<3>()));
        return true;
    }

    Eigen::VectorXd under(const ProbeConditions& conditions, const Eigen::VectorXd& values) const override {
        return conditions.turn * values;
    }

    skeleton::EffectRecord record(const std::vector<EffectNumber>& numbers,
                                  const Eigen::VectorXd& values) const override {
        return EffectHypothesis::record(numbers, g0 * values);
    }

    Eigen::VectorXd values(const std::vector<EffectNumber>& numbers,
                           const skeleton::EffectRecord& record) const override {
        return EffectHypothesis::values(numbers, record) / g0;
    }

    std::string sentence(const skeleton::EffectRecord& record) const override {
        return sentence_with(record, Mat3::Zero());
    }

    std::string sentence_with(const skeleton::EffectRecord& record, const Eigen::MatrixXd& covariance) const override {
        const Vec3 g(record.parameters[0].value, record.parameters[1].value, record.parameters[2].value);
        constexpr double metre = 1000;  // [mm]
        return fmt::format("Gravity is missing: {}.", vector_in_words(g, covariance, metre, "m/s²"));
    }

    std::optional<std::uint64_t> stream() const override { return 0; }

    std::vector<EffectSampler> samplers(SamplingContext& context, const SpecifiedNumbers& specified) const override {
        const Vec3 direction = random_direction(context.random);
        const auto at = [=](double x) {
            const Vec3 g = specified.vector({"gx", "gy", "gz"}, x * direction);
            return specified.effect({{"gx", g.x()}, {"gy", g.y()}, {"gz", g.z()}});
        };
        return {{.at = at, .start = 9810, .is_specified = specified.has_any({"gx", "gy", "gz"}), .acts_at_rest = true}};
    }
};

}  // namespace

std::shared_ptr<const EffectHypothesis> gravity_effect() { return std::make_shared<GravityEffect>(); }

}  // namespace palpate::identify
