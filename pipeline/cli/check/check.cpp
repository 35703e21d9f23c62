#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "identify/diagnosis/statistics/independent_readings.h"
#include "identify/effects/catalogue.h"
#include "identify/measurements/rig/fittable.h"
#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"
#include "mesh/text/words.h"
#include "pipeline/analysis/cost/machine_speed.h"
#include "pipeline/analysis/preflight.h"
#include "pipeline/case/settings/read_case.h"
#include "pipeline/case/subject/subject.h"
#include "pipeline/cli/check/faults.h"
#include "pipeline/cli/check/held.h"
#include "pipeline/command_line/commands.h"
#include "pipeline/command_line/flags.h"
#include "pipeline/command_line/subcommands.h"
#include "pipeline/output/html/check/check_page.h"
#include "pipeline/output/json/comparison.h"
#include "pipeline/output/json/preflight.h"
#include "pipeline/output/text/cost.h"
#include "pipeline/output/text/describe/describe_rig.h"
#include "pipeline/output/text/preflight.h"

namespace palpate::pipeline::commands {
namespace {

std::string describe_set(const identify::MeasurementSet& set) {
    std::size_t readings = 0;
    for (const auto& state : set.states) readings += state.readings.size();
    std::string text = fmt::format("{} states ({} loaded), {} markers, {} readings", set.states.size(),
                                   loaded_states(set), set.markers.size(), readings);
    if (!set.recordings.empty()) text += fmt::format(", {} recordings of motion", set.recordings.size());
    if (!set.position_noise && readings > 0) text += "; no noise is declared";
    text += ".\n";
    for (const std::string& line : rig_in_words(set)) text += mesh::capitalised(line) + ".\n";
    return text;
}

/// How the loads are numbered: within a probe one body goes through them in time, between probes it is as new.
std::string describe_numbering(const identify::Problem& problem) {
    std::map<int, int> loads;  // of each probe
    for (std::size_t k = 0; k < problem.actions.size(); ++k)
        if (problem.loaded(static_cast<int>(k))) ++loads[problem.probe[k]];
    if (loads.size() == 1 && loads.begin()->second > 1)
        return fmt::format(
            "All {} loads are of probe {}: one body went through them in the order of time, which creep and yield "
            "remember, and loads are held out one by one. Number those as probes of their own before which the body "
            "was at rest.\n",
            loads.begin()->second, loads.begin()->first);
    return {};
}

/// What the readings can tell at most.
std::string describe_information(const identify::Problem& problem, int independent) {
    constexpr int few = 12;  // the largest effect has six numbers: stiffness and two of that kind
    std::string text = fmt::format("{} measured coordinates, {} of them independent data", problem.rows(), independent);
    if (independent > few) return text + ".\n";
    return text +
           ": too few for most effects, whatever the noise. Read more markers, or load other places and directions.\n";
}

/// How many data the readings are. Nothing where none is labelled.
void add_information(const identify::MeasurementSet& set, Outcome& outcome) {
    if (std::ranges::none_of(set.states, [](const auto& state) { return !state.readings.empty(); })) return;
    // Where the noise is not specified: a hundredth of how far the markers move.
    const identify::Problem raw = identify::make_problem(set, 1);
    const double moved = std::sqrt(raw.displacement().squaredNorm() / static_cast<double>(raw.rows()));
    const identify::Problem problem =
        identify::make_problem(set, set.position_noise.value_or(std::max(0.01 * moved, 1e-9)));
    const int independent = identify::independent_readings(problem);
    outcome.text += describe_information(problem, independent) + describe_numbering(problem);
    outcome.json["independent_readings"] = independent;
}

/// Before a fit: what the set could show, which readings look off, and what to measure next.
void add_preflight(const Subject& subject, const Common& common, Outcome& outcome) {
    identify::MeasurementSet set = *subject.set;
    set.supports = subject.supports;
    const PreflightOfSet judged = judge(set, common.threads, Console::progress());
    outcome.json["preflight"] = judged.preflight ? to_json(*judged.preflight, *judged.body, set) : nlohmann::json();
    if (!judged.preflight) {
        outcome.json["no_preflight"] = judged.why_none;
        outcome.text += "What the set could show was not judged: " + judged.why_none + ".\n";
    } else {
        outcome.text += preflight_in_words(outcome.json["preflight"]);
    }
}

/// What a run would take: counted and estimated, nothing is run.
void add_cost(const CheckOptions& options, const Subject& subject, const Common& common, Outcome& outcome) {
    const WorkSize size = size_of_run(subject, Console::progress());
    outcome.json["cost"] = to_json(cost_of_run(size, common.threads, machine_speed()), size, common.threads);
    Console::end_progress();
    std::string input = options.input.string();
    for (const std::string& flag : options.overrides.flags()) input += " " + flag;
    outcome.text += cost_in_words(outcome.json["cost"], input);
}

/// Effects that the set has to be able to show. @throws InvalidInput without a set.
void judge_expectations(const CheckOptions& options, Outcome& outcome) {
    for (const std::string& effect : options.expected) {
        const bool is_judged = outcome.json.contains("preflight") && !outcome.json["preflight"].is_null();
        const std::string why = is_judged ? why_not_shown(outcome.json["preflight"], effect)
                                          : fmt::format("The set cannot be asked for {}: {}.", effect,
                                                        outcome.json.value("no_preflight", "its body cannot be run"));
        outcome.json["expected"].push_back({{"effect", effect}, {"shown", why.empty()}, {"words", why}});
        if (why.empty()) continue;
        outcome.text += "Not as expected: " + why + "\n";
        if (outcome.code == done) outcome.code = not_met;
    }
}

/// How large a body is and what is wrong with its surface; of one that is refused why, as its faults may come of that.
std::string surface_verdict(const std::string& name, const Subject& subject, const mesh::SurfaceReport& surface,
                            const std::vector<std::string>& faults, const std::vector<mesh::FaultPlace>& places) {
    const mesh::Box& box = surface.box;
    if (!subject.refusal.empty())
        return fmt::format(
            "{}: {} vertices, {} triangles, box ({:.4g}, {:.4g}, {:.4g}) to ({:.4g}, {:.4g}, {:.4g}) mm.\n"
            "It cannot be run: {}.\n",
            name, subject.surface.vertices.rows(), subject.surface.triangles.rows(), box.min.x(), box.min.y(),
            box.min.z(), box.max.x(), box.max.y(), box.max.z(), subject.refusal);
    std::string text =
        fmt::format("{}: {} vertices, {} triangles, {} part{}, {:.4g} x {:.4g} x {:.4g} mm, volume {:.4g} mm^3.\n",
                    name, surface.vertices, surface.triangles, surface.components, surface.components == 1 ? "" : "s",
                    box.extent().x(), box.extent().y(), box.extent().z(), surface.volume);
    if (subject.set) text += describe_set(*subject.set);
    for (const std::string& fault : faults) text += "  - " + fault + "\n";
    if (!places.empty()) text += "  Where:\n" + describe_places(places);
    return text + (faults.empty() ? "The surface is sound.\n" : "");
}

bool is_page(const std::filesystem::path& output) { return output.extension() == ".html"; }

}  // namespace

Outcome check(const CheckOptions& options, const Common& common) {
    if (!options.output.empty()) refuse_to_overwrite(options.output, common.force);
    for (const std::string& effect : options.expected) identify::find_effect(effect);
    const Subject subject = read_subject_as_it_is(read_case(options.input, options.overrides));
    if (!subject.set && !options.expected.empty())
        throw InvalidInput(
            fmt::format("{}: --expect asks what measurements can show, and this is a mesh; give a measurement set",
                        options.input.string()));
    std::vector<mesh::FaultPlace> places;
    const mesh::SurfaceReport surface = mesh::check_surface(subject.surface, &places);
    const std::vector<std::string> faults = mesh::describe_faults(surface);

    Outcome outcome;
    const bool is_refused = !subject.refusal.empty();
    const std::string verdict = surface_verdict(options.input.string(), subject, surface, faults, places);
    outcome.text = verdict;
    if (is_refused) outcome.code = bad_input;
    for (const std::string& note : subject.notes) outcome.text += "  - " + note + "\n";
    for (const std::string& assumption : subject.assumptions) outcome.text += "  - assumed: " + assumption + "\n";
    outcome.json = {{"format", "palpate-check/1"},
                    {"surface", to_json(surface)},
                    {"faults", faults},
                    {"places", places_json(places)},
                    {"notes", subject.notes},
                    {"assumptions", subject.assumptions},
                    {"refusal", is_refused ? nlohmann::json(subject.refusal) : nlohmann::json(nullptr)}};
    if (subject.volume) {
        outcome.json["tetrahedra"] = subject.volume->tetrahedra.rows();
        outcome.text += fmt::format("A ready-made mesh of {} tetrahedra with {} nodes each, used as it is.\n",
                                    subject.volume->tetrahedra.rows(), subject.volume->tetrahedra.cols());
    }
    if (subject.set) {
        outcome.json["set"] = {{"states", subject.set->states.size()}, {"markers", subject.set->markers.size()}};
        outcome.json["set"].update(rig_json(*subject.set));
    }
    add_supports(subject, outcome);
    if (subject.set) add_grips(subject, outcome);
    const bool is_fittable = !subject.set || identify::parts_not_fitted_yet(*subject.set).empty();
    if (subject.set && is_fittable) add_information(*subject.set, outcome);
    // It takes as long as a first fit: only where somebody wants to read it.
    const bool is_asked = !options.output.empty() || !options.expected.empty();
    if (subject.set && !is_refused && is_asked) add_preflight(subject, common, outcome);
    if (subject.set && !is_refused && !is_asked)
        outcome.text += fmt::format("What it could show, and what to measure next: palpate check {} -o check.html\n",
                                    options.input.string());
    judge_expectations(options, outcome);
    if (options.cost && is_fittable && !is_refused) add_cost(options, subject, common, outcome);
    if (is_refused) outcome.text = verdict;  // all else is of a body that there is not
    if (is_page(options.output)) {
        write_check_page(options.output, subject, outcome.json);
        outcome.text += fmt::format("Written: {}\n", options.output.string());
    } else if (!options.output.empty()) {
        write_faults(options.output, subject.surface, places);
        mesh::write_text(options.output / "check.json", outcome.json.dump(2) + "\n");
        write_check_page(options.output / "check.html", subject, outcome.json);
        outcome.text += fmt::format(
            "Written to {}: check.html, check.json; surface.vtp and faults.vtp, coloured by 'fault', show where "
            "(ParaView).\n",
            options.output.string());
    }
    if (is_fittable && !is_refused)
        outcome.text +=
            "Next: palpate run " + options.input.string() + (faults.empty() ? "" : "    # repairs what it can") + "\n";
    return outcome;
}

}  // namespace palpate::pipeline::commands

