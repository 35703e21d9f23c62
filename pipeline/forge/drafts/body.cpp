#include <fmt/format.h>

#include <cmath>

#include "mesh/errors.h"
#include "pipeline/forge/drafts/kinds.h"

namespace palpate::pipeline {
namespace {

std::vector<Draft> gravity(Drawing& drawing, const Told& told) {
    const Vec3 direction = random_direction(drawing.random);
    const auto at = [=](double x) {
        const Vec3 g = told.vector({"gx", "gy", "gz"}, x * direction);
        return told.effect({{"gx", g.x()}, {"gy", g.y()}, {"gz", g.z()}});
    };
    return {{.at = at, .start = 9810, .is_told = told.has_any({"gx", "gy", "gz"}), .acts_at_rest = true}};
}

std::vector<Draft> compliant_support(Drawing& drawing, const Told& told) {
    // A block of the body's size and material is about as stiff as this.
    const double block = drawing.specimen.stiffness * drawing.specimen.model->size();  // [N/mm]
    const auto at = [=](double x) { return told.effect({{"stiffness", block / x}}); };
    return {{.at = at, .is_told = told.has("stiffness")}};
}

std::vector<Draft> pressure(Drawing& drawing, const Told& told) {
    if (!drawing.specimen.model->has_cavities()) {
        throw InvalidInput(
            "effect 'pressure' acts in closed cavities, and this body has none; give a surface with a "
            "closed shell inside, or hide another effect");
    }
    const double unit = 0.02 * drawing.specimen.stiffness;
    const double sign = drawing.random.uniform() < 0.3 ? -1 : 1;  // mostly it is pumped up
    const auto at = [=](double x) { return told.effect({{"pressure", x * sign * unit}}); };
    return {{.at = at, .is_told = told.has("pressure"), .acts_at_rest = true}};
}

std::vector<Draft> prestress(Drawing& drawing, const Told& told) {
    const Vec3 normal = drawing.random.normals(3).normalized(), shear = drawing.random.normals(3).normalized();
    const std::vector<std::string> names{"sxx", "syy", "szz", "sxy", "syz", "sxz"};
    const bool is_told = told.has_any(names);
    const auto at = [=](double x) {
        const double s = is_told ? 0 : x;
        std::vector<std::pair<std::string, double>> values;
        values.reserve(names.size());
        for (int i = 0; i < 3; ++i) values.emplace_back(names[i], s * normal[i]);
        for (int i = 0; i < 3; ++i) values.emplace_back(names[i + 3], 0.5 * s * shear[i]);
        return told.effect(values);
    };
    return {{.at = at, .start = 0.05, .most = 1, .is_told = is_told, .acts_at_rest = true}};
}

/// Poisson's ratio. What is not quite incompressible changes little when it becomes so, more when it becomes a sponge.
std::vector<Draft> volume(Drawing& drawing, const Told& told) {
    const Specimen& specimen = drawing.specimen;
    if (specimen.is_skeleton()) {
        throw InvalidInput(
            "effect 'volume' is of a solid: the links of a skeleton have no volume that could resist; "
            "hide another effect, or probe a mesh");
    }
    const double now = 1 - 2 * specimen.material->poisson;
    const bool stiffer = drawing.random.uniform() < 0.5 || now > 0.3;
    const auto at = [=](double x) {
        const double furthest = stiffer ? 0.002 : 0.6;  // nu = 0.499, 0.2
        const double then = std::pow(now, 1 - x) * std::pow(furthest, x);
        return told.effect({{"poisson", 0.5 * (1 - then)}});
    };
    return {{.at = at, .start = 0.5, .most = 1, .is_told = told.has("poisson")}};
}

/// How links resist twist or shear.
std::vector<Draft> of_links(Drawing& drawing, const Told& told, const std::string& name) {
    if (!drawing.specimen.is_skeleton()) {
        throw InvalidInput(
            fmt::format("effect '{}' is of a skeleton's links, and a solid has none; probe a "
                        "model.json, or hide another effect",
                        name));
    }
    const auto at = [=](double x) { return told.effect({{name, x}}); };
    return {{.at = at, .most = 100, .is_told = told.has(name)}};
}

std::vector<Draft> torsion(Drawing& drawing, const Told& told) { return of_links(drawing, told, "torsion"); }
std::vector<Draft> shear(Drawing& drawing, const Told& told) { return of_links(drawing, told, "shear"); }

}  // namespace

const std::vector<DraftKind>& body_kinds() {
    static const std::vector<DraftKind> kinds{
        {"gravity", gravity},   {"compliant-support", compliant_support},
        {"pressure", pressure}, {"prestress", prestress},
        {"volume", volume},     {"torsion", torsion},
        {"shear", shear},
    };
    return kinds;
}

}  // namespace palpate::pipeline
