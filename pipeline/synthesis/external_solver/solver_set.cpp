#include "pipeline/synthesis/external_solver/solver_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "fem/interpolation/interpolation.h"
#include "mesh/errors.h"
#include "mesh/formats/vtk/vtk_files.h"
#include "mesh/geometry/sampling.h"
#include "mesh/geometry/surface_tree.h"
#include "mesh/numbers/median.h"
#include "pipeline/case/subject/subject.h"
#include "pipeline/synthesis/external_solver/nodal_loads.h"

namespace palpate::pipeline {
namespace {

using identify::LoadState;

void scale(mesh::Solution& solution, double unit) {
    solution.nodes *= unit;
    solution.body.nodes *= unit;
    solution.surface.vertices *= unit;
    for (mesh::SolvedStep& step : solution.steps) step.displacement *= unit;
}

/// Values at points, out of those at a solution's nodes; NaN where these are.
Points at_points(const mesh::Solution& solution, const Points& values, const Points& points) {
    if (solution.body.tetrahedra.rows() > 0)
        return fem::interpolation(solution.body, points) * values(solution.node_of_body, Eigen::all);
    const mesh::SurfaceTree tree(solution.surface);
    Points result(points.rows(), 3);
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
        const mesh::SurfacePoint nearest = tree.closest(points.row(i));
        Vec3 value = Vec3::Zero();
        for (int c = 0; c < 3; ++c) {
            const int vertex = solution.surface.triangles(nearest.triangle, c);
            value += nearest.barycentric[c] *
                     values.row(solution.node_of_vertex[static_cast<std::size_t>(vertex)]).transpose();
        }
        result.row(i) = value;
    }
    return result;
}

/// Median edge of a surface [mm].
double spacing_of(const mesh::Surface& surface) {
    std::vector<double> edges;
    for (const auto& triangle : surface.triangles.rowwise())
        edges.push_back((surface.vertices.row(triangle[0]) - surface.vertices.row(triangle[1])).norm());
    return mesh::upper_median(std::move(edges));
}

Points as_points(const std::vector<Vec3>& points) {
    Points rows(std::ssize(points), 3);
    for (std::size_t i = 0; i < points.size(); ++i) rows.row(static_cast<Eigen::Index>(i)) = points[i];
    return rows;
}

/// Largest distance of a surface's vertices from another surface [mm].
double furthest_from(const mesh::Surface& other, const mesh::Surface& surface) {
    const mesh::SurfaceTree tree(other);
    double furthest = 0;
    for (const auto& vertex : surface.vertices.rowwise()) furthest = std::max(furthest, tree.closest(vertex).distance);
    return furthest;
}

class Maker {
public:
    Maker(Case settings, const ForeignOptions& options, const Progress& progress)
        : settings_(std::move(settings)), options_(options), progress_(progress) {
        if (settings_.longest > 0)
            throw InvalidInput(
                "--longest scales the body, and would leave the solver's fields behind; give its unit with --unit");
        made_.unit = settings_.unit;
        made_.array = options_.array;
    }

    ForeignSet execute() {
        made_.results = scan_results(options_.folder, made_.unit, options_.array);
        made_.notes = made_.results.notes;
        for (std::size_t f = 0; f < made_.results.fields.size(); ++f) {
            report(progress_, "fields", static_cast<double>(f) / static_cast<double>(made_.results.fields.size()));
            read_field(f);
        }
        report(progress_, "fields", 1);
        describe();
        return std::move(made_);
    }

private:
    /// The solution behind a field; the file that was read last stays.
    const mesh::Solution& solution_of(const FieldPlace& place) {
        if (!now_ || now_->file != place.file) {
            now_ = made_.results.read(place.file, options_.array);
            scale(*now_, made_.unit);
        }
        return *now_;
    }

    void read_field(std::size_t f) {
        const FieldPlace& place = made_.results.fields[f];
        const mesh::Solution& solution = solution_of(place);
        const Points& displacement = place.in(solution).displacement;
        if (f == 0) begin(solution);
        const bool is_same_mesh =
            solution.nodes.rows() == first_.nodes.rows() && (solution.nodes - first_.nodes).isZero(0);
        displacements_.push_back(is_same_mesh ? Points(displacement(nodes_, Eigen::all))
                                              : at_points(solution, displacement, markers_));
    }

