// An effect of one's own, in one file.
//
// What it shows: an organ lies in soft tissue that the set does not specify, and which holds its skin back wherever it
// moves. The catalogue does not know such a thing. This file tells its physics, and how a diagnosis sees it; the
// program then plays it on both models, hides it in data, names it and adds it, like any other effect.
//
// How to run it, in the project's folder:
//   cmake --preset release -DPALPATE_OWN_EFFECTS=samples/own-effect/embedding.cpp && cmake --build --preset release
//   build/palpate probe samples/organ/organ.stl --hide embedding:stiffness=2e-4 -o hidden
//   build/palpate run hidden
//
// What should be seen: "missing-effect: embedding", with the stiffness that was hidden.

#include <fmt/format.h>

#include <cmath>

#ifdef PALPATE_PHYSICS_ONLY
#include "skeleton/effects/effect.h"
#else
#include "identify/effects/catalogue.h"
#endif

namespace {

using namespace palpate;

// --- The physics: a potential at a point of the skin, per area -----------------------------------------------------

/// A bed of springs all round the skin: e = k/2 |x - X|^2 per area, k in N/mm^3. [Winkler 1867]
class Embedding : public fem::PointPotential {
public:
    explicit Embedding(double k) : k_(k) {}
    fem::ActsOn acts_on() const override { return fem::ActsOn::surface; }
    fem::PointTerms terms(const Vec3& X, const Vec3& x) const override {
        const Vec3 u = x - X;
        return {.energy = 0.5 * k_ * u.squaredNorm(), .gradient = k_ * u, .hessian = k_ * Mat3::Identity()};
    }

private:
    double k_;
};

/// By name and numbers, as model files and `--hide` tell it.
skeleton::KnownEffect known_embedding() {
    return {"embedding",
            {{"stiffness", "N/mm^3", skeleton::Range::positive}},
            [](const skeleton::EffectNumbers& numbers) -> fem::Effects {
                return {.points = {std::make_shared<Embedding>(numbers["stiffness"])}};
            }};
}

#ifdef PALPATE_PHYSICS_ONLY

// libpalpate_runtime.so plays effects and diagnoses nothing: it compiles the physics alone.
const bool known = skeleton::register_effect(known_embedding());

#else

// --- How a diagnosis sees and hides it: stronger until it shows ------------------------------------------------------

class EmbeddingEffect : public identify::EffectHypothesis {
public:
    const identify::EffectDescription& description() const override {
        static const identify::EffectDescription text{
            .name = "embedding",
            .kind = identify::EffectKind::body,
            .meaning = "The body lies in something soft that holds its skin back wherever it moves.",
            .parameters = {"stiffness [N/mm^3]: pressure on the skin over how far it moves"},
            .reveals = "far parts that move too little, while those under the probe move as they should",
            .confused_with = {"stiffening", "compliant-support"},
            .separating_probe = "push far from the supports, and read how far the body follows",
            .next_probe = "load"};
        return text;
    }

    // What a stout body feels is some E / size, a slender one feels far less: 0 is neutral, as the screen needs it.
    std::vector<identify::EffectNumber> numbers(const identify::BodyModel& model,
                                                const identify::Problem&) const override {
        Eigen::VectorXd theta(std::ssize(model.parameters()));
        for (Eigen::Index p = 0; p < theta.size(); ++p) theta[p] = model.parameters()[p].start;
        const double felt = model.young({.law = 0, .theta = theta, .effects = {}}) / model.size();
        return {{.name = "stiffness", .unit = "N/mm^3", .prior_sd = 0.1 * felt}};
    }

    bool enforce(const Eigen::VectorXd& values, identify::ModelSetting& setting) const override {
        setting.effects.points.push_back(std::make_shared<Embedding>(values[0]));
        return true;
    }

    std::string sentence(const skeleton::EffectRecord& record) const override {
        return fmt::format("The body lies in something soft: {:.3g} N/mm^3 hold its skin back.",
                           record.parameters[0].value);
    }
};

// --- All in one row --------------------------------------------------------------------------------------------------

const bool known = identify::register_effect(known_embedding(), std::make_shared<EmbeddingEffect>());

#endif

}  // namespace
