// Something holds the skin around (29.4, -2.0, -2.8) mm, within 9.3 mm, as springs of 0.055 N/mm in all.
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

/// Springs on the skin: the potential of a point, of which each has a share by its area, is e = k/2 |x - X|^2, k in
/// N/mm in all.
class Source : public fem::PointPotential {
public:
    explicit Source(double k) : k_(k) {}
    fem::ActsOn acts_on() const override { return fem::ActsOn::surface; }
    fem::PointTerms terms(const Vec3& X, const Vec3& x) const override {
        const Vec3 u = x - X;
        return {.energy = 0.5 * k_ * u.squaredNorm(), .gradient = k_ * u, .hessian = k_ * Mat3::Identity()};
    }
    Eigen::VectorXd weights(const Points& rest, const Eigen::VectorXd& even) const override {
        return where.shares(rest, even);
    }

private:
    double k_;
};

fem::Effects source(double k) { return {.points = {std::make_shared<Source>(k)}}; }

skeleton::KnownEffect known_physics() {
    return {"ligament",
            {{"stiffness", "N/mm"}},
            [](const skeleton::EffectNumbers& numbers) -> fem::Effects {
                return source(numbers["stiffness"]);
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
        static const identify::EffectDescription text{.name = "ligament",
                                                      .kind = identify::EffectKind::body,
                                                      .meaning = "Something holds the skin in one place.",
                                                      .parameters = {"stiffness [N/mm]: of all springs together"},
                                                      .reveals = "one place moves too little, under whatever probe",
                                                      .confused_with = {"inclusion", "contact"},
                                                      .separating_probe = "push that place to either side, and read how far it moves",
                                                      .next_probe = "load"};
        return text;
    }

    // 0 is neutral, as the screen needs it; the prior is as wide as what was fitted.
    std::vector<identify::EffectNumber> numbers(const identify::BodyModel&, const identify::Problem&) const override {
        std::vector<identify::EffectNumber> result;
        for (const char* name : {"stiffness"})
            result.push_back({.name = name, .unit = "N/mm", .prior_sd = 0.055});
        return result;
    }

    bool enforce(const Eigen::VectorXd& values, identify::ModelSetting& setting) const override {
        setting.effects.add(source(values[0]));
        return true;
    }

    std::string sentence(const skeleton::EffectRecord& record) const override {
        const auto& p = record.parameters;
        return fmt::format("Something holds the skin in one place: {:.3g} N/mm.", p[0].value);
    }
};

const bool known = identify::register_effect(known_physics(), std::make_shared<SourceEffect>());

#endif

}  // namespace
