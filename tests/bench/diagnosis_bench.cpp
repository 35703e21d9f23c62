// What the diagnosis makes of sets whose truth is known: success, wrong and inconclusive apart.
// Usage: diagnosis_bench FOLDER [--body reference|skeleton] [--ladder] [--threads N] [SET ...]
// FOLDER holds measurement sets and truth.csv (set, effect, ..., beyond_stiffness_rms_mm, sigma_mm, ...). A table in
// Markdown on standard output; without SET all of them.
//
// With --ladder what is named is added, and the skeleton's error told before and after, fitted and on held-out probes.
//
// Judged: right - the truth is named, or ambiguous with the truth among the first two; nothing hidden: adequate; an
// effect that the catalogue does not hold, or several at once: unexplained, or named in part. Wrong - an effect is
// named that is not there. Else inconclusive.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>

#include "identify/diagnose/ladder.h"
#include "identify/effects/catalogue.h"
#include "identify/models/skeleton_body.h"
#include "mesh/errors.h"
#include "pipeline/reference/body.h"
#include "pipeline/reference/reference_body.h"
#include "skeleton/build.h"

using namespace palpate;

namespace {

namespace fs = std::filesystem;

struct Truth {
    std::string set;
    std::vector<std::string> effects;  // empty: nothing is hidden
    double strength = 0;               // beyond what another stiffness does, over the noise
};

struct Options {
    fs::path folder;
    std::vector<std::string> sets;
    bool skeleton = false, ladder = false;
    int threads = 1;
};

Options parse(int argc, char** argv) {
    Options options;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        if (word == "--body" && i + 1 < argc) {
            options.skeleton = std::string(argv[++i]) == "skeleton";
        } else if (word == "--ladder") {
            options.ladder = true;
        } else if (word == "--threads" && i + 1 < argc) {
            options.threads = std::stoi(argv[++i]);
        } else if (options.folder.empty()) {
            options.folder = word;
        } else {
            options.sets.push_back(word);
        }
    }
    return options;
}

std::vector<std::string> split(const std::string& text, char at) {
    std::vector<std::string> words;
    std::stringstream in(text);
    for (std::string word; std::getline(in, word, at);) words.push_back(word);
    return words;
}

/// Names that other programs give to what the contract calls otherwise.
std::vector<std::string> effects_of(const std::string& name) {
    if (name.starts_with("none")) return {};
    if (name == "nearly-incompressible") return {"volume"};
    return split(name, '+');
}

std::vector<Truth> read_truth(const fs::path& folder) {
    std::ifstream in(folder / "truth.csv");
    if (!in) throw IoError(fmt::format("{} cannot be read", (folder / "truth.csv").string()));
    std::string line;
    std::getline(in, line);
    std::vector<Truth> truth;
    while (std::getline(in, line)) {
        const std::vector<std::string> cells = split(line, ',');
        truth.push_back({cells[0], effects_of(cells[1]), std::stod(cells[4]) / std::stod(cells[5])});
    }
    return truth;
}

bool is_known(const std::string& effect) {
    return std::ranges::any_of(identify::catalogue(), [&](const auto& e) { return e->name() == effect; });
}

enum Outcome { right, wrong, inconclusive };
constexpr const char* outcome_names[] = {"right", "WRONG", "inconclusive"};

Outcome judge(const Truth& truth, const identify::Diagnosis& found) {
    const auto is_true = [&](const std::string& name) {
        return std::ranges::find(truth.effects, name) != truth.effects.end();
    };
    const bool claims = found.verdict == identify::Verdict::missing_effect;
    if (claims && !std::ranges::all_of(found.explanation, is_true)) return wrong;
    if (truth.effects.empty()) return found.verdict == identify::Verdict::adequate ? right : inconclusive;
    if (claims) return right;
    if (found.verdict == identify::Verdict::ambiguous) {
        return std::any_of(found.ranking.begin(), found.ranking.begin() + 2,
                           [&](const auto& c) { return is_true(c.effect->name()); })
                   ? right
                   : wrong;
    }
    const bool can_be_named = truth.effects.size() == 1 && is_known(truth.effects.front());
    return !can_be_named && found.verdict == identify::Verdict::unexplained ? right : inconclusive;
}

/// The set's skeleton as it comes from the mesh, with nothing fitted.
skeleton::Model skeleton_of(const identify::MeasurementSet& set) {
    const pipeline::Body body = pipeline::make_body(set.rest_surface, {});
    fem::Material material;
    if (set.density) material.density = *set.density;
    return skeleton::build_skeleton(body.surface, body.volume, material, set.supports, {});
}

