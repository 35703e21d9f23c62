#include "pipeline/output/text/comparison/runs.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <iterator>

#include "pipeline/output/text/words.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

std::string in_unit(const json& value, const char* unit) {
    return value.is_number() ? fmt::format("{:.3g} {}", value.get<double>(), unit) : "–";
}

// An error of a run, and in words: in N where forces alone were measured.
json nothing_added(const json& run) { return (run["rms_n"].is_null() ? run["rms_mm"] : run["rms_n"])["nothing_added"]; }
json fitted(const json& run) { return (run["rms_n"].is_null() ? run["rms_mm"] : run["rms_n"])["now"]; }
json held_out(const json& run) { return run["rms_n"].is_null() ? run["held_out_rms_mm"] : run["rms_n"]["held_out"]; }
std::string error_of_run(const json& run, const json& error) {
    return in_unit(error, run["rms_n"].is_null() ? "mm" : "N");
}

/// The run of the least value; none where one has no value, or two share it to the digits reported.
std::optional<std::size_t> least(const json& runs, const std::function<json(const json&)>& value_of) {
    if (!can_be_ranked(runs)) return std::nullopt;
    std::vector<double> values;
    for (const json& run : runs["runs"]) {
        const json value = value_of(run);
        if (!value.is_number()) return std::nullopt;
        values.push_back(value.get<double>());
    }
    const auto to_three_digits = [](double value) { return fmt::format("{:.3g}", value); };
    const auto best = std::ranges::min_element(values);
    if (std::ranges::count(values, to_three_digits(*best), to_three_digits) > 1) return std::nullopt;
    return static_cast<std::size_t>(best - values.begin());
}

/// Has every run an error on the same held-out probes?
bool share_held_out(const json& runs) {
    return std::ranges::all_of(runs["runs"], [&](const json& run) {
        return held_out(run).is_number() && run["held_out_probes"] == runs["runs"][0]["held_out_probes"];
    });
}

std::string or_none(const json& value) { return value.is_string() ? value.get<std::string>() : "–"; }

}  // namespace

bool can_be_ranked(const json& runs) { return runs["same_states"].get<bool>() && runs["same_readings"].get<bool>(); }

std::vector<RunNumber> run_numbers(const json& runs) {
    std::vector<RunNumber> numbers;
    const auto add = [&](const std::string& name, const std::function<std::string(const json&)>& words) -> RunNumber& {
        numbers.push_back({name, {}, {}});
        for (const json& run : runs["runs"]) numbers.back().of_runs.push_back(words(run));
        return numbers.back();
    };
    add("verdict", [](const json& run) { return or_none(run["verdict"]); });
    add("added", [](const json& run) {
        const auto effects = run["effects"].get<std::vector<std::string>>();
        return effects.empty() ? "nothing" : listed(effects);
    });
    add("rms error, nothing added", [](const json& run) { return error_of_run(run, nothing_added(run)); });
    add("rms error", [](const json& run) { return error_of_run(run, fitted(run)); }).best = least(runs, fitted);
    add("rms error, held out", [](const json& run) { return error_of_run(run, held_out(run)); }).best =
        share_held_out(runs) ? least(runs, held_out) : std::nullopt;
    add("error over displacement",
        [](const json& run) { return run["relative"].is_number() ? percent(run["relative"].get<double>()) : "–"; });
    add("noise", [](const json& run) { return in_unit(run["noise_mm"], "mm"); });
    add("finite elements", [](const json& run) { return or_none(run["material"]); });
    add("spheres, links",
        [](const json& run) { return fmt::format("{}, {}", run["spheres"].get<int>(), run["links"].get<int>()); });
    add("stiffnesses constrained by the data", [](const json& run) {
        return fmt::format("{} of {}", run["informed"].get<int>(), run["stiffnesses"].get<int>());
    });
    add("time taken", [](const json& run) { return fmt::format("{:.0f} s", run["seconds"].get<double>()); });
    return numbers;
}

std::string best_run_in_words(const json& runs) {
    if (!runs["same_states"].get<bool>())
        return "These runs differ in body, loads or states; their errors are listed, not ranked.";
    if (!runs["same_readings"].get<bool>())
        return "These runs use different measurements; their errors are listed, not ranked.";
    const bool is_foretold = share_held_out(runs);
    const auto best = least(runs, is_foretold ? held_out : fitted);
    if (!best)
        return fmt::format("No run has a smaller error{} than all others, to three digits.",
                           is_foretold ? " on held-out probes" : "");
    const json& run = runs["runs"][*best];
    const auto name = run["run"].get<std::string>();
    if (is_foretold)
        return fmt::format("{} has the least error on held-out probes, {} rms.", name,
                           error_of_run(run, held_out(run)));
    return fmt::format(
        "{} has the least error on the probes it was fitted to, {} rms. The runs share no held-out probes, so a model "
        "with more parameters may merely fit more of the noise.",
        name, error_of_run(run, fitted(run)));
}

std::string runs_table(const json& runs) {
    std::vector<RunNumber> rows{{"", {}, {}}};
    for (const json& run : runs["runs"]) rows[0].of_runs.push_back(run["run"]);
    std::ranges::copy(run_numbers(runs), std::back_inserter(rows));
    if (!runs["settings"].empty()) rows.push_back({"settings that differ:", {}, {}});
    for (const json& one : runs["settings"])
        rows.push_back({"  " + one["setting"].get<std::string>(), one["values"].get<std::vector<std::string>>(), {}});

    std::vector<std::size_t> widths(runs["runs"].size() + 1, 0);
    for (const RunNumber& row : rows) {
        widths[0] = std::max(widths[0], row.name.size());
        for (std::size_t r = 0; r < row.of_runs.size(); ++r)
            widths[r + 1] = std::max(widths[r + 1], row.of_runs[r].size());
    }
    std::string text;
    for (const RunNumber& row : rows) {
        std::string line = fmt::format("{:<{}}", row.name, widths[0]);
        for (std::size_t r = 0; r < row.of_runs.size(); ++r)
            line += fmt::format("  {:<{}}", row.of_runs[r], widths[r + 1]);
        line.erase(line.find_last_not_of(' ') + 1);
        text += line + "\n";
    }
    return text + "\n" + best_run_in_words(runs) + "\n";
}

}  // namespace palpate::pipeline
