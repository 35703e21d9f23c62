#include <cmath>

#include "mesh/errors.h"
#include "pipeline/forge/drafts/kinds.h"

namespace palpate::pipeline {
namespace {

std::vector<Draft> stiffening(Drawing& drawing, const Told& told) {
    if (drawing.specimen.in_small_strain()) {
        throw InvalidInput("effect 'stiffening' does not show in small strain; leave --linear out");
    }
    const bool is_told = told.has_any({"c2", "c3"});
    const auto at = [=](double x) {
        // Soft tissue and rubber: the third coefficient some ten times the second.
        const double c = is_told ? 0 : x;
        return told.effect({{"c2", c}, {"c3", 10 * c}});
    };
    return {{.at = at, .start = 3, .most = 300, .is_told = is_told}};
}

std::vector<Draft> anisotropy(Drawing& drawing, const Told& told) {
    constexpr int directions = 3;  // that are tried: fibres across a beam hardly show
    std::vector<Draft> drafts;
    for (int i = 0; i < directions; ++i) {
        const Vec3 n = told.vector({"nx", "ny", "nz"}, random_direction(drawing.random));
        const auto at = [=](double x) { return told.effect({{"k", x}, {"nx", n.x()}, {"ny", n.y()}, {"nz", n.z()}}); };
        drafts.push_back({.at = at, .start = 3, .most = 15, .is_told = told.has("k")});
    }
    if (told.has_any({"nx", "ny", "nz"})) drafts.resize(1);
    return drafts;
}

std::vector<Draft> viscosity(Drawing& drawing, const Told& told) {
    // Between the first and the last reading, so that both show.
    const std::vector<double>& dwell = drawing.rhythm.dwell;
    const double tau = dwell.size() > 1 ? std::sqrt(dwell.front() * dwell.back()) : 1;
    const double drawn = tau * std::exp(drawing.random.uniform() - 0.5);
    const auto at = [=](double x) { return told.effect({{"creep", x}, {"tau", drawn}}); };
    return {{.at = at, .start = 0.5, .most = 5, .is_told = told.has("creep")}};
}

std::vector<Draft> plasticity(Drawing&, const Told& told) {
    const auto at = [=](double x) { return told.effect({{"yield", 0.3 / x}, {"hardening", 0.3}}); };
    // Nothing below the yield point, much above it, and soon no equilibrium.
    return {{.at = at, .most = 100, .slope = 6, .growth = 1.3, .is_told = told.has("yield")}};
}

}  // namespace

const std::vector<DraftKind>& material_kinds() {
    static const std::vector<DraftKind> kinds{
        {"stiffening", stiffening}, {"anisotropy", anisotropy}, {"viscosity", viscosity}, {"plasticity", plasticity}};
    return kinds;
}

}  // namespace palpate::pipeline
