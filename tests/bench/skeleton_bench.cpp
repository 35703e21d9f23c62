// How well skeletons follow their bodies: fitted link by link to probes on finite elements, judged by other probes.
// Usage: skeleton_bench [--body NAME ...] [--spheres N ...] [--fit N] [--held-out N] [--skip-large] [--skip-coarse]
//                       [--threads N] [--meshes FOLDER] [--sets FOLDER] [--csv FILE]
// Writes two tables in markdown; --csv the same numbers in one. Errors are relative, |model - body| / |body| over all
// of the surface that is free, per cent: rms over probes, median, 90th percentile, and pooled at equal force.
// "linear": displacements of 0.5 % of the longest side, both linear. "large": of 5 %, neo-Hookean body, large
// rotations, half as many probes to fit to, two thirds to judge by. "coarse": quadratic tetrahedra in small strain with
// as many free nodes, E fitted.
// --sets keeps the bodies' answers there, and reads them where they are there already: they take most of the time.

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <iostream>
#include <optional>

#include "identify/measurements/measurement_set.h"
#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/analysis/quality/calibrated.h"
#include "pipeline/analysis/quality/graph.h"
#include "pipeline/analysis/quality/shape.h"
#include "pipeline/body/body.h"
#include "skeleton/bodies.h"
#include "skeleton/coarse.h"
#include "skeleton/construction/build.h"

using namespace palpate;

