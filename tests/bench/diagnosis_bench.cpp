// What the diagnosis makes of sets whose truth is known: success, wrong and inconclusive apart.
// Usage: diagnosis_bench FOLDER [--body reference|skeleton] [--ladder] [--tell] [--without EFFECT] [--threads N] [SET
// ...] FOLDER holds measurement sets and truth.csv (set, effect, ..., beyond_stiffness_rms_mm, sigma_mm, ...). A table
// in Markdown on standard output; without SET all of them.
//
// With --ladder what is named is added, and the skeleton's error told before and after, fitted and on held-out probes.
//
// With --tell all that was screened and fitted follows each line, with its numbers.
//
// Judged: right - all that is hidden is named, or ambiguous with a hidden effect among the first two; nothing hidden:
// adequate; where the truth was left out of the catalogue: unexplained. In part - one of several is named. Wrong - an
// effect is named that is not there. Else inconclusive.

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
    std::vector<std::string> without;
    bool skeleton = false, ladder = false, tell = false;
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
        } else if (word == "--tell") {
            options.tell = true;
        } else if (word == "--without" && i + 1 < argc) {
            options.without.emplace_back(argv[++i]);
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

enum Outcome { right, in_part, wrong, inconclusive };
constexpr const char* outcome_names[] = {"right", "in part", "WRONG", "inconclusive"};

Outcome judge(const Truth& truth, const identify::Diagnosis& found, const std::vector<std::string>& without) {
    const auto is_true = [&](const std::string& name) {
        return std::ranges::find(truth.effects, name) != truth.effects.end();
    };
    const bool claims = found.verdict == identify::Verdict::missing_effect;
    if (claims && !std::ranges::all_of(found.explanation, is_true)) return wrong;
    if (truth.effects.empty()) return found.verdict == identify::Verdict::adequate ? right : inconclusive;
    const auto is_named = [&](const std::string& name) {
        return std::ranges::find(found.explanation, name) != found.explanation.end();
    };
    if (claims) return std::ranges::all_of(truth.effects, is_named) ? right : in_part;
    if (found.verdict == identify::Verdict::ambiguous) {
        return std::any_of(found.ranking.begin(), found.ranking.begin() + 2,
                           [&](const auto& c) { return is_true(c.effect->name()); })
                   ? right
                   : wrong;
    }
    const bool left_out = std::ranges::any_of(without, is_true);
    return left_out && found.verdict == identify::Verdict::unexplained ? right : inconclusive;
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

std::string told(const identify::Explained& explained) {
    std::string text;
    for (const auto& effect : explained.effects) {
        const identify::Told numbers = explained.told(effect->name());
        text += (text.empty() ? "" : "; ") + effect->name();
        for (std::size_t p = 0; p < numbers.effect.parameters.size(); ++p) {
            const skeleton::EffectParameter& one = numbers.effect.parameters[p];
            text += fmt::format(" {} {:.4g}+-{:.2g}", one.name, one.value, numbers.sd[p]);
        }
    }
    return text;
}

void tell(const identify::Diagnosis& found) {
    std::string screened;
    for (const identify::Candidate& c : found.ranking)
        screened += fmt::format(" {} {:.1f}", c.effect->name(), c.screened);
    fmt::print("    screened:{}\n", screened);
    for (const identify::Explained& one : found.tried) {
        fmt::print("    ln BF {:.1f}, {:.3f} left, {:.2f} held out, strain {:.1f}, law {}, {} steps: {}{}\n",
                   one.log_bayes_factor, one.fit.whitened_rms, one.held_out.whitened_rms, one.fit.strain,
                   one.fit.explanation.law, one.fit.steps, told(one),
                   one.objection.empty() ? "" : " (" + one.objection + ")");
    }
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
            how.without = options.without;
            Progress progress;
            if (options.tell) {
                progress = [&](std::string_view what, double) {
                    const auto now = std::chrono::steady_clock::now();
                    fmt::print("    {:6.1f} s {}\n", std::chrono::duration<double>(now - start).count(), what);
                };
            }
            const identify::Diagnosis found = identify::diagnose(*body, set, how, progress);
            const Outcome outcome = judge(truth, found, options.without);
            const identify::Candidate& first = found.ranking.front();
            const bool claimed = found.explained.has_value();
            fmt::print("| {} | {} | {:.1f} | {} | {} | {:.1f} | {:.2f} | {} | {} | {} | {:.0f} | {} |\n", truth.set,
                       hidden, truth.strength, identify::verdict_names[static_cast<std::size_t>(found.verdict)],
                       found.explanation.empty() ? "(" + first.effect->name() + ")" : joined(found.explanation),
                       claimed ? found.explained->log_bayes_factor : first.log_bayes_factor,
                       found.baseline.whitened_rms, fmt::format("{:.2f}", found.best().whitened_rms),
                       claimed ? fmt::format("{:.2f}", found.explained->held_out.whitened_rms) : "",
                       body->laws()[static_cast<std::size_t>(claimed ? found.law : found.baseline.explanation.law)],
                       std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
                       outcome_names[outcome]);
            if (options.tell) tell(found);
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
    fmt::print("\n{}: {} right, {} in part, {} wrong, {} inconclusive; {} of {} null sets blamed.\n",
               options.skeleton ? "The skeleton alone" : "The reference body", counts[right], counts[in_part],
               counts[wrong], counts[inconclusive], blamed, nulls);
}

}  // namespace

int main(int argc, char** argv) {
    const Options options = parse(argc, argv);
    if (options.folder.empty()) {
        fmt::print(stderr,
                   "Usage: diagnosis_bench FOLDER [--body reference|skeleton] [--ladder] [--threads N] "
                   "[--tell] [--without EFFECT] [SET ...]\n");
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
