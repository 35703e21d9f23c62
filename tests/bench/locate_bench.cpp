// Where and what kind of thing is missing, whatever its name, on sets whose truth is known.
// Usage: locate_bench FOLDER [--omit] [--rivals] [--jobs N] [--threads N] [--coarser FACTOR] [SET ...]
// FOLDER holds measurement sets and truth.csv. A table in Markdown on standard output: only baselines are fitted, no
// effect of the catalogue is looked at. diagnosis/located.h tells what counts as right.
//
// --omit leaves what is hidden out of the catalogue and diagnoses each set with what remains of it, as a program does
// that does not know the effect. Held-out errors: without and with the residual that `improve --residual` would add.
// --rivals lists the likeliest source of each form and law below a set's row.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <mutex>

#include "diagnosis/located.h"
#include "diagnosis/tally.h"
#include "diagnosis/truth.h"
#include "identify/diagnosis/diagnose.h"
#include "identify/diagnosis/locate/locate.h"
#include "identify/diagnosis/locate/residual.h"
#include "identify/numerics/parallel.h"
#include "mesh/errors.h"
#include "pipeline/body/body.h"
#include "pipeline/body/reference_body.h"

using namespace palpate;
using namespace palpate::bench;

namespace {

namespace fs = std::filesystem;

struct LocateOptions {
    fs::path folder;
    std::vector<std::string> sets;
    bool omit = false, rivals = false;
    int threads = 1, jobs = 1;
    double coarser = 1;
};

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::string number_or_nothing(const std::optional<double>& number, const char* unit) {
    return number ? fmt::format("{:.3g} {}", *number, unit) : "";
}

/// What a model without the hidden effect is left with, and how long it took to locate that.
struct Found {
    identify::Diagnosis diagnosis = {};
    std::optional<identify::MissingSource> source = {};
    double seconds = 0;                // beyond the baseline; with --omit the whole diagnosis
    double before = NAN, after = NAN;  // held-out readings without and with the residual, in sigmas
};

Found locate(const identify::BodyModel& body, const identify::MeasurementSet& set, const Truth& truth,
             const LocateOptions& options) {
    identify::DiagnoseOptions how;
    how.refit.threads = options.threads;
    how.screen = options.omit;
    if (options.omit) how.without = truth.effects;
    auto start = std::chrono::steady_clock::now();
    Found found{.diagnosis = identify::diagnose(body, set, how)};
    const identify::Diagnosis& diagnosis = found.diagnosis;
    if (!options.omit) {
        start = std::chrono::steady_clock::now();
        found.source = identify::locate_missing(body, diagnosis.problem, diagnosis.baseline, options.threads);
    } else {
        found.source = diagnosis.missing;
    }
    found.seconds = seconds_since(start);
    if (!options.omit || diagnosis.verdict == identify::Verdict::adequate) return found;
    found.before = identify::leave_probes_out(diagnosis.problem, diagnosis.best()).whitened_rms;
    const auto residual = identify::find_residual(body, diagnosis, how);
    if (residual && residual->fit)
        found.after = identify::leave_probes_out(diagnosis.problem, *residual->fit).whitened_rms;
    return found;
}

std::string rivals_of(const identify::MissingSource& source) {
    constexpr std::size_t told = 15;
    std::string text;
    for (std::size_t i = 0; i < std::min(told, source.rivals.size()); ++i) {
        const identify::MissingSource::Rival& rival = source.rivals[i];
        identify::MissingSource alone{.kind = rival.kind, .terms = {rival.term}, .at = rival.term.centre};
        alone.spread = rival.term.extent;
        if (is_vector(rival.term.form)) alone.direction = rival.term.mean.head<3>().normalized();
        text += fmt::format("    {:.1f} {}, {}: {}\n", rival.log_weight,
                            identify::source_kind_names[static_cast<std::size_t>(rival.kind)],
                            identify::source_law_names[static_cast<std::size_t>(rival.term.law)], alone.sentence());
    }
    return text;
}

std::string row_of(const Truth& truth, const LocateOptions& options, LocatedTally& tally) {
    const identify::MeasurementSet set = identify::read_measurement_set(options.folder / truth.set);
    const double edge = options.coarser == 1 ? 0 : options.coarser * pipeline::reference_edge_length(set.rest_surface);
    const pipeline::Reference reference = pipeline::make_reference(set, edge);
    if (!reference.body) throw SolverFailure(reference.why_none);
    const Found found = locate(*reference.body, set, truth, options);
    const identify::Diagnosis& diagnosis = found.diagnosis;
    const double size = mesh::bounding_box(set.rest_surface.vertices).longest_side();
    tally.add(truth, found.source, size);
    if (options.omit) tally.add_held_out(truth, found.before, found.after);
    std::string row = fmt::format("| {} | {} |", truth.set, joined(truth.effects));
    if (options.omit) {
        row += fmt::format(" {} {} | {:.2f} -> {:.2f} |",
                           identify::verdict_names[static_cast<std::size_t>(diagnosis.verdict)],
                           joined(diagnosis.explanation), found.before, found.after);
    }
    if (!found.source) return row + " nothing located |\n";
    const identify::MissingSource& source = *found.source;
    const auto& ln = source.log_bayes_factors;
    const Located right = judge_location(truth, source, size);
    const char* verdict = truth.effects.empty() ? "" : right.kind ? "right" : "WRONG";
    const auto name = [](const auto& names, auto value) { return names[static_cast<std::size_t>(value)]; };
    row += fmt::format(
        " {:.2f} | {} | {} | {:.0f} {:.0f} {:.0f} {:.0f} | {:.0f} % | {} of {} | {}{} | {} | {} "
        "| {:.1f} | {} |\n",
        diagnosis.baseline.whitened_rms, name(identify::source_kind_names, source.kind), verdict, ln[0], ln[1], ln[2],
        ln[3], 100 * source.explained, source.states.size(), set.states.size(),
        name(identify::source_law_names, source.likeliest().law), right.law == false ? " WRONG" : "",
        number_or_nothing(right.place_mm, "mm"), number_or_nothing(right.angle, "degrees"), found.seconds,
        source.sentence());
    return options.rivals ? row + rivals_of(source) : row;
}

void run(const LocateOptions& options) {
    std::vector<Truth> truths = read_truth(options.folder);
    if (!options.sets.empty()) {
        std::erase_if(truths, [&](const Truth& truth) {
            return std::ranges::find(options.sets, truth.set) == options.sets.end();
        });
    }
    fmt::print(
        "| set | hidden |{} whitened | kind | | ln BF body, stiffness, boundary, sensor | explained | states | "
        "law | off by | turned by | s | sentence |\n",
        options.omit ? " verdict | held out |" : "");
    fmt::print("|{}\n", [&] {
        std::string rules;
        for (int column = 0; column < (options.omit ? 15 : 13); ++column) rules += " --- |";
        return rules;
    }());
    LocatedTally tally;
    std::mutex telling;
    identify::for_each_in_parallel(static_cast<int>(truths.size()), options.jobs, [&](int i) {
        LocatedTally own;
        std::string row;
        try {
            row = row_of(truths[i], options, own);
        } catch (const std::exception& e) {
            row = fmt::format("| {} | {} | failed: {} |\n", truths[i].set, joined(truths[i].effects), e.what());
        }
        const std::scoped_lock lock(telling);
        std::cout << row << std::flush;
        tally.add(own);
    });
    tally.print();
}

}  // namespace

int main(int argc, char** argv) {
    LocateOptions options;
    CLI::App app("Where and what kind of thing is missing, on sets whose truth is known");
    app.add_option("FOLDER", options.folder, "Measurement sets and truth.csv")->required();
    app.add_option("SET", options.sets, "Which of them; all by default");
    app.add_flag("--omit", options.omit, "Diagnose with a catalogue that lacks what is hidden");
    app.add_flag("--rivals", options.rivals, "The likeliest source of each form and law");
    app.add_option("--jobs", options.jobs, "Sets at once")->check(CLI::PositiveNumber);
    app.add_option("--threads", options.threads, "Threads")->check(CLI::PositiveNumber);
    app.add_option("--coarser", options.coarser, "Elements so much longer")->check(CLI::PositiveNumber);
    CLI11_PARSE(app, argc, argv);
    try {
        run(options);
    } catch (const std::exception& e) {
        fmt::print(stderr, "{}\n", e.what());
        return 1;
    }
    return 0;
}