    /// Body, supports and markers, by the first field.
    void begin(const mesh::Solution& first) {
        first_ = first;
        made_.notes.insert(made_.notes.end(), first.notes.begin(), first.notes.end());
        stays_ = unmoved(first);
        find_supports();
        Subject subject = read_subject(settings_);
        made_.set.name = subject.settings.name;
        made_.set.rest_surface = subject.surface;
        made_.set.supports = subject.supports;
        take_regions(subject);
        made_.notes.insert(made_.notes.end(), subject.notes.begin(), subject.notes.end());
        check_place(subject.surface);
        choose_markers();
    }

    /// Where they are is known; how stiff, the solver's answers tell.
    void take_regions(const Subject& subject) {
        made_.set.regions = subject.regions;
        for (mesh::MaterialRegion& region : made_.set.regions) region.young.reset();
        if (!subject.regions.empty())
            made_.notes.emplace_back(
                "The set leaves the regions' stiffness to be identified ('young: null'); write it into set.yaml where "
                "it is known.");
    }

    /// Nodes that no step of the file moves, though it moves some (flags).
    static std::vector<char> unmoved(const mesh::Solution& solution) {
        std::vector<char> stays(static_cast<std::size_t>(solution.nodes.rows()), 1);
        for (const mesh::SolvedStep& step : solution.steps)
            for (std::size_t n = 0; n < stays.size(); ++n)
                if (!step.displacement.row(static_cast<Eigen::Index>(n)).isZero(0)) stays[n] = 0;
        return stays;
    }

    void find_supports() {
        if (!settings_.supports.empty() || settings_.measurements) return;
        const std::optional<mesh::Deck>& deck = made_.results.deck;
        const bool is_given = deck && !deck->held.empty();
        std::vector<Vec3> in, out;
        if (is_given) {
            for (std::size_t n = 0; n < deck->cells.nodes.size(); ++n)
                (deck->held.contains(deck->cells.node_numbers[n]) ? in : out)
                    .push_back(made_.unit * deck->cells.nodes[n]);
        } else {
            for (std::size_t n = 0; n < stays_.size(); ++n)
                (stays_[n] ? in : out).emplace_back(first_.nodes.row(static_cast<Eigen::Index>(n)));
        }
        if (is_given && !deck->held_in_part.empty())
            made_.notes.push_back(fmt::format(
                "{} nodes are held in some directions only, or moved: a support holds all of them at zero, so these "
                "count as free.",
                deck->held_in_part.size()));
        if (in.empty() || out.empty())
            throw InvalidInput(
                fmt::format("{}: {} node stays where it is; say in a case.yaml where the body is held "
                            "('supports').",
                            options_.folder.string(), in.empty() ? "no" : "every"));
        settings_.supports = {held_region(as_points(in), as_points(out), 0.6 * spacing_of(first_.surface))};
        made_.notes.push_back(fmt::format(
            "Held at {} nodes {}.", in.size(),
            is_given ? "that *BOUNDARY holds in " + deck->file.filename().string() : "that no field moves"));
    }

    /// The fields must lie where the body does.
    void check_place(const mesh::Surface& body) const {
        const double size = mesh::bounding_box(body.vertices).longest_side();
        const double its_size = mesh::bounding_box(first_.surface.vertices).longest_side();
        const double furthest = std::max(furthest_from(body, first_.surface), furthest_from(first_.surface, body));
        constexpr double allowed = 0.03;  // of the size: chords of coarse elements
        if (furthest <= allowed * size) return;
        std::string cause =
            "are they of this body, at rest and not warped by their displacement? Elements longer than the thickness "
            "of a rim cut it off: shorter ones (--edge-length) follow it.";
        for (const double factor : {10.0, 25.4, 1000.0, 0.1, 1 / 25.4, 0.001})
            if (std::abs(its_size / size - factor) < 0.05 * factor)
                cause = fmt::format(
                    "they are {:g} times as large: another unit? Lengths of mesh and solver must be in "
                    "one unit, which --unit tells.",
                    factor);
        throw InvalidInput(
            fmt::format("{}: the surface of its mesh and the body's lie up to {:.3g} mm apart, more than {:.0f} "
                        "% of its size; {}",
                        first_.file.string(), furthest, 100 * allowed, cause));
    }

