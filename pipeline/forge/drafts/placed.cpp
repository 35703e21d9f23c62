#include <algorithm>
#include <cmath>
#include <numeric>

#include "mesh/errors.h"
#include "pipeline/forge/drafts/kinds.h"

namespace palpate::pipeline {
namespace {

constexpr int places = 3;  // that are tried, until the effect can be felt

// --- inclusion ---

/// Pieces of the body away from its supports; all of them where it is short.
std::vector<Vec3> free_pieces(const Specimen& specimen) {
    const Points& pieces = specimen.model->pieces();
    const Points& supports = specimen.model->support_points();
    for (const double away : {0.2, 0.1, 0.0}) {  // of the size
        std::vector<Vec3> free;
        for (Eigen::Index p = 0; p < pieces.rows(); ++p) {
            const double distance = (supports.rowwise() - pieces.row(p)).rowwise().norm().minCoeff();
            if (distance >= away * specimen.model->size()) free.emplace_back(pieces.row(p));
        }
        if (!free.empty()) return free;
    }
    return {};
}

/// The longest side of a stout body, less of one that is thin [mm].
double stout_size(const Specimen& specimen) {
    const double size = specimen.model->size();
    const double volume = std::abs(mesh::signed_volume(specimen.set.rest_surface));
    return volume > 0 ? std::min(size, 1.5 * std::cbrt(volume)) : size;
}

std::vector<Draft> inclusion(Drawing& drawing, const Told& told) {
    const double size = stout_size(drawing.specimen);
    const std::vector<Vec3> pieces = free_pieces(drawing.specimen);
    const double ratio = told.value("ratio", drawing.random.uniform() < 0.5 ? 8.0 : 1 / 8.0);
    const bool is_told = told.has_any({"radius", "hx", "hy", "hz"});
    std::vector<Draft> drafts;
    for (int place = 0; place < places; ++place) {
        const auto piece = static_cast<std::size_t>(drawing.random.uniform() * static_cast<double>(pieces.size()));
        const Vec3 centre = told.vector({"cx", "cy", "cz"}, pieces[piece]);
        const auto at = [=](double x) {
            std::vector<std::pair<std::string, double>> values{
                {"cx", centre.x()}, {"cy", centre.y()}, {"cz", centre.z()}, {"ratio", ratio}};
            if (!is_told) values.emplace_back("radius", (0.1 + 0.15 * x) * size);
            return told.effect(values);
        };
        drafts.push_back({.at = at, .start = 0.3, .most = 1, .is_told = is_told, .is_local = true});
    }
    if (told.has_any({"cx", "cy", "cz"}) || is_told) drafts.resize(1);
    return drafts;
}

// --- contact ---

/// Where a plane would be in the way.
struct Side {
    Vec3 towards;         // of unit length
    double reach = 0;     // of the body at rest along it [mm]
    double furthest = 0;  // how far a probe pushes the body beyond that, at most [mm]
    double pushed = 0;    // the same, rms over the rows [mm]
};

Side side_of(const Drawing& drawing, const Vec3& direction) {
    const Specimen& specimen = drawing.specimen;
    Side side{.towards = direction.normalized()};
    side.reach = (specimen.model->skin() * side.towards).maxCoeff();
    int rows = 0;
    for (const Path& path : drawing.plan.bare) {
        for (const Eigen::VectorXd& q : path) {
            const Points there = specimen.model->skin_positions(q, specimen.setting);
            const double beyond = std::max(0.0, (there * side.towards).maxCoeff() - side.reach);
            side.furthest = std::max(side.furthest, beyond);
            side.pushed += beyond * beyond;
            ++rows;
        }
    }
    side.pushed = std::sqrt(side.pushed / rows);
    return side;
}

/// The sides that the probes push the body to most, of 26 round it.
std::vector<Side> sides_in_the_way(const Drawing& drawing, int count) {
    std::vector<Side> sides;
    for (const int z : {-1, 0, 1}) {
        for (const int y : {-1, 0, 1}) {
            for (const int x : {-1, 0, 1}) {
                if (x != 0 || y != 0 || z != 0) sides.push_back(side_of(drawing, Vec3(x, y, z)));
            }
        }
    }
    std::ranges::stable_sort(sides, std::greater<>(), &Side::pushed);
    sides.resize(static_cast<std::size_t>(count));
    return sides;
}

std::vector<Draft> contact(Drawing& drawing, const Told& told) {
    const Specimen& specimen = drawing.specimen;
    if (specimen.model->skin().rows() == 0) throw InvalidInput("effect 'contact' needs a skin, the model has none");
    if (specimen.is_skeleton() && specimen.in_small_strain()) {
        throw InvalidInput(
            "effect 'contact' is one-sided, which a skeleton's linear law cannot be; leave --linear out");
    }
    // One of the six sides that are pushed to most; then the others.
    std::vector<Side> sides = sides_in_the_way(drawing, 6);
    const auto first = static_cast<std::size_t>(drawing.random.uniform() * static_cast<double>(sides.size()));
    std::swap(sides[0], sides[first]);
    sides.resize(places);
    if (told.has_any({"nx", "ny", "nz"})) {
        const Vec3 n = told.vector({"nx", "ny", "nz"}, Vec3::Zero());
        if (n.isZero(0)) throw InvalidInput("effect 'contact': the normal (nx, ny, nz) is zero; it needs a direction");
        sides = {side_of(drawing, -n)};
    }
    // Stiff against the body: pressed by E/20 it gives way by 0.05 % of the size.
    const double stiffness = 100 * specimen.stiffness / specimen.model->size();
    std::vector<Draft> drafts;
    for (const Side& side : sides) {
        const auto at = [=](double x) {
            const double gap = (1 - x) * side.furthest;
            const Vec3 n = -side.towards;
            return told.effect({{"nx", n.x()},
                                {"ny", n.y()},
                                {"nz", n.z()},
                                {"offset", -(side.reach + gap)},
                                {"stiffness", stiffness}});
        };
        drafts.push_back({.at = at, .start = 0.6, .most = 1, .is_told = told.has("offset"), .is_local = true});
    }
    return drafts;
}

}  // namespace

const std::vector<DraftKind>& placed_kinds() {
    static const std::vector<DraftKind> kinds{{"inclusion", inclusion}, {"contact", contact}};
    return kinds;
}

}  // namespace palpate::pipeline
