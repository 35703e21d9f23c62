// What the diagnosis makes of sets whose truth is known: success, wrong and inconclusive apart.
// Usage: diagnosis_bench FOLDER [--jobs N] [--threads N] [--body reference|skeleton] [--without EFFECT] [--ablate PART]
//                        [--coarser FACTOR] [--ladder] [--tell] [SET ...]
// FOLDER holds measurement sets and truth.csv (set, effect, ..., beyond_stiffness_rms_mm, sigma_mm, ...), and
// truth/<set>.json where the numbers are known too. Tables in Markdown on standard output; without SET all of them.
// Seconds are those that the set's first thread takes of a processor: all of them with --threads 1, the default.
//
// --coarser makes the elements of the body so much longer, for many sets in little time.
// --ladder adds what is named, and tells the skeleton's error before and after, fitted and on held-out probes.
// --tell lists all that was screened and fitted, with its numbers; on standard error what goes on.
// --ablate leaves a part of the method out, to show what it is for: "whitening" (contacts and clamps are taken at their
// word), "mesh-error" (so is the body next to them), "correction" (of the mesh by halved edges), "gates" (whatever has
// evidence is claimed, the likeliest first).
// "--body skeleton" does without the reference body.

#include <fmt/format.h>
#include <malloc.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <ctime>
#include <iostream>
#include <map>
#include <mutex>

#include "diagnosis/tally.h"
#include "identify/diagnosis/diagnose.h"
#include "identify/diagnosis/ladder/ladder.h"
#include "identify/diagnosis/verdict/verdict.h"
#include "identify/effects/catalogue.h"
#include "identify/models/skeleton/skeleton_body.h"
#include "identify/numerics/parallel.h"
#include "mesh/errors.h"
#include "pipeline/body/body.h"
#include "pipeline/body/reference_body.h"
#include "skeleton/construction/build.h"

using namespace palpate;
using namespace palpate::bench;

