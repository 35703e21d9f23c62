// The material has shrunk by up to 8 % in every free length around (29.4, -2.0, -2.8) mm, within 9.3 mm.
//
// A draft, written by 'palpate improve --residual --draft': where it acts and how strong it is were fitted, what it is
// was not. Say what it is, and change the physics where its cause asks for others. To build palpate with it, in
// the project's folder:
//   cmake --preset release -DPALPATE_OWN_EFFECTS=THIS_FILE && cmake --build --preset release

#include <fmt/format.h>

#include "fem/effects/local/locality.h"
#ifdef PALPATE_PHYSICS_ONLY
#include "skeleton/effects/effect.h"
#else
#include "identify/effects/catalogue.h"
#endif

namespace {

using namespace palpate;

const fem::Locality where{{29.381, -1.9754, -2.828}, 9.28};  // its middle and 1 sd of its weight [mm]

// --- The physics -----------------------------------------------------------------------------------------------------

/// The material is larger in every free length than it was at rest, by `growth` in the middle.
fem::Effects source(double growth) { return {.growth = {.parts = {{where, growth}}}}; }

skeleton::KnownEffect known_physics() {
    return {"dry-spot",
            {{"growth", "1", fem::Range::above_minus_one}},
            [](const skeleton::EffectNumbers& numbers) -> fem::Effects {
                return source(numbers["growth"]);
            }};
}

#ifdef PALPATE_PHYSICS_ONLY

// libpalpate_runtime.so plays effects and diagnoses nothing: it compiles the physics alone.
const bool known = skeleton::register_effect(known_physics());

#else

// --- How a diagnosis sees it -----------------------------------------------------------------------------------------

class SourceEffect : public identify::EffectHypothesis {
public:
    const identify::EffectDescription& description() const override {
        static const identify::EffectDescription text{.name = "dry-spot",
                                                      .kind = identify::EffectKind::body,
                                                      .meaning = "The material has grown in one place since the rest shape was taken.",
                                                      .parameters = {"growth [-]: of every free length in the middle of that place"},
                                                      .reveals = "an error that is there without any load, away from one place or towards it",
                                                      .confused_with = {"swelling", "prestress"},
                                                      .separating_probe = "read the unloaded body, with markers all round that place",
                                                      .next_probe = "fiducials"};
        return text;
    }

    // 0 is neutral, as the screen needs it; the prior is as wide as what was fitted.
    std::vector<identify::EffectNumber> numbers(const identify::BodyModel&, const identify::Problem&) const override {
        std::vector<identify::EffectNumber> result;
        for (const char* name : {"growth"})
            result.push_back({.name = name, .unit = "1", .prior_sd = 0.08});
        return result;
    }

    bool enforce(const Eigen::VectorXd& values, identify::ModelSetting& setting) const override {
        setting.effects.add(source(values[0]));
        return true;
    }

    std::string sentence(const skeleton::EffectRecord& record) const override {
        const auto& p = record.parameters;
        return fmt::format("The material has grown by {:.2g} % in one place.", 100 * p[0].value);
    }
};

const bool known = identify::register_effect(known_physics(), std::make_shared<SourceEffect>());

#endif

}  // namespace