namespace {

namespace fs = std::filesystem;
using pipeline::ErrorSummary;
using pipeline::ProbedQuality;

struct Options {
    std::vector<std::string> bodies = bench::body_names();
    std::vector<int> spheres;  // free ones; empty: each body's own
    int fit = 48, held_out = 48, threads = 1;
    bool skip_large = false, skip_coarse = false;
    fs::path meshes = "../shared/data/meshes", sets, csv;
};

template <class Work>
double seconds(Work&& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// A line of the tables.
struct Row {
    std::string body;
    int triangles = 0, spheres = 0, held = 0;
    std::size_t links = 0;
    double seconds_build = 0, seconds_fit = 0, seconds_fit_large = 0;
    pipeline::ShapeQuality shape;
    pipeline::GraphQuality graph;
    ErrorSummary linear;
    std::optional<ErrorSummary> large;
    int overloaded_probes = 0;
    std::optional<bench::CoarseBody> coarse;
};

/// Reads the body's answers where they are kept; else has them computed, and keeps them where they are to be kept.
ProbedQuality probe(const bench::BenchBody& body, fem::MaterialLaw law, const Options& options) {
    const bool is_linear = law == fem::MaterialLaw::linear;
    const pipeline::QualityProbing probing{.law = law,
                                           .fit = is_linear ? options.fit : (options.fit + 1) / 2,
                                           .held_out = is_linear ? options.held_out : (2 * options.held_out + 2) / 3,
                                           .threads = options.threads};
    const fs::path folder = options.sets / fmt::format("{}-{}-{}-{}", body.name, is_linear ? "linear" : "large",
                                                       probing.fit, probing.held_out);
    if (!options.sets.empty() && fs::exists(folder / "held-out")) {
        ProbedQuality kept;
        kept.fit = identify::read_measurement_set(folder / "fit");
        kept.held_out = identify::read_measurement_set(folder / "held-out");
        return kept;
    }
    ProbedQuality probed;
    const double taken = seconds([&] { probed = pipeline::probe_for_quality(body.subject, probing); });
    std::cerr << fmt::format("{}: {} probes on {} nodes, {:.1f} s", body.name, is_linear ? "linear" : "large",
                             probed.nodes, taken)
              << std::endl;
    if (!options.sets.empty()) {
        identify::write_measurement_set(folder / "fit", probed.fit);
        identify::write_measurement_set(folder / "held-out", probed.held_out);
    }
    return probed;
}

int free_spheres(const skeleton::Model& model) {
    return static_cast<int>(std::ranges::count(model.spheres, false, &skeleton::Sphere::held));
}

Row measure(const bench::BenchBody& body, const pipeline::MeshedBody& mesh, const skeleton::Model& model,
            const ProbedQuality& linear, const ProbedQuality* large, const Options& options) {
    Row row;
    row.body = body.name;
    row.triangles = static_cast<int>(mesh.surface.triangles.rows());
    row.spheres = free_spheres(model);
    row.held = static_cast<int>(model.spheres.size()) - row.spheres;
    row.links = model.links.size();
    row.shape = pipeline::shape_quality(model);
    row.graph = pipeline::graph_quality(model);

    auto fitted = pipeline::calibrate_for_quality(model, linear, skeleton::EquilibriumLaw::linear, options.threads);
    row.linear = fitted.held_out;
    row.seconds_fit = fitted.seconds;
    if (large) {
        fitted =
            pipeline::calibrate_for_quality(model, *large, skeleton::EquilibriumLaw::large_rotation, options.threads);
        row.large = fitted.held_out;
        row.overloaded_probes = fitted.overloaded_probes;
        row.seconds_fit_large = fitted.seconds;
    }
    if (!options.skip_coarse) {
        try {
            row.coarse = bench::coarse_body(body.subject, linear, row.spheres);
        } catch (const std::runtime_error& failure) {
            std::cerr << fmt::format("{}: no coarse body: {}", body.name, failure.what()) << std::endl;
        }
    }
    std::cerr << fmt::format("{}: {} spheres, linear {:.1f} %, large {:.1f} %", body.name, row.spheres,
                             100 * row.linear.rms, row.large ? 100 * row.large->rms : NAN)
              << std::endl;
    return row;
}

std::vector<Row> measure_body(const std::string& name, const Options& options) {
    const bench::BenchBody body = bench::make_bench_body(name, options.meshes);
    const pipeline::MeshedBody mesh = pipeline::make_body(body.subject.surface, {});
    const ProbedQuality linear = probe(body, fem::MaterialLaw::linear, options);
    std::optional<ProbedQuality> large;
    if (!options.skip_large) large = probe(body, fem::MaterialLaw::neo_hookean, options);
    std::vector<Row> rows;
    for (const int spheres : options.spheres.empty() ? body.spheres : options.spheres) {
        try {
            skeleton::Model model;
            const double taken = seconds([&] {
                model = skeleton::build_skeleton(mesh.surface, mesh.volume, body.subject.material,
                                                 body.subject.supports, {.spheres = spheres});
            });
            if (std::ranges::count(rows, free_spheres(model), &Row::spheres) > 0) continue;  // as by default
            rows.push_back(measure(body, mesh, model, linear, large ? &*large : nullptr, options));
            rows.back().seconds_build = taken;
        } catch (const std::exception& e) {
            std::cerr << fmt::format("{}, {} spheres: left out: {}", name, spheres, e.what()) << std::endl;
        }
    }
    return rows;
}

std::string percents(const ErrorSummary& e) {
    return fmt::format("{:.2f} | {:.2f} | {:.2f} | {:.2f}", 100 * e.rms, 100 * e.median, 100 * e.p90, 100 * e.pooled);
}

void print(const std::vector<Row>& rows) {
    fmt::print(
        "| body | free spheres | held | links | triangles | seconds | coverage mm | % of size | covered % | outside % "
        "| "
        "parts | handles | links outside |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (const Row& r : rows) {
        fmt::print(
            "| {} | {} | {} | {} | {} | {:.2f} | {:.2f} | {:.1f} | {:.1f} | {:.1f} | {} of {} | {} of {} | {} |\n",
            r.body, r.spheres, r.held, r.links, r.triangles, r.seconds_build, r.shape.coverage,
            100 * r.shape.coverage_share, 100 * r.shape.covered, 100 * r.shape.outside, r.graph.parts,
            r.graph.body_parts, r.graph.handles, r.graph.body_handles, r.graph.links_outside);
    }
    fmt::print(
        "\n| body | free spheres | linear rms % | median | p90 | pooled | fit s | large rms % | median | p90 | pooled "
        "| "
        "fit s | not borne | coarse nodes | linear rms % | median | p90 | pooled |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    const std::string none = "- | - | - | -";
    for (const Row& r : rows) {
        fmt::print("| {} | {} | {} | {:.1f} | {} | {:.1f} | {} | {} | {} |\n", r.body, r.spheres, percents(r.linear),
                   r.seconds_fit, r.large ? percents(*r.large) : none, r.seconds_fit_large, r.overloaded_probes,
                   r.coarse ? std::to_string(r.coarse->free_nodes) : "-",
                   r.coarse ? percents(r.coarse->held_out) : none);
    }
    std::fflush(stdout);
}

/// An empty cell: not measured.
std::string cells(const std::optional<ErrorSummary>& e) {
    return e ? fmt::format(",{:.5g},{:.5g},{:.5g},{:.5g}", e->rms, e->median, e->p90, e->pooled) : ",,,,";
}

std::string csv(const std::vector<Row>& rows) {
    std::string text =
        "body,spheres,held,links,triangles,seconds_build,coverage_mm,coverage_share,covered,outside,parts,body_parts,"
        "handles,body_handles,links_outside,seconds_fit,seconds_fit_large,linear_rms,linear_median,linear_p90,"
        "linear_pooled,large_rms,large_median,large_p90,large_pooled,not_borne,coarse_nodes,coarse_rms,coarse_median,"
        "coarse_p90,coarse_pooled\n";
    for (const Row& r : rows) {
        text += fmt::format("{},{},{},{},{},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{},{},{},{},{},{:.4g},{:.4g}", r.body,
                            r.spheres, r.held, r.links, r.triangles, r.seconds_build, r.shape.coverage,
                            r.shape.coverage_share, r.shape.covered, r.shape.outside, r.graph.parts, r.graph.body_parts,
                            r.graph.handles, r.graph.body_handles, r.graph.links_outside, r.seconds_fit,
                            r.seconds_fit_large);
        text += cells(r.linear) + cells(r.large) + fmt::format(",{},", r.overloaded_probes);
        if (r.coarse) text += std::to_string(r.coarse->free_nodes);
        text += cells(r.coarse ? std::optional(r.coarse->held_out) : std::nullopt) + "\n";
    }
    return text;
}

void run(const Options& options) {
    std::vector<Row> rows;
    for (const std::string& name : options.bodies) {
        const std::vector<Row> more = measure_body(name, options);
        rows.insert(rows.end(), more.begin(), more.end());
    }
    print(rows);
    if (!options.csv.empty()) mesh::write_text(options.csv, csv(rows));
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    std::vector<std::string> bodies;
    CLI::App app("How well skeletons follow their bodies");
    app.add_option("--body", bodies, "Which, again and again; all by default")
        ->check(CLI::IsMember(bench::body_names()));
    app.add_option("--spheres", options.spheres,
                   "Free spheres, again and again; each body's own by default, 0: as "
                   "many as without this option")
        ->check(CLI::NonNegativeNumber);
    app.add_option("--fit", options.fit, "Probes to fit to")->check(CLI::PositiveNumber);
    app.add_option("--held-out", options.held_out, "Other probes to judge by")->check(CLI::PositiveNumber);
    app.add_flag("--skip-large", options.skip_large, "No large deformation");
    app.add_flag("--skip-coarse", options.skip_coarse, "No coarse finite elements to compare with");
    app.add_option("--threads", options.threads)->check(CLI::PositiveNumber);
    app.add_option("--meshes", options.meshes, "Folder with liver2.obj, starfish.stl and idler_riser.STL");
    app.add_option("--sets", options.sets, "Folder to keep the bodies' answers in");
    app.add_option("--csv", options.csv, "File to write all numbers to");
    CLI11_PARSE(app, argc, argv);
    if (!bodies.empty()) options.bodies = bodies;
    try {
        run(options);
    } catch (const std::exception& e) {
        fmt::print(stderr, "{}\n", e.what());
        return 1;
    }
    return 0;
}
