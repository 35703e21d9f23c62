#include "mesh/meshing/repair/wrap_round.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "mesh/errors.h"
#include "mesh/geometry/surface_tree.h"
#include "mesh/geometry/winding.h"
#include "mesh/meshing/repair/guarded.h"
#include "mesh/meshing/repair/steps.h"
#include "mesh/topology/check_surface.h"

namespace palpate::mesh {
namespace {

constexpr double allowed_growth = 0.03;  // share of the volume
constexpr int growth_points = 2500;      // tell that share to 0.34 %, one sigma
constexpr double allowed_skin = 0.02;    // share of the area
// Sizes of the ball that wraps, as parts of the diagonal, coarse, usual and fine: it enters no gaps narrower than it,
// and the triangles of a wrap grow with the square of the part. The wrap lies a twentieth of the ball off the surface.
constexpr double coarse_part = 25, usual_part = 100, fine_part = 170, parts_of_ball = 20;
constexpr int most_wrapped = 100'000;  // triangles of a wrap, for limits on time and memory

Surface wrapped_with(const Surface& surface, double alpha, double offset) {
    if (const auto wrapped =
            guarded(most_wrapped + surface.triangles.rows(), [&] { return wrap(surface, alpha, offset); }))
        return *wrapped;
    throw InvalidInput(
        fmt::format("Repair: the surface cannot be wrapped within the limits on time and memory ({} triangles). "
                    "Mend it in a mesh editor, or make it coarser.",
                    surface.triangles.rows()));
}

/// Both sides of a sheet, each `offset` away: a skin, not a body.
void require_body(const Surface& wrapped, double offset, double largest_hole) {
    const double thickness = 2 * signed_volume(wrapped) / area(wrapped);
    if (thickness > 4 * offset) return;
    throw InvalidInput(
        fmt::format("Repair: the surface encloses no volume: what can be wrapped round it is a skin {:.3g} mm "
                    "thick. It is an open sheet, or has holes larger than {:.0f} % of its diagonal: close "
                    "them, or allow larger ones to be filled.",
                    thickness, 100 * largest_hole));
}

/// Where a part of the surface is open, the wrap goes in and leaves a skin there while the rest is a body.
void require_no_skin(const Surface& wrapped, double offset, double largest_hole) {
    const SurfaceTree tree(wrapped);
    const Points normals = area_vectors(wrapped);
    double skin = 0, all = 0;
    Vec3 place = Vec3::Zero();
    for (Eigen::Index t = 0; t < wrapped.triangles.rows(); ++t) {
        const Vec3 center = wrapped.vertices(wrapped.triangles.row(t).transpose().eval(), Eigen::all).colwise().mean();
        const double triangle_area = normals.row(t).norm();
        all += triangle_area;
        if (tree.inside(center - 4 * offset * normals.row(t).transpose() / triangle_area)) continue;
        skin += triangle_area;
        place = center;
    }
    if (skin <= allowed_skin * all) return;
    throw InvalidInput(
        fmt::format("Repair: {:.0f} % of what can be wrapped round the surface is a skin less than {:.3g} mm thick, "
                    "for instance at ({:.4g}, {:.4g}, {:.4g}) mm: there it is an open sheet, or has holes larger "
                    "than {:.0f} % of its diagonal. Close them in a mesh editor.",
                    100 * skin / all, 4 * offset, place.x(), place.y(), place.z(), 100 * largest_hole));
}

/// The wrap on its way back onto what it was wrapped round.
class WrapProjection {
public:
    WrapProjection(const Surface& surface, const Surface& wrapped, double reach)
        : wrapped_(wrapped), normals_(area_vectors(wrapped)), moves_(Points::Zero(wrapped.vertices.rows(), 3)) {
        const SurfaceTree tree(surface);
        for (Eigen::Index v = 0; v < moves_.rows(); ++v) {
            const SurfacePoint near = tree.closest(wrapped.vertices.row(v));
            if (near.distance < reach)
                moves_.row(v) = share_of_move * (near.position.transpose() - wrapped.vertices.row(v));
        }
    }

    /// As far as the surface stays sound: vertices of triangles that would cross others, turn or lose their area go
    /// half of the way, a quarter and so on.
    Surface furthest() {
        Surface moved = wrapped_;
        for (int i = 0; i < rounds; ++i) {
            moved.vertices = wrapped_.vertices + moves_;
            const std::vector<char> at_fault = vertices_at_fault(moved);
            if (std::ranges::count(at_fault, 1) == 0) return moved;
            const double kept = i + last_rounds < rounds ? 0.5 : 0;
            for (Eigen::Index v = 0; v < moves_.rows(); ++v)
                if (at_fault[static_cast<std::size_t>(v)]) moves_.row(v) *= kept;
        }
        return wrapped_;
    }

private:
    static constexpr double share_of_move = 0.6;  // sheets that touch stay apart, and walls without thickness have some
    static constexpr double least_left = 0.1;     // of a triangle's area, seen along its normal: it has all but folded
    static constexpr int rounds = 10, last_rounds = 4;

    std::vector<char> vertices_at_fault(const Surface& moved) const {
        std::vector<char> at_fault(static_cast<std::size_t>(moves_.rows()), 0);
        const auto blame = [&](Eigen::Index triangle) {
            for (const int v : moved.triangles.row(triangle)) at_fault[static_cast<std::size_t>(v)] = 1;
        };
        std::vector<FaultPlace> places;
        check_surface(moved, &places);
        for (const FaultPlace& place : places)
            for (const int triangle : place.triangles) blame(triangle);
        const Points normals = area_vectors(moved);
        for (Eigen::Index t = 0; t < normals.rows(); ++t)
            if (normals.row(t).dot(normals_.row(t)) < least_left * normals_.row(t).squaredNorm()) blame(t);
        return at_fault;
    }

    const Surface& wrapped_;
    Points normals_, moves_;
};

/// Sound and round everything; no longer larger than the body where its vertices could go back onto it.
Surface wrapped_closely(const Surface& surface, double alpha, double largest_hole) {
    const double offset = alpha / parts_of_ball;
    const Surface wrapped = wrapped_with(surface, alpha, offset);
    require_body(wrapped, offset, largest_hole);
    require_no_skin(wrapped, offset, largest_hole);
    return WrapProjection(surface, wrapped, 2 * offset).furthest();
}

}  // namespace

Wrapping wrap_round(const Surface& surface, double largest_hole) {
    const double diagonal = bounding_box(surface.vertices).diagonal();
    // A coarse wrap costs little, and tells a sheet from a body already.
    const double coarse = diagonal / coarse_part;
    require_body(wrapped_with(surface, coarse, coarse / parts_of_ball), coarse / parts_of_ball, largest_hole);
    double alpha = 0, growth = 0;
    for (const double part : {usual_part, fine_part}) {
        alpha = diagonal / part;
        const Surface wrapped = wrapped_closely(surface, alpha, largest_hole);
        growth = share_outside(wrapped, surface, growth_points);
        if (growth <= allowed_growth) return {wrapped, alpha};
    }
    throw InvalidInput(fmt::format(
        "Repair: {:.1f} % of what can be wrapped round the surface lies outside of it: it has cavities, or gaps or "
        "walls narrower than {:.3g} mm; {:.0f} % is allowed. Mend the surface in a mesh editor.",
        100 * growth, alpha, 100 * allowed_growth));
}

}  // namespace palpate::mesh
