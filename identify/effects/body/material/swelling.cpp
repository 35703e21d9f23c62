#include <fmt/format.h>

#include <cmath>

#include "identify/effects/effect.h"
#include "identify/effects/vector_words.h"

namespace palpate::identify {
namespace {

/// The material has grown or shrunk evenly since its rest shape was taken, and is held back by its supports alone:
/// silicone that took up solvent, a gel that dried, a part that cooled.
class SwellingEffect : public EffectHypothesis {
public:
    const EffectDescription& description() const override {
        static const EffectDescription text{
            .name = "swelling",
            .kind = EffectKind::body,
            .meaning =
                "The body grew or shrank evenly since its rest shape was taken: it dried, took up a liquid, or "
                "its temperature changed.",
            .parameters = {"growth [-]: of every free length; below 0 the body shrank"},
            .reveals =
                "an error without any load that grows with the distance from the supports, along the body and "
                "out of its surface alike",
            .confused_with = {"prestress", "misalignment", "pressure"},
            .separating_probe =
                "read the unloaded body with markers all round it: what swells grows across as it does "
                "along, what hangs, leans or is stretched does not",
            .next_probe = "fiducials"};
        return text;
    }

    std::vector<EffectNumber> numbers(const BodyModel&, const Problem&) const override {
        // A tenth of the volume, more or less.
        return {{.name = "growth", .unit = "1", .prior_sd = 0.03, .least = least}};
    }

    bool enforce(const Eigen::VectorXd& values, ModelSetting& setting) const override {
        setting.effects.growth.everywhere += values[0];
        return true;
    }

    std::string sentence(const skeleton::EffectRecord& record) const override { return sentence_with(record, {}); }

    std::string sentence_with(const skeleton::EffectRecord& record, const Eigen::MatrixXd& covariance) const override {
        const double growth = record.parameters[0].value;
        return fmt::format("The body has {} by {} % in every free length since its rest shape was taken.",
                           growth < 0 ? "shrunk" : "grown",
                           number_in_words(record, 0, covariance, growth < 0 ? -100 : 100));
    }

    std::optional<std::uint64_t> stream() const override { return 17; }

    std::vector<EffectSampler> samplers(SamplingContext& context, const SpecifiedNumbers& specified) const override {
        const double sign = context.random.uniform() < 0.5 ? -1 : 1;
        const auto at = [=](double x) { return specified.effect({{"growth", sign * x}}); };
        return {{.at = at, .start = 0.02, .most = 0.2, .is_specified = specified.has("growth"), .acts_at_rest = true}};
    }

private:
    static constexpr double least = -0.5;  // keeps trials off -1, where nothing is left of the body
};

}  // namespace

std::shared_ptr<const EffectHypothesis> swelling_effect() { return std::make_shared<SwellingEffect>(); }

}  // namespace palpate::identify
