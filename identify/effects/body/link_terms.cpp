#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identify/effects/effect.h"
#include "identify/effects/vector_words.h"
#include "mesh/errors.h"
#include "skeleton/effects/link_effects.h"

namespace palpate::identify {
namespace {

/// Is the model made of links? A solid has none to twist or shear.
bool has_links(const BodyModel& model) {
    return std::ranges::find(model.parameters(), "flexion", &StiffnessParameter::name) != model.parameters().end();
}

/// A resistance of the links. Its one number bears the name of the effect.
class OfLinks : public EffectHypothesis {
public:
    bool is_of_links() const override { return true; }

    std::vector<EffectNumber> numbers(const BodyModel& model, const Problem&) const override {
        if (!has_links(model)) return {};
        return {{.name = name(), .unit = "1", .least = 0}};
    }

    std::vector<EffectSampler> samplers(SamplingContext& context, const SpecifiedNumbers& specified) const override {
        if (!context.is_skeleton()) {
            throw InvalidInput(
                fmt::format("effect '{}' is of a skeleton's links, and a solid has none; probe a "
                            "model.json, or hide another effect",
                            name()));
        }
        const auto at = [name = name(), specified](double x) { return specified.effect({{name, x}}); };
        return {{.at = at, .most = 100, .is_specified = specified.has(name())}};
    }
};

/// Resistance of the links to twist, which a model of elongation and flexion alone lacks.
class TorsionEffect : public OfLinks {
public:
    const EffectDescription& description() const override {
        static const EffectDescription text{
            .name = "torsion",
            .kind = EffectKind::body,
            .meaning = "The links of the skeleton resist twist more than the model has it.",
            .parameters = {"torsion [-]: resistance to twist over that to flexion, added to each link"},
            .reveals = "limbs that turn about their axis too readily under a couple",
            .confused_with = {"shear"},
            .separating_probe = "apply a couple about the axis of a limb",
            .next_probe = "load"};
        return text;
    }

    std::optional<std::uint64_t> stream() const override { return 5; }

    bool enforce(const Eigen::VectorXd& values, ModelSetting& setting) const override {
        setting.effects.of_model.push_back(skeleton::in_links({.torsion = values[0]}));
        return true;
    }

    std::string sentence(const skeleton::EffectRecord& record) const override { return sentence_with(record, {}); }

    std::string sentence_with(const skeleton::EffectRecord& record, const Eigen::MatrixXd& covariance) const override {
        return fmt::format("The links resist twist: by {} times their flexion more than the model has it.",
                           number_in_words(record, 0, covariance));
    }
};

/// Resistance of the links to shear apart from flexion.
class ShearEffect : public OfLinks {
public:
    const EffectDescription& description() const override {
        static const EffectDescription text{
            .name = "shear",
            .kind = EffectKind::body,
            .meaning = "The links of the skeleton resist a sideways offset of their ends more than bending tells.",
            .parameters = {"shear [-]: resistance to shear over that to elongation, added to each link"},
            .reveals = "short spans that give way sideways too readily, while long ones bend as they should",
            .confused_with = {"torsion"},
            .separating_probe = "bend two spans of different length",
            .next_probe = "load"};
        return text;
    }

    std::optional<std::uint64_t> stream() const override { return 6; }

    bool enforce(const Eigen::VectorXd& values, ModelSetting& setting) const override {
        setting.effects.of_model.push_back(skeleton::in_links({.shear = values[0]}));
        return true;
    }

    std::string sentence(const skeleton::EffectRecord& record) const override { return sentence_with(record, {}); }

    std::string sentence_with(const skeleton::EffectRecord& record, const Eigen::MatrixXd& covariance) const override {
        return fmt::format("The links resist shear: by {} times their elongation more than the model has it.",
                           number_in_words(record, 0, covariance));
    }
};

}  // namespace

std::shared_ptr<const EffectHypothesis> torsion_effect() { return std::make_shared<TorsionEffect>(); }
std::shared_ptr<const EffectHypothesis> shear_effect() { return std::make_shared<ShearEffect>(); }

}  // namespace palpate::identify
