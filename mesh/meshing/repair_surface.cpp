#include "mesh/meshing/repair_surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mesh/errors.h"
#include "mesh/geometry/surface_tree.h"
#include "mesh/meshing/repair/cap_flat_holes.h"
#include "mesh/meshing/repair/drop_fins.h"
#include "mesh/meshing/repair/guarded.h"
#include "mesh/meshing/repair/steps.h"
#include "mesh/meshing/repair/wrap_round.h"
#include "mesh/numbers/median.h"
#include "mesh/system/isolated.h"
#include "mesh/topology/check_surface.h"
#include "mesh/topology/shells.h"
#include "mesh/topology/weld.h"

namespace palpate::mesh {

template <class Archive>
void serialize(Archive& archive, RepairResult& result) {
    archive(result.surface, result.steps, result.distance, result.volume, result.wrapped);
}

namespace {

double median_of(const Eigen::VectorXd& values) { return upper_median(std::vector(values.begin(), values.end())); }

/// No triangle with an area is left once corners within `distance` count as one.
[[noreturn]] void throw_nothing_left(const Surface& input, double distance) {
    const Eigen::RowVector3d median(median_of(input.vertices.col(0)), median_of(input.vertices.col(1)),
                                    median_of(input.vertices.col(2)));
    const Eigen::VectorXd away = (input.vertices.rowwise() - median).rowwise().norm();
    Eigen::Index furthest = 0;
    if (away.maxCoeff(&furthest) <= 1000 * median_of(away))
        throw InvalidInput("Repair: no triangle of the surface has an area. Give a surface that encloses a volume.");
    const Vec3 at = input.vertices.row(furthest);
    throw InvalidInput(fmt::format(
        "Repair: vertex {} (from 1) at ({:.4g}, {:.4g}, {:.4g}) lies so far away from the others that these are a "
        "point beside it: corners within {:.3g} mm, a millionth of the diagonal, count as one. Move or remove it, and "
        "export the surface again.",
        furthest + 1, at.x(), at.y(), at.z(), distance));
}

/// The surface on its way, with what is wrong with it and what was done.
class Repair {
public:
    Repair(const Surface& input, const RepairOptions& options, RepairResult& result)
        : options_(options), result_(result), input_(input), box_(bounding_box(input.vertices)) {
        WeldResult welded = weld(input, options.weld * box_.diagonal());
        if (welded.merged > 0) say(fmt::format("{} corners welded with their neighbours", welded.merged));
        take(std::move(welded.surface));
    }

    const Surface& surface() const { return surface_; }
    const SurfaceReport& report() const { return report_; }
    bool sound() const { return report_.sound(); }

    void drop_open_fins() {
        if (report_.non_manifold_edges == 0) return;
        const int edges = report_.non_manifold_edges;
        take(drop_fins(surface_, dropped_));
        if (report_.non_manifold_edges < edges)
            say(fmt::format("fins without thickness dropped at {} edges", edges - report_.non_manifold_edges));
    }

    void orient_and_stitch_sheets() {
        const SurfaceReport before = report_;
        take(orient_and_stitch(surface_));
        if (surface_.triangles.rows() == 0) throw_nothing_left(input_, options_.weld * box_.diagonal());
        if (before.duplicate_triangles > 0)
            say(fmt::format("{} twins of triangles dropped", before.duplicate_triangles));
        if (before.degenerate_triangles > report_.degenerate_triangles)
            say(fmt::format("{} triangles without area dropped",
                            before.degenerate_triangles - report_.degenerate_triangles));
        if (before.inconsistent_edges > 0)
            say(fmt::format("triangles turned along {} edges that disagreed", before.inconsistent_edges));
        if (before.non_manifold_edges > report_.non_manifold_edges)
            say(fmt::format("sheets taken apart at {} edges with more than two triangles",
                            before.non_manifold_edges - report_.non_manifold_edges));
    }

    void fill_small_holes() {
        if (report_.boundary_edges == 0) return;
        const int holes = report_.holes;
        const auto filled = guarded(surface_.triangles.rows(),
                                    [&] { return fill_holes(surface_, options_.largest_hole * box_.diagonal()); });
        if (filled) take(*filled);
        if (report_.holes < holes) say(fmt::format("{} holes filled", holes - report_.holes));
        cap_large_flat_holes();
    }

