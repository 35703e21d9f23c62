#include "pipeline/output/text/draft.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>

#include "identify/effects/catalogue.h"
#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::pipeline {
namespace {

// @WORDS@ are replaced.
constexpr const char* frame = R"(// @SENTENCE@
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

const fem::Locality where{{@CENTRE@}, @RADIUS@};  // its middle and 1 sd of its weight [mm]

// --- The physics -----------------------------------------------------------------------------------------------------

@PHYSICS@
skeleton::KnownEffect known_physics() {
    return {"@NAME@",
            {@KNOWN@},
            [](const skeleton::EffectNumbers& numbers) -> fem::Effects {
                return @MADE@;
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
        static const identify::EffectDescription text{.name = "@NAME@",
                                                      .kind = identify::EffectKind::body,
                                                      .meaning = "@MEANING@",
                                                      .parameters = {@PARAMETERS@},
                                                      .reveals = "@REVEALS@",
                                                      .confused_with = {@CONFUSED@},
                                                      .separating_probe = "@PROBE@",
                                                      .next_probe = "@KIND@"};
        return text;
    }

    // 0 is neutral, as the screen needs it; the prior is as wide as what was fitted.
    std::vector<identify::EffectNumber> numbers(const identify::BodyModel&, const identify::Problem&) const override {
        std::vector<identify::EffectNumber> result;
        for (const char* name : {@NUMBERS@})
            result.push_back({.name = name, .unit = "@UNIT@", .prior_sd = @SIZE@});
        return result;
    }

    bool enforce(const Eigen::VectorXd& values, identify::ModelSetting& setting) const override {
        setting.effects.add(@FITTED@);
        return true;
    }

    std::string sentence(const skeleton::EffectRecord& record) const override {
        const auto& p = record.parameters;
        return fmt::format(@TOLD@);
    }
};

const bool known = identify::register_effect(known_physics(), std::make_shared<SourceEffect>());

#endif

}  // namespace
)";

constexpr const char* force =
    R"(/// A constant force on the material: the potential of a point, of which each has a share by its mass, is
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
)";

constexpr const char* springs =
    R"(/// Springs on the skin: the potential of a point, of which each has a share by its area, is e = k/2 |x - X|^2, k in
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
)";

constexpr const char* swelling =
    R"(/// The material is larger in every free length than it was at rest, by `growth` in the middle.
fem::Effects source(double growth) { return {.growth = {.parts = {{where, growth}}}}; }
)";

using Words = std::map<std::string, std::string>;

Words words_of_force(const Vec3& F) {
    return {{"PHYSICS", force},
            {"KNOWN", R"({"fx", "N"}, {"fy", "N"}, {"fz", "N"})"},
            {"MADE", R"(source(numbers.vector("fx", "fy", "fz")))"},
            {"FITTED", "source(values.head<3>())"},
            {"MEANING", "A constant force acts in one place."},
            {"PARAMETERS", R"("fx, fy, fz [N]: the force in all")"},
            {"REVEALS", "an error that is there without any load, about one place"},
            {"CONFUSED", R"("gravity", "prestress")"},
            {"PROBE", "read the unloaded body, with markers close to that place"},
            {"KIND", "orientation"},
            {"NUMBERS", R"("fx", "fy", "fz")"},
            {"UNIT", "N"},
            {"SIZE", fmt::format("{:.4g}", F.norm())},
            {"TOLD", R"("A force of ({:.3g}, {:.3g}, {:.3g}) N acts in one place.", p[0].value, p[1].value, )"
                     "\n                           p[2].value"}};
}

Words words_of_springs(double k) {
    return {{"PHYSICS", springs},
            {"KNOWN", R"({"stiffness", "N/mm"})"},
            {"MADE", R"(source(numbers["stiffness"]))"},
            {"FITTED", "source(values[0])"},
            {"MEANING", "Something holds the skin in one place."},
            {"PARAMETERS", R"("stiffness [N/mm]: of all springs together")"},
            {"REVEALS", "one place moves too little, under whatever probe"},
            {"CONFUSED", R"("inclusion", "contact")"},
            {"PROBE", "push that place to either side, and read how far it moves"},
            {"KIND", "load"},
            {"NUMBERS", R"("stiffness")"},
            {"UNIT", "N/mm"},
            {"SIZE", fmt::format("{:.4g}", k)},
            {"TOLD", R"("Something holds the skin in one place: {:.3g} N/mm.", p[0].value)"}};
}

Words words_of_swelling(double growth) {
    return {{"PHYSICS", swelling},
            {"KNOWN", R"({"growth", "1", fem::Range::above_minus_one})"},
            {"MADE", R"(source(numbers["growth"]))"},
            {"FITTED", "source(values[0])"},
            {"MEANING", "The material has grown in one place since the rest shape was taken."},
            {"PARAMETERS", R"("growth [-]: of every free length in the middle of that place")"},
            {"REVEALS", "an error that is there without any load, away from one place or towards it"},
            {"CONFUSED", R"("swelling", "prestress")"},
            {"PROBE", "read the unloaded body, with markers all round that place"},
            {"KIND", "fiducials"},
            {"NUMBERS", R"("growth")"},
            {"UNIT", "1"},
            {"SIZE", fmt::format("{:.4g}", std::abs(growth))},
            {"TOLD", R"("The material has grown by {:.2g} % in one place.", 100 * p[0].value)"}};
}

Words words_of(const skeleton::EffectRecord& effect) {
    const auto value = [&](std::size_t i) { return effect.parameters.at(i).value; };
    if (effect.name == "local-force") return words_of_force({value(4), value(5), value(6)});
    return effect.name == "local-springs" ? words_of_springs(value(4)) : words_of_swelling(value(4));
}

std::string filled(std::string text, const Words& words) {
    for (const auto& [word, by] : words) {
        const std::string mark = "@" + word + "@";
        for (std::size_t at = text.find(mark); at != std::string::npos; at = text.find(mark, at + by.size()))
            text.replace(at, mark.size(), by);
    }
    return text;
}

}  // namespace

void check_draft_name(const std::string& name) {
    const auto is_fine = [](unsigned char c) { return std::islower(c) != 0 || c == '-'; };
    if (name.empty() || !std::ranges::all_of(name, is_fine))
        throw InvalidInput(fmt::format(
            "an effect cannot be called {}; small letters and hyphens are allowed, and it is called as its file is: "
            "--draft ligament.cpp",
            mesh::cited(name)));
    if (identify::effect_named(name))
        throw InvalidInput(
            fmt::format("there is an effect '{}' already; give the file of the draft another name", name));
}

std::string draft_of(const skeleton::EffectRecord& effect, const std::string& name) {
    check_draft_name(name);
    const auto unnamed =
        std::ranges::find(identify::unnamed_sources(), effect.name, [](const auto& one) { return one->name(); });
    if (unnamed == identify::unnamed_sources().end())
        throw InvalidInput(fmt::format("'{}' is in the catalogue: it needs no draft", effect.name));
    const auto value = [&](std::size_t i) { return effect.parameters.at(i).value; };
    Words words = words_of(effect);
    words["NAME"] = name;
    words["SENTENCE"] = (*unnamed)->sentence(effect);
    words["CENTRE"] = fmt::format("{:.5g}, {:.5g}, {:.5g}", value(0), value(1), value(2));
    words["RADIUS"] = fmt::format("{:.4g}", value(3));
    return filled(frame, words);
}

}  // namespace palpate::pipeline
