#include "fem/effects/material/prestress.h"

#include <fmt/format.h>

#include "identify/effects/effect.h"
#include "identify/effects/vector_words.h"

namespace palpate::identify {
namespace {

/// A uniform stress in the body that was measured as its rest shape, whatever brought it about.
class PrestressEffect : public EffectHypothesis {
public:
    const EffectDescription& description() const override {
        static const EffectDescription text{
            .name = "prestress",
            .kind = EffectKind::body,
            .meaning =
                "The rest shape is not free of stress: the material pulls or pushes along its axes, all of it alike.",
            .parameters = {"sxx, syy, szz, sxy, syz, sxz [-]: stress at rest over the shear modulus"},
            .reveals = "an error without any load that is largest where the body is free to change its size",
            .confused_with = {"swelling", "gravity", "misalignment", "pressure"},
            .separating_probe = "read the unloaded pose with the body turned: prestress turns with it, weight does not",
            .next_probe = "orientation"};
        return text;
    }

    std::vector<EffectNumber> numbers(const BodyModel&, const Problem&) const override {
        std::vector<EffectNumber> result;
        for (const char* name : {"sxx", "syy", "szz", "sxy", "syz", "sxz"}) {
            result.push_back({.name = name, .unit = "1", .prior_sd = 0.06});  // strains of .03
        }
        return result;
    }

    bool enforce(const Eigen::VectorXd& values, ModelSetting& setting) const override {
        Mat3 S;
        S << values[0], values[3], values[5], values[3], values[1], values[4], values[5], values[4], values[2];
        setting.effects.material.push_back(std::make_shared<fem::Prestress>(S));
        return true;
    }

    std::string sentence(const skeleton::EffectRecord& record) const override { return sentence_with(record, {}); }

    std::string sentence_with(const skeleton::EffectRecord& record, const Eigen::MatrixXd& covariance) const override {
        const auto largest = std::ranges::max_element(
            record.parameters, {}, [](const skeleton::EffectParameter& s) { return std::abs(s.value); });
        const auto number = static_cast<std::size_t>(largest - record.parameters.begin());
        return fmt::format(
            "The body is prestressed: its largest component of stress is {} = {} times the shear modulus.",
            largest->name, number_in_words(record, number, covariance));
    }

    std::optional<std::uint64_t> stream() const override { return 3; }

    std::vector<EffectSampler> samplers(SamplingContext& context, const SpecifiedNumbers& specified) const override {
        const Vec3 normal = context.random.normals(3).normalized(), shear = context.random.normals(3).normalized();
        const std::vector<std::string> names{"sxx", "syy", "szz", "sxy", "syz", "sxz"};
        const bool is_specified = specified.has_any(names);
        const auto at = [=](double x) {
            const double s = is_specified ? 0 : x;
            std::vector<std::pair<std::string, double>> values;
            values.reserve(names.size());
            for (int i = 0; i < 3; ++i) values.emplace_back(names[i], s * normal[i]);
            for (int i = 0; i < 3; ++i) values.emplace_back(names[i + 3], 0.5 * s * shear[i]);
            return specified.effect(values);
        };
        return {{.at = at, .start = 0.05, .most = 1, .is_specified = is_specified, .acts_at_rest = true}};
    }
};

}  // namespace

std::shared_ptr<const EffectHypothesis> prestress_effect() { return std::make_shared<PrestressEffect>(); }

}  // namespace palpate::identify