    void unite_overlapping_shells() {
        if (report_.self_intersections == 0 || report_.components < 2 || !report_.closed) return;
        const int parts = report_.components;
        const auto united = guarded(surface_.triangles.rows(), [&] { return unite_shells(surface_); });
        if (!united) return;  // the next steps see to it
        take(*united);
        united_ = true;
        say(fmt::format("{} overlapping parts united into {}", parts, report_.components));
    }

    void remove_self_intersections() {
        if (report_.self_intersections + report_.degenerate_triangles == 0) return;
        whole_ = surface_;
        const int crossings = report_.self_intersections, degenerate = report_.degenerate_triangles;
        const auto without = guarded(surface_.triangles.rows(), [&] { return remove_crossings(surface_); });
        if (!without) return;
        take(*without);
        if (report_.self_intersections < crossings)
            say(fmt::format("{} of {} crossing pairs of triangles removed", crossings - report_.self_intersections,
                            crossings));
        if (report_.degenerate_triangles < degenerate)
            say(fmt::format("{} triangles without area removed", degenerate - report_.degenerate_triangles));
    }

    void turn_shells_outward() {
        if (!report_.closed || report_.outward || report_.self_intersections > 0) return;
        take(turn_outward(surface_));
        say("the surface turned outwards");
    }

    /// Largest distance of the input's vertices from the surface; without those deeper inside than 2 % of the
    /// diagonal where walls inside were lost on purpose (wrapping, union).
    double distance() const {
        const SurfaceTree tree(surface_);
        std::vector<char> used(static_cast<std::size_t>(input_.vertices.rows()), 0);
        for (const int v : input_.triangles.reshaped()) used[static_cast<std::size_t>(v)] = 1;
        double largest = 0;
        for (Eigen::Index v = 0; v < input_.vertices.rows(); ++v) {
            if (!used[static_cast<std::size_t>(v)]) continue;
            const Vec3 point = input_.vertices.row(v);
            if (was_dropped(point)) continue;
            const double distance = tree.closest(point).distance;
            const bool lost_wall =
                (result_.wrapped || united_) && distance > box_.diagonal() / 50 && tree.inside(point);
            if (!lost_wall) largest = std::max(largest, distance);
        }
        return largest;
    }
    /// Of a fin, which is gone on purpose?
    bool was_dropped(const Vec3& point) const {
        return std::ranges::any_of(
            dropped_, [&](const Vec3& of_fin) { return (of_fin - point).norm() <= options_.weld * box_.diagonal(); });
    }
    double allowed_distance() const { return options_.allowed_distance * box_.diagonal(); }

    void wrap_all() {
        if (whole_.triangles.rows() > 0) take(whole_);
        Wrapping wrapping = wrap_round(surface_, options_.largest_hole);
        take(std::move(wrapping.surface));
        result_.wrapped = true;
        say(fmt::format("wrapped with alpha = {:.4g} mm: details narrower than that and inner walls are gone",
                        wrapping.alpha));
    }

private:
    void cap_large_flat_holes() {
        if (report_.boundary_edges == 0) return;
        const SurfaceReport before = report_;
        Surface open = surface_;
        take(cap_flat_holes(surface_, options_.largest_flat_hole * box_.diagonal()));
        if (report_.holes == before.holes || report_.self_intersections > before.self_intersections)
            take(std::move(open));
        else
            say(fmt::format("{} flat holes, larger than {:.0f} % of the diagonal, closed by planes",
                            before.holes - report_.holes, 100 * options_.largest_hole));
    }

    void say(std::string step) { result_.steps.push_back(std::move(step)); }
    void take(Surface surface) {
        surface_ = std::move(surface);
        report_ = check_surface(surface_);
    }