    /// Nodes of the surface that are free, and told in all steps.
    void choose_markers() {
        std::vector<int> candidates;
        for (const int node : first_.node_of_vertex) {
            const auto is_given = [&](const mesh::SolvedStep& step) { return step.displacement.row(node).allFinite(); };
            if (!mesh::contains(made_.set.supports, Vec3(first_.nodes.row(node))) &&
                std::ranges::all_of(first_.steps, is_given))
                candidates.push_back(node);
        }
        if (candidates.size() < 3)
            throw InvalidInput(
                fmt::format("{}: tells displacements of {} free nodes of the surface; 3 or more are "
                            "needed.",
                            first_.file.string(), candidates.size()));
        for (const int chosen : mesh::farthest_points(first_.nodes(candidates, Eigen::all), settings_.probing.markers))
            nodes_.push_back(candidates[static_cast<std::size_t>(chosen)]);
        markers_ = first_.nodes(nodes_, Eigen::all);
        for (Eigen::Index m = 0; m < markers_.rows(); ++m)
            made_.set.markers.push_back({static_cast<int>(m), markers_.row(m), std::nullopt});
    }

    void describe() {
        identify::MeasurementSet& set = made_.set;
        set.states = made_.results.states;
        for (std::size_t s = 0; s < set.states.size(); ++s)
            set.states[s].readings =
                read_markers(set.states[s], markers_ + displacements_[s], options_.faults, options_.seed);
        for (LoadState& state : set.states)
            std::erase_if(state.readings, [](const identify::Reading& r) { return !r.position.allFinite(); });
        if (options_.faults.noise > 0) set.position_noise = options_.faults.noise;
        if (settings_.density) set.density = *settings_.density * fem::tonne_per_mm3;
        const double none = identify::missing;
        if (settings_.young || settings_.poisson)
            set.material = identify::MaterialGuess{settings_.young.value_or(none), settings_.poisson.value_or(none)};
        note_lost_moments();
    }

    /// A load that moves nothing is a slip.
    void note_lost_moments() {
        for (std::size_t s = 0; s < made_.set.states.size(); ++s) {
            const LoadState& state = made_.set.states[s];
            if (!state.contacts.empty() && displacements_[s].isZero(0))
                made_.notes.push_back(
                    fmt::format("Probe {} at time {:g} s presses on the body, and nothing moves: is its field that of "
                                "another state?",
                                state.probe, state.time));
        }
    }

    Case settings_;
    const ForeignOptions& options_;
    Progress progress_;
    ForeignSet made_;
    std::optional<mesh::Solution> now_;
    mesh::Solution first_;
    std::vector<char> stays_;  // a flag a node of the first mesh
    std::vector<int> nodes_;   // that are markers
    Points markers_;           // at rest (m x 3)
    std::vector<Points> displacements_;
};

}  // namespace

ForeignSet foreign_set(Case settings, const ForeignOptions& options, const Progress& progress) {
    return Maker(std::move(settings), options, progress).execute();
}

void write_foreign_set(const std::filesystem::path& folder, const ForeignSet& foreign) {
    identify::write_measurement_set(folder, foreign.set, [&](const std::filesystem::path& temporary) {
        std::optional<mesh::Solution> now;
        for (std::size_t s = 0; s < foreign.set.states.size(); ++s) {
            const FieldPlace& place = foreign.results.fields[s];
            if (!now || now->file != place.file) {
                now = foreign.results.read(place.file, foreign.array);
                scale(*now, foreign.unit);
            }
            const Points& all = place.in(*now).displacement;
            if (now->body.tetrahedra.rows() == 0 || !all.allFinite()) continue;
            mesh::write_vtu(temporary / identify::field_file(foreign.set.states[s]), now->body,
                            {.points = {{"displacement", Points(all(now->node_of_body, Eigen::all))}}});
        }
    });
}

}  // namespace palpate::pipeline