std::unique_ptr<identify::BodyModel> body_of(const identify::MeasurementSet& set, const Options& options) {
    if (options.skeleton) {
        return std::make_unique<identify::SkeletonBody>(skeleton_of(set), set.markers, fem::Material{}.young);
    }
    pipeline::Reference reference = pipeline::make_reference(set, 0);
    if (!reference.body) throw SolverFailure(reference.why_none);
    return std::move(reference.body);
}

/// "1.2 -> 0.1 mm (-92 %), held out 1.3 -> 0.2 mm; body 25 -> 1.0, held out 26 -> 1.1 times the noise"
std::string climbed(const identify::BodyModel& body, const identify::MeasurementSet& set,
                    const identify::Diagnosis& found, const Options& options) {
    identify::LadderOptions how;
    how.identify.threads = how.diagnose.refit.threads = options.threads;
    const identify::Ladder ladder =
        identify::climb(skeleton_of(set), options.skeleton ? nullptr : &body, set, found.explanation, how, &found);
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

std::string joined(const std::vector<std::string>& names) { return fmt::format("{}", fmt::join(names, " + ")); }

void run(const Options& options) {
    std::map<Outcome, int> counts;
    int nulls = 0, blamed = 0;
    fmt::print(
        "| set | hidden | strength | verdict | named | ln BF | whitened before | after | held out | law | s | |\n"
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
    for (const Truth& truth : read_truth(options.folder)) {
        const bool asked = options.sets.empty() || std::ranges::find(options.sets, truth.set) != options.sets.end();
        if (!asked) continue;
        const auto start = std::chrono::steady_clock::now();
        const std::string hidden = truth.effects.empty() ? "nothing" : joined(truth.effects);
        try {
            const identify::MeasurementSet set = identify::read_measurement_set(options.folder / truth.set);
            const auto body = body_of(set, options);
            identify::DiagnoseOptions how;
            how.refit.threads = options.threads;
            const identify::Diagnosis found = identify::diagnose(*body, set, how);
            const Outcome outcome = judge(truth, found);
            const identify::Candidate& first = found.ranking.front();
            const auto& held_out = first.held_out;
            const bool claimed = &found.best() != &found.baseline;
            fmt::print("| {} | {} | {:.1f} | {} | {} | {:.1f} | {:.2f} | {} | {} | {} | {:.0f} | {} |\n", truth.set,
                       hidden, truth.strength, identify::verdict_names[static_cast<std::size_t>(found.verdict)],
                       found.explanation.empty() ? "(" + first.effect->name() + ")" : joined(found.explanation),
                       first.log_bayes_factor, found.baseline.whitened_rms,
                       first.refit ? fmt::format("{:.2f}", first.refit->whitened_rms) : "",
                       held_out ? fmt::format("{:.2f}", held_out->whitened_rms) : "",
                       body->laws()[static_cast<std::size_t>(claimed ? found.law : found.baseline.explanation.law)],
                       std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
                       outcome_names[outcome]);
            if (options.ladder && !found.explanation.empty()) {
                fmt::print("| | | | | {} | | | | | | | |\n", climbed(*body, set, found, options));
            }
            ++counts[outcome];
            if (truth.effects.empty()) {
                ++nulls;
                blamed += found.explanation.empty() ? 0 : 1;
            }
        } catch (const std::exception& e) {
            fmt::print("| {} | {} | {:.1f} | failed: {} | | | | | | | | inconclusive |\n", truth.set, hidden,
                       truth.strength, e.what());
            ++counts[inconclusive];
        }
        std::cout << std::flush;
    }
    fmt::print("\n{}: {} right, {} wrong, {} inconclusive; {} of {} null sets blamed.\n",
               options.skeleton ? "The skeleton alone" : "The reference body", counts[right], counts[wrong],
               counts[inconclusive], blamed, nulls);
}

}  // namespace

int main(int argc, char** argv) {
    const Options options = parse(argc, argv);
    if (options.folder.empty()) {
        fmt::print(stderr,
                   "Usage: diagnosis_bench FOLDER [--body reference|skeleton] [--ladder] [--threads N] "
                   "[SET ...]\n");
        return 2;
    }
    try {
        run(options);
    } catch (const std::exception& e) {
        fmt::print(stderr, "{}\n", e.what());
        return 1;
    }
    return 0;
}
