// Where and what kind of thing is missing, whatever its name, on sets whose truth is known.
// Usage: locate_bench FOLDER [--threads N] [--coarser FACTOR] [SET ...]
// FOLDER holds measurement sets and truth.csv. A table in Markdown on standard output: only baselines are fitted, no
// effect of the catalogue is looked at. diagnosis/located.h tells what counts as right.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <iostream>

#include "diagnosis/located.h"
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

std::string number_or_nothing(const std::optional<double>& number, const char* unit) {
    return number ? fmt::format("{:.3g} {}", *number, unit) : "";
}

std::string row_of(const Truth& truth, const LocateOptions& options, LocatedTally& tally) {
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
    const double size = mesh::bounding_box(set.rest_surface.vertices).longest_side();
    tally.add(truth, source, size);
    if (!source) return fmt::format("| {} | {} | nothing located |\n", truth.set, joined(truth.effects));
    const auto& ln = source->log_bayes_factors;
    const Located right = judge_location(truth, *source, size);
    const char* verdict = truth.effects.empty() ? "" : right.kind ? "right" : "WRONG";
    const auto name = [](const auto& names, auto value) { return names[static_cast<std::size_t>(value)]; };
    return fmt::format(
        "| {} | {} | {:.2f} | {} | {} | {:.0f} {:.0f} {:.0f} {:.0f} | {:.0f} % | {} of {} | {}{} | {} | {} "
        "| {:.1f} | {} |\n",
        truth.set, joined(truth.effects), found.baseline.whitened_rms, name(identify::source_kind_names, source->kind),
        verdict, ln[0], ln[1], ln[2], ln[3], 100 * source->explained, source->states.size(), set.states.size(),
        name(identify::source_law_names, source->likeliest().law), right.law == false ? " WRONG" : "",
        number_or_nothing(right.place_mm, "mm"), number_or_nothing(right.angle, "degrees"), seconds,
        source->sentence());
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
               "| law | off by | turned by | s | sentence |\n"
               "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
        LocatedTally tally;
        for (const Truth& truth : read_truth(options.folder)) {
            if (!options.sets.empty() && std::ranges::find(options.sets, truth.set) == options.sets.end()) continue;
            std::cout << row_of(truth, options, tally) << std::flush;
        }
        tally.print();
    } catch (const std::exception& e) {
        fmt::print(stderr, "{}\n", e.what());
        return 1;
    }
    return 0;
}