namespace palpate::pipeline {

void Subcommands::add_check(CLI::App& app) {
    auto* sub = subcommand(
        app, "check", "Reads everything, repairs nothing, says what is wrong, and what measurements could show.",
        "  palpate check liver.stl\n"
        "  palpate check liver.stl -o liver-check          # a folder that shows where faults are\n"
        "  palpate check my-measurements/ -o check.html    # one page: what could be named, what to measure next\n"
        "  palpate check liver.stl --cost --edge-length 2  # seconds and gigabytes of a run, before it is begun\n"
        "  palpate check my-measurements/ --expect gravity # exit code 5 where they cannot show it\n",
        [this] { return commands::check(check, common); });
    sub->add_option("INPUT", check.input, "A case.yaml, a measurement set, or a mesh")->required();
    sub->add_option("-o,--output", check.output,
                    "A page (.html); or a folder for it, for check.json, and for files that show where faults are");
    sub->add_option(
           "--expect", check.expected,
           "An effect that the set has to be able to show at the strength of its prior, else the exit code is 5; "
           "repeatable, or separated by commas")
        ->delimiter(',')
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    sub->add_flag("--cost", check.cost,
                  "How long a run would take, how much memory, and what would solve its equations: the body is meshed, "
                  "coarsely where it is large, and its skeleton is built");
    for (const char* group : {"Body", "Skeleton", "Probing", "Identification"})
        add_flags_of(sub, check.overrides, group);
}

}  // namespace palpate::pipeline