namespace {

namespace fs = std::filesystem;

struct Options {
    fs::path folder;
    std::vector<std::string> sets;
    std::vector<std::string> without;
    std::vector<std::string> ablations;
    bool skeleton = false, ladder = false, tell = false;
    int threads = 1, jobs = 1;
    double coarser = 1;
};

/// The method without some of its parts.
identify::DiagnoseOptions ablated(const std::vector<std::string>& parts) {
    identify::DiagnoseOptions options;
    constexpr double none = 1e-6;
    identify::NuisanceOptions& nuisances = options.refit.nuisances;
    for (const std::string& part : parts) {
        if (part == "whitening") {
            nuisances = {.shift = none,
                         .radius = none,
                         .softness = none,
                         .clamp = none,
                         .gain_at_support = none,
                         .dent = none,
                         .wall_dent = none,
                         .ragged = none,
                         .flow = none};
        } else if (part == "mesh-error") {
            nuisances.softness = nuisances.clamp = nuisances.ragged = nuisances.flow = none;
            nuisances.dent = nuisances.wall_dent = none;
            options.mesh_error = 0;
            options.refit.correct_for_mesh = false;
        } else if (part == "correction") {
            options.refit.correct_for_mesh = false;
        } else if (part == "gates") {
            options.least_lead = 0;
            options.noise_accuracy = options.most_pull = INFINITY;
        }
    }
    return options;
}

/// The set's skeleton as it comes from the mesh, with nothing fitted.
skeleton::Model skeleton_of(const identify::MeasurementSet& set) {
    const pipeline::MeshedBody body = pipeline::make_body(set.rest_surface, {});
    fem::Material material;
    if (set.density) material.density = *set.density;
    return skeleton::build_skeleton(body.surface, body.volume, material, set.supports, {});
}

std::unique_ptr<identify::BodyModel> body_of(const identify::MeasurementSet& set, const Options& options) {
    if (options.skeleton) {
        return std::make_unique<identify::SkeletonBody>(skeleton_of(set), set.markers, fem::Material{}.young);
    }
    const double edge = options.coarser == 1 ? 0 : options.coarser * pipeline::reference_edge_length(set.rest_surface);
    pipeline::Reference reference = pipeline::make_reference(set, edge);
    if (!reference.body) throw SolverFailure(reference.why_none);
    return std::move(reference.body);
}

/// "1.2 -> 0.1 mm (-92 %), held out 1.3 -> 0.2 mm; body 25 -> 1.0, held out 26 -> 1.1 times the noise"
std::string errors_of_steps(const identify::BodyModel& body, const identify::MeasurementSet& set,
                            const identify::Diagnosis& found, const Options& options) {
    identify::LadderOptions how;
    how.identify.threads = how.diagnose.refit.threads = options.threads;
    const identify::Ladder ladder = identify::build_ladder(skeleton_of(set), body, set, found.explanation, how, &found);
    const identify::LadderStep &first = ladder.steps.front(), &last = ladder.steps.back();
    const std::string skeleton = fmt::format(
        "{:.3f} -> {:.3f} mm ({:+.0f} %), held out {:.3f} -> {:.3f} mm ({:+.0f} %)", first.skeleton.rms_mm,
        last.skeleton.rms_mm, 100 * (last.skeleton.rms_mm / first.skeleton.rms_mm - 1), first.skeleton.held_out_rms_mm,
        last.skeleton.held_out_rms_mm, 100 * (last.skeleton.held_out_rms_mm / first.skeleton.held_out_rms_mm - 1));
    if (!last.reference) return skeleton;
    return skeleton + fmt::format("; body {:.2f} -> {:.2f}, held out {:.2f} -> {:.2f}", first.reference->whitened_rms,
                                  last.reference->whitened_rms, first.reference->held_out_whitened_rms,
                                  last.reference->held_out_whitened_rms);
}

std::string estimate(const identify::FittedExplanation& explained) {
    std::string text;
    std::map<std::string, int> before;  // of the same name
    for (const auto& effect : explained.effects) {
        const identify::EffectEstimate numbers = explained.estimate(effect->name(), before[effect->name()]++);
        text += (text.empty() ? "" : "; ") + effect->name();
        for (std::size_t p = 0; p < numbers.effect.parameters.size(); ++p) {
            const skeleton::EffectParameter& one = numbers.effect.parameters[p];
            text += fmt::format(" {} {:.4g}+-{:.2g}", one.name, one.value, numbers.sd[p]);
        }
    }
    return text;
}

std::string estimate(const identify::Diagnosis& found, const identify::DiagnoseOptions& how) {
    std::string text = "    screened:";
    for (const identify::Candidate& c : found.ranking) text += fmt::format(" {} {:.1f}", c.effect->name(), c.screened);
    const identify::Problem& problem = found.problem;
    text +=
        fmt::format("\n    displacement {:.0f} sigmas in all, error of the mesh {:.1f}\n",
                    problem.displacement().cwiseQuotient(problem.sigma).norm(),
                    problem.discretisation.size() > 0 ? problem.discretisation.cwiseQuotient(problem.sigma).norm() : 0);
    for (const identify::FittedExplanation& one : found.tried) {
        const std::string asked =
            one.effects.size() == 1
                ? fmt::format(" (next to noise {:.0f})", identify::least_next_to_noise(one, problem, how))
                : "";
        text += fmt::format(
            "    ln BF {:.1f}{}, {:.3f} left, {:.2f} held out, strain {:.1f} ({}), law {}, {} "
            "steps: {}{}\n",
            one.log_bayes_factor, asked, one.fit.whitened_rms, one.held_out.whitened_rms, one.fit.nuisance_pull,
            one.fit.most_pulled_nuisance, one.fit.explanation.law, one.fit.steps, estimate(one),
            one.objection.empty() ? "" : " (" + one.objection + ")");
    }
    return text;
}

/// What this thread has taken of a processor [s]: what other programs do at the same time is not in it.
double processor_seconds() {
    timespec taken{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &taken);
    return static_cast<double>(taken.tv_sec) + 1e-9 * static_cast<double>(taken.tv_nsec);
}

/// A set's row of the table, and what follows it.
std::string diagnosed(const Truth& truth, const Options& options, Tally& tally) {
    const double start = processor_seconds();
    const auto seconds = [&] { return processor_seconds() - start; };
    std::string text;
    try {
        const identify::MeasurementSet set = identify::read_measurement_set(options.folder / truth.set);
        const auto body = body_of(set, options);
        identify::DiagnoseOptions how = ablated(options.ablations);
        how.refit.threads = options.threads;
        how.without = options.without;
        Progress progress;
        if (options.tell) {
            progress = [&](std::string_view what, double) {
                fmt::print(stderr, "{} {:6.1f} s {}\n", truth.set, seconds(), what);
            };
        }
        const identify::Diagnosis found = identify::diagnose(*body, set, how, progress);
        const Outcome outcome = judge(truth, found, options.without);
        const identify::Candidate& first = found.ranking.front();
        const bool claimed = found.explained.has_value();
        text = fmt::format(
            "| {} | {} | {:.1f} | {} | {} | {:.1f} | {:.2f} | {:.2f} | {} | {} | {:.0f} | {} |\n", truth.set,
            joined(truth.effects), truth.strength, identify::verdict_names[static_cast<std::size_t>(found.verdict)],
            found.explanation.empty() ? "(" + first.effect->name() + ")" : joined(found.explanation),
            claimed ? found.explained->log_bayes_factor : first.log_bayes_factor, found.baseline.whitened_rms,
            found.best().whitened_rms, claimed ? fmt::format("{:.2f}", found.explained->held_out.whitened_rms) : "",
            body->laws()[static_cast<std::size_t>(claimed ? found.law : found.baseline.explanation.law)], seconds(),
            outcome_names[static_cast<std::size_t>(outcome)]);
        if (options.tell) text += estimate(found, how);
        if (options.ladder && !found.explanation.empty()) {
            text += fmt::format("| | | | | {} | | | | | | | |\n", errors_of_steps(*body, set, found, options));
        }
        tally.add(truth, found, outcome, identify::material_of(*body, found.best()));
        tally.add_seconds(seconds());
    } catch (const std::exception& e) {
        text += fmt::format("| {} | {} | {:.1f} | failed: {} | | | | | | | {:.0f} | inconclusive |\n", truth.set,
                            joined(truth.effects), truth.strength, e.what(), seconds());
        tally.add_failure();
    }
    return text;
}

void run(const Options& options) {
    std::vector<Truth> truths = read_truth(options.folder);
    if (!options.sets.empty()) {
        std::erase_if(truths, [&](const Truth& truth) {
            return std::ranges::find(options.sets, truth.set) == options.sets.end();
        });
    }
    fmt::print(
        "| set | hidden | strength | verdict | named | ln BF | whitened before | after | held out | law | s | |\n"
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
    std::mutex telling;
    Tally tally;
    identify::for_each_in_parallel(static_cast<int>(truths.size()), options.jobs, [&](int i) {
        Tally own;
        const std::string text = diagnosed(truths[i], options, own);
        const std::scoped_lock lock(telling);
        std::cout << text << std::flush;
        tally.add(own);
    });
    tally.print();
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    std::string body = "reference";
    CLI::App app("What the diagnosis makes of sets whose truth is known");
    app.add_option("FOLDER", options.folder, "Measurement sets and truth.csv")->required();
    app.add_option("SET", options.sets, "Which of them; all by default");
    app.add_option("--jobs", options.jobs, "Sets at once")->check(CLI::PositiveNumber);
    app.add_option("--threads", options.threads, "Threads for each")->check(CLI::PositiveNumber);
    app.add_option("--body", body, "What the errors are judged on")->check(CLI::IsMember({"reference", "skeleton"}));
    app.add_option("--without", options.without, "An effect to leave out of the catalogue")->expected(1)->take_all();
    app.add_option("--ablate", options.ablations, "A part to leave out of the method")
        ->expected(1)
        ->take_all()
        ->check(CLI::IsMember({"whitening", "mesh-error", "correction", "gates"}));
    app.add_option("--coarser", options.coarser, "Elements so much longer")->check(CLI::PositiveNumber);
    app.add_flag("--ladder", options.ladder, "Add what is named");
    app.add_flag("--tell", options.tell, "All that was screened and fitted");
    CLI11_PARSE(app, argc, argv);
    options.skeleton = body == "skeleton";
    // as the program does: matrices of some MB come and go
    mallopt(M_MMAP_THRESHOLD, 256 << 20);
    mallopt(M_TRIM_THRESHOLD, 512 << 20);
    try {
        run(options);
    } catch (const std::exception& e) {
        fmt::print(stderr, "{}\n", e.what());
        return 1;
    }
    return 0;
}
