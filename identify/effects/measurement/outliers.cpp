#include <fmt/format.h>

#include "identify/effects/effect.h"

namespace palpate::identify {
namespace {

/// Some readings are wrong by far more than the noise, each for itself. It has no force signature and no number of the
/// fit: diagnosis/statistics/outliers weighs it.
class OutliersEffect : public EffectHypothesis {
public:
    const EffectDescription& description() const override {
        static const EffectDescription text{
            .name = "outliers",
            .kind = EffectKind::measurement,
            .meaning = "Some readings are off by far more than the noise, one by one: lost or swapped markers.",
            .parameters = {"share [-]: of the readings", "readings [-]: their number",
                           "width [-]: how far they are off, over the noise"},
            .reveals = "large errors at single readings whose neighbours are right",
            .confused_with = {"inclusion"},
            .separating_probe = "repeat the probes in which they stand",
            .next_probe = "repeat"};
        return text;
    }

    bool is_like_mesh_error() const override { return true; }
    bool sets_readings_aside() const override { return true; }

    std::vector<EffectNumber> numbers(const BodyModel&, const Problem&) const override { return {}; }

    std::string sentence(const skeleton::EffectRecord& record) const override {
        return fmt::format("Outliers: {:.1f} % of the readings ({:.0f}) are off by some {:.0f} times the noise.",
                           100 * record.parameters[0].value, record.parameters[1].value, record.parameters[2].value);
    }

    bool is_of_readings() const override { return true; }
    SynthesisNeeds needs() const override { return {.noise = true}; }

    void hide(const skeleton::EffectRecord& record, TrueConditions& conditions) const override {
        conditions.outlier_share = number_of(record, "share");
        conditions.outlier_width = number_of(record, "width");
    }

    std::vector<skeleton::KnownParameter> numbers_to_hide() const override { return {{"share", "1"}, {"width", "1"}}; }
    std::optional<std::uint64_t> stream() const override { return 15; }

    std::vector<EffectSampler> samplers(SamplingContext&, const SpecifiedNumbers& specified) const override {
        const double share = specified.positive_value("share", 0.06, 0.5);
        specified.positive_value("width", 1, 1e6);
        const auto at = [=](double x) { return specified.effect({{"share", share}, {"width", x}}); };
        return {{.at = at, .start = 25, .is_specified = specified.has("width")}};
    }
};

}  // namespace

std::shared_ptr<const EffectHypothesis> outliers_effect() { return std::make_shared<OutliersEffect>(); }

}  // namespace palpate::identify