    const RepairOptions& options_;
    RepairResult& result_;
    const Surface& input_;
    Box box_;
    Surface surface_;
    Surface whole_;  // before anything was cut away
    bool united_ = false;
    std::vector<Vec3> dropped_;  // vertices of fins
    SurfaceReport report_;
};

void require_triangles(const Surface& surface) {
    if (surface.triangles.rows() == 0)
        throw InvalidInput("Repair: the surface has no triangles. Give a surface that encloses a volume.");
    const Eigen::Index n = surface.vertices.rows();
    if (surface.triangles.minCoeff() < 0 || surface.triangles.maxCoeff() >= n)
        throw InvalidInput(fmt::format(
            "Repair: a triangle names vertex {}; 0 to {} are allowed.",
            surface.triangles.minCoeff() < 0 ? surface.triangles.minCoeff() : surface.triangles.maxCoeff(), n - 1));
    for (Eigen::Index v = 0; v < n; ++v)
        if (!surface.vertices.row(v).allFinite())
            throw InvalidInput(fmt::format("Repair: vertex {} is not finite. Remove it from the surface.", v));
}

/// A doubled sheet is closed and holds nothing.
void require_volume(const SurfaceReport& report) {
    if (!report.closed || std::abs(report.volume) > 1e-6 * report.area * report.box.diagonal()) return;
    throw InvalidInput(
        fmt::format("Repair: the surface encloses no volume ({:.3g} mm^3 at an area of {:.3g} mm^2): it is flat or "
                    "a doubled sheet. Give the boundary of a solid body.",
                    report.volume, report.area));
}

RepairResult repair(const Surface& surface, const RepairOptions& options) {
    RepairResult result;
    Repair repair(surface, options, result);
    const bool was_sound = repair.sound() && !options.wrap;
    if (!was_sound) {
        repair.drop_open_fins();
        repair.orient_and_stitch_sheets();
        repair.fill_small_holes();
        require_volume(repair.report());
        repair.unite_overlapping_shells();
        repair.remove_self_intersections();
        repair.fill_small_holes();
        repair.turn_shells_outward();
        const bool is_repaired = repair.sound() && repair.distance() <= repair.allowed_distance();
        if (options.wrap || (options.may_wrap && !is_repaired)) repair.wrap_all();
    }
    if (!repair.sound())
        throw InvalidInput(
            fmt::format("Repair: the surface could not be made sound; left over: {} Mend it in a mesh editor.",
                        fmt::join(describe_faults(repair.report()), " ")));

    result.surface = weld(repair.surface(), 0).surface;
    result.volume = signed_volume(result.surface);
    result.distance = repair.distance();
    if (result.distance > repair.allowed_distance())
        throw InvalidInput(fmt::format(
            "Repair: the mended surface lies {:.3g} mm from the given one; {:.3g} mm ({:.1f} % of the "
            "diagonal) is allowed. After: {}. Mend it in a mesh editor, or allow more.",
            result.distance, repair.allowed_distance(), 100 * options.allowed_distance, fmt::join(result.steps, "; ")));
    if (!was_sound)
        result.steps.push_back(
            fmt::format("the mended surface encloses {:.4g} mm^3 and lies within {:.3g} mm of the "
                        "given one",
                        result.volume, result.distance));
    return result;
}

}  // namespace

void RepairOptions::validate() const {
    if (!(weld > 0 && weld <= 0.01))
        throw InvalidInput(
            fmt::format("Repair: weld is {}; more than 0 and up to 0.01 of the diagonal is allowed.", weld));
    if (!(largest_hole >= 0 && largest_hole <= 1))
        throw InvalidInput(fmt::format("Repair: largest_hole is {}; 0 to 1 of the diagonal is allowed.", largest_hole));
    if (!(largest_flat_hole >= 0 && largest_flat_hole <= 1))
        throw InvalidInput(
            fmt::format("Repair: largest_flat_hole is {}; 0 to 1 of the diagonal is allowed.", largest_flat_hole));
    if (!(allowed_distance > 0 && allowed_distance <= 1))
        throw InvalidInput(fmt::format(
            "Repair: allowed_distance is {}; more than 0 and up to 1 of the diagonal is allowed.", allowed_distance));
}

RepairResult repair_surface(const Surface& surface, const RepairOptions& options) {
    options.validate();
    require_triangles(surface);
    ChildLimits limits = limits_for(static_cast<double>(surface.triangles.rows()), 5e-3);
    limits.seconds += 80;  // for some steps that come to no end, after which others serve
    return isolated_as<RepairResult>("The repair of the surface",
                                     "Mend the surface in a mesh editor: remesh it there, or simplify it.", limits,
                                     [&] { return repair(surface, options); });
}

}  // namespace palpate::mesh
