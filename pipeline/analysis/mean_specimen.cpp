#include "pipeline/analysis/mean_specimen.h"

#include <fmt/format.h>

#include <algorithm>

namespace palpate::pipeline {
namespace {

/// What two skeletons differ in, in words; empty: they correspond.
std::string difference(const SpecimenModel& one, const SpecimenModel& other) {
    const skeleton::Model &a = one.model, &b = other.model;
    const auto counts = [&](const char* what, auto of_one, auto of_other) {
        return fmt::format("{} has {} {}, {} has {}", one.name, of_one, what, other.name, of_other);
    };
    if (a.spheres.size() != b.spheres.size()) return counts("spheres", a.spheres.size(), b.spheres.size());
    if (a.links.size() != b.links.size()) return counts("links", a.links.size(), b.links.size());
    const auto joins_the_same = [](const skeleton::Link& l, const skeleton::Link& m) {
        return l.a == m.a && l.b == m.b;
    };
    if (!std::ranges::equal(a.links, b.links, joins_the_same))
        return fmt::format("links of {} and {} join different spheres", one.name, other.name);
    if (a.surface.vertices.rows() != b.surface.vertices.rows())
        return counts("vertices", a.surface.vertices.rows(), b.surface.vertices.rows());
    if (a.surface.triangles.rows() != b.surface.triangles.rows() || a.surface.triangles != b.surface.triangles)
        return fmt::format("triangles of {} and {} join different vertices", one.name, other.name);
    return {};
}

}  // namespace

MeanSpecimen mean_specimen(const std::vector<SpecimenModel>& specimens) {
    MeanSpecimen mean{.model = specimens.front().model, .why_none = {}};
    skeleton::Model& model = *mean.model;
    model.effects.clear();
    const double share = 1 / static_cast<double>(specimens.size());
    model.surface.vertices *= share;
    for (skeleton::Sphere& sphere : model.spheres) {
        sphere.center *= share;
        sphere.radius *= share;
    }
    for (std::size_t n = 1; n < specimens.size(); ++n) {
        if (std::string words = difference(specimens.front(), specimens[n]); !words.empty())
            return {.model = {}, .why_none = std::move(words)};
        const skeleton::Model& other = specimens[n].model;
        model.surface.vertices += share * other.surface.vertices;
        for (std::size_t i = 0; i < model.spheres.size(); ++i) {
            model.spheres[i].center += share * other.spheres[i].center;
            model.spheres[i].radius += share * other.spheres[i].radius;
        }
    }
    return mean;
}

}  // namespace palpate::pipeline
