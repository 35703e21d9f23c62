#include "skeleton/effects/link_effects.h"

namespace palpate::skeleton {

namespace {

class InLinks : public fem::ModelSpecificEffect {
public:
    explicit InLinks(const LinkEffects& effects) : effects_(effects) {}
    bool is_nothing() const override { return effects_.torsion == 0 && effects_.shear == 0; }
    const LinkEffects& effects() const { return effects_; }

private:
    LinkEffects effects_;
};

fem::Effects torsion(const fem::EffectNumbers& numbers) {
    return {.of_model = {in_links({.torsion = numbers["torsion"]})}};
}

fem::Effects shear(const fem::EffectNumbers& numbers) { return {.of_model = {in_links({.shear = numbers["shear"]})}}; }

}  // namespace

std::shared_ptr<const fem::ModelSpecificEffect> in_links(const LinkEffects& effects) {
    return std::make_shared<InLinks>(effects);
}

LinkEffects link_effects(const fem::Effects& effects) {
    LinkEffects sum;
    for (const auto& effect : effects.of_model) {
        const auto* own = dynamic_cast<const InLinks*>(effect.get());
        if (!own) continue;
        sum.torsion += own->effects().torsion;
        sum.shear += own->effects().shear;
    }
    return sum;
}

std::vector<fem::KnownEffect> known_link_effects() {
    return {
        {"torsion", {{"torsion", "1", fem::Range::not_negative}}, torsion},
        {"shear", {{"shear", "1", fem::Range::not_negative}}, shear},
    };
}

}  // namespace palpate::skeleton
