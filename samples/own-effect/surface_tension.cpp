// An effect of area of one's own, in one file.
//
// What it shows: a wet body, or one in a taut membrane, whose skin pulls itself together with an energy of gamma per
// area as it stands. The catalogue does not know such a thing. This file tells its physics, how a diagnosis sees it and
// how it is hidden, and registers all that in one row at its end.
//
// How to run it, in the project's folder:
//   cmake --preset release -DPALPATE_OWN_EFFECTS=samples/own-effect/surface_tension.cpp
//   cmake --build --preset release
//   build/palpate probe samples/organ/organ.stl --hide surface-tension -o hidden
//   build/palpate run hidden
//
// What should be seen: "surface-tension" with the gamma that was hidden, where its shrinking is not taken for another
// effect's.

#include <fmt/format.h>

#include "fem/effects/surface/surface_energy.h"
#ifdef PALPATE_PHYSICS_ONLY
#include "skeleton/effects/effect.h"
#else
#include "identify/effects/catalogue.h"
#endif

namespace {

using namespace palpate;

// --- The physics: an energy of the skin's area -----------------------------------------------------------------------

/// gamma per area as it stands: gamma J per area at rest, J how many times as large it has become.
class SurfaceTension : public fem::SurfaceEnergy {
public:
    explicit SurfaceTension(double gamma) : gamma_(gamma) {}
    fem::AreaTerms terms(const Vec3& /*X*/, double J) const override {
        return {.w = gamma_ * J, .first = gamma_, .second = 0};
    }

private:
    double gamma_;  // [N/mm]
};

/// By name and numbers, as model files and `--hide` tell it.
skeleton::KnownEffect known_surface_tension() {
    return {"surface-tension",
            {{"gamma", "N/mm", skeleton::Range::not_negative}},
            [](const skeleton::EffectNumbers& numbers) -> fem::Effects {
                return {.surface = {std::make_shared<SurfaceTension>(numbers["gamma"])}};
            }};
}

#ifdef PALPATE_PHYSICS_ONLY

// libpalpate_runtime.so plays effects and diagnoses nothing: it compiles the physics alone.
const bool known = skeleton::register_effect(known_surface_tension());

#else

// --- How a diagnosis sees it -----------------------------------------------------------------------------------------

/// gamma over E times the body's size: a round bar a fifth as thick as it is long, of radius r and nu = 0.45, shortens
/// by 2 gamma (1 - nu) / (E r) = 1.1 %.
constexpr double felt = 1e-3;

class SurfaceTensionEffect : public identify::EffectHypothesis {
public:
    const identify::EffectDescription& description() const override {
        static const identify::EffectDescription text{
            .name = "surface-tension",
            .kind = identify::EffectKind::body,
            .meaning = "The skin pulls itself together, as that of a drop does.",
            .parameters = {"gamma [N/mm]: energy of the skin per area, as it stands"},
            .reveals = "a body that is shorter and rounder than its scan, untouched too, thin parts most",
            .confused_with = {"prestress", "gravity"},
            .separating_probe = "read the untouched body where it is thin and where it is thick",
            .next_probe = "load"};
        return text;
    }

    std::vector<identify::EffectNumber> numbers(const identify::BodyModel& model,
                                                const identify::Problem&) const override {
        Eigen::VectorXd theta(std::ssize(model.parameters()));
        for (Eigen::Index p = 0; p < theta.size(); ++p) theta[p] = model.parameters()[p].start;
        const double young = model.young({.law = 0, .theta = theta, .effects = {}});
        return {{.name = "gamma", .unit = "N/mm", .prior_sd = felt * young * model.size(), .least = 0}};
    }

    bool enforce(const Eigen::VectorXd& values, identify::ModelSetting& setting) const override {
        setting.effects.surface.push_back(std::make_shared<SurfaceTension>(values[0]));
        return true;
    }

    std::string sentence(const skeleton::EffectRecord& record) const override {
        return fmt::format("The skin pulls itself together with {:.3g} N/mm.", record.parameters[0].value);
    }

    // How it is hidden: stronger until it shows, from what is hardly felt on.
    std::optional<std::uint64_t> stream() const override { return 16; }

    std::vector<identify::EffectSampler> samplers(identify::SamplingContext& context,
                                                  const identify::SpecifiedNumbers& specified) const override {
        const double unit = felt * context.stiffness * context.model.size();
        return {{.at =
                     [=](double x) {
                         return specified.effect({{"gamma", unit * x}});
                     },
                 .start = 0.1,
                 .is_specified = specified.has("gamma"),
                 .acts_at_rest = true}};
    }
};

// --- All in one row --------------------------------------------------------------------------------------------------

const bool known = identify::register_effect(known_surface_tension(), std::make_shared<SurfaceTensionEffect>());

#endif

}  // namespace
