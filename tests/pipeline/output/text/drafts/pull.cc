// A force of 0.05 N towards (-0.60, 0.00, 0.80) acts within the body, around (29.4, -2.0, -2.8) mm, within 9.3 mm.
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

/// A constant force on the material: the potential of a point, of which each has a share by its mass, is
/// e = -F . (x - X), F in N in all.
class Source : public fem::PointPotential {
public:
    explicit Source(const Vec3& force) : force_(force) {}
    fem::ActsOn acts_on() const override { return fem::ActsOn::material; }
    fem::PointTerms terms(const Vec3& X, const Vec3& x) const override {
        return {.energy = -force_.dot(x - X), .gradient = -force_, .hessian = Mat3::Zero()};
    }
    Eigen::VectorXd weights(const Points& rest, const Eigen::VectorXd& even) const override {
        return where.shares(rest, even);
    }

private:
    Vec3 force_;
};

fem::Effects source(const Vec3& force) { return {.points = {std::make_shared<Source>(force)}}; }

skeleton::KnownEffect known_physics() {
    return {"pull",
            {{"fx", "N"}, {"fy", "N"}, {"fz", "N"}},
            [](const skeleton::EffectNumbers& numbers) -> fem::Effects {
                return source(numbers.vector("fx", "fy", "fz"));
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
        static const identify::EffectDescription text{.name = "pull",
                                                      .kind = identify::EffectKind::body,
                                                      .meaning = "A constant force acts in one place.",
                                                      .parameters = {"fx, fy, fz [N]: the force in all"},
                                                      .reveals = "an error that is there without any load, about one place",
                                                      .confused_with = {"gravity", "prestress"},
                                                      .separating_probe = "read the unloaded body, with markers close to that place",
                                                      .next_probe = "orientation"};
        return text;
    }

    // 0 is neutral, as the screen needs it; the prior is as wide as what was fitted.
    std::vector<identify::EffectNumber> numbers(const identify::BodyModel&, const identify::Problem&) const override {
        std::vector<identify::EffectNumber> result;
        for (const char* name : {"fx", "fy", "fz"})
            result.push_back({.name = name, .unit = "N", .prior_sd = 0.05});
        return result;
    }

    bool enforce(const Eigen::VectorXd& values, identify::ModelSetting& setting) const override {
        setting.effects.add(source(values.head<3>()));
        return true;
    }

    std::string sentence(const skeleton::EffectRecord& record) const override {
        const auto& p = record.parameters;
        return fmt::format("A force of ({:.3g}, {:.3g}, {:.3g}) N acts in one place.", p[0].value, p[1].value, 
                           p[2].value);
    }
};

const bool known = identify::register_effect(known_physics(), std::make_shared<SourceEffect>());

#endif

}  // namespace
