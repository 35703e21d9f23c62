// Where and what kind of thing is missing, whatever its name, on sets whose truth is known.
// Usage: locate_bench FOLDER [--threads N] [--coarser FACTOR] [SET ...]
// FOLDER holds measurement sets and truth.csv. A table in Markdown on standard output: only baselines are fitted, no
// effect of the catalogue is looked at. `kind` is right where it is what the hidden effect is: gravity and prestress
// are forces in the body; contact, pressure and compliant supports act at its boundary; faults of readings and gains
// are the sensors'; all others change its stiffness.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <iostream>
#include <set>

#include "diagnosis/tally.h"
#include "diagnosis/truth.h"
#include "identify/diagnosis/diagnose.h"
#include "identify/diagnosis/locate/locate.h"
#include "pipeline/body/body.h"
#include "pipeline/body/reference_body.h"

using namespace palpate;
using namespace palpate::bench;

namespace {

namespace fs = std::filesystem;

struct LocateOptions {
    fs::path folder;
    std::vector<std::string> sets;
    int threads = 1;
    double coarser = 1;
};

identify::SourceKind kind_of(const std::string& effect) {
    static const std::set<std::string> forces{"gravity", "prestress", "swelling"};
    static const std::set<std::string> boundary{"contact", "pressure", "compliant-support", "friction"};
    static const std::set<std::string> sensor{"misalignment", "outliers",       "force-gain",
                                              "slip",         "actuation-gain", "clock"};
    if (forces.contains(effect)) return identify::SourceKind::body_force;
    if (boundary.contains(effect)) return identify::SourceKind::boundary;
    return sensor.contains(effect) ? identify::SourceKind::sensor : identify::SourceKind::stiffness;
}

bool is_right(const Truth& truth, identify::SourceKind kind) {
    return std::ranges::any_of(truth.effects, [&](const std::string& effect) { return kind_of(effect) == kind; });
}

std::string row_of(const Truth& truth, const LocateOptions& options) {
    const identify::MeasurementSet set = identify::read_measurement_set(options.folder / truth.set);
    const double edge = options.coarser == 1 ? 0 : options.coarser * pipeline::reference_edge_length(set.rest_surface);
    const pipeline::Reference reference = pipeline::make_reference(set, edge);
    if (!reference.body) throw SolverFailure(reference.why_none);
    identify::DiagnoseOptions how;
    how.refit.threads = options.threads;
    how.screen = false;
    const identify::Diagnosis found = identify::diagnose(*reference.body, set, how);
    const auto start = std::chrono::steady_clock::now();
    const auto source = identify::locate_missing(*reference.body, found.problem, found.baseline, options.threads);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (!source) return fmt::format("| {} | {} | nothing located |\n", truth.set, joined(truth.effects));
    const auto& ln = source->log_bayes_factors;
    const char* verdict = truth.effects.empty() ? "" : is_right(truth, source->kind) ? "right" : "WRONG";
    return fmt::format(
        "| {} | {} | {:.2f} | {} | {} | {:.0f} {:.0f} {:.0f} {:.0f} | {:.0f} % | {} of {} | {:.1f} | {} |\n", truth.set,
        joined(truth.effects), found.baseline.whitened_rms,
        identify::source_kind_names[static_cast<std::size_t>(source->kind)], verdict, ln[0], ln[1], ln[2], ln[3],
        100 * source->explained, source->states.size(), set.states.size(), seconds, source->sentence());
}

}  // namespace

int main(int argc, char** argv) {
    LocateOptions options;
    CLI::App app("Where and what kind of thing is missing, on sets whose truth is known");
    app.add_option("FOLDER", options.folder, "Measurement sets and truth.csv")->required();
    app.add_option("SET", options.sets, "Which of them; all by default");
    app.add_option("--threads", options.threads, "Threads")->check(CLI::PositiveNumber);
    app.add_option("--coarser", options.coarser, "Elements so much longer")->check(CLI::PositiveNumber);
    CLI11_PARSE(app, argc, argv);
    try {
        std::cout
            << "| set | hidden | whitened | kind | | ln BF body, stiffness, boundary, sensor | explained | states "
               "| s | sentence |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
        for (const Truth& truth : read_truth(options.folder)) {
            if (!options.sets.empty() && std::ranges::find(options.sets, truth.set) == options.sets.end()) continue;
            std::cout << row_of(truth, options) << std::flush;
        }
    } catch (const std::exception& e) {
        fmt::print(stderr, "{}\n", e.what());
        return 1;
    }
    return 0;
}
