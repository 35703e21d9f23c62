#include "pipeline/output/html/sections/diagnosis_sections.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "mesh/text/words.h"
#include "pipeline/output/html/charts/charts.h"
#include "pipeline/output/html/escape.h"
#include "pipeline/output/results/ladder.h"
#include "pipeline/output/text/comparison/comparison.h"
#include "pipeline/output/text/errors.h"
#include "pipeline/output/text/words.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

std::string number(const json& value, const char* format = "{:.3g}") {
    return value.is_number() ? fmt::format(fmt::runtime(format), value.get<double>()) : "–";
}

/// "gx 12 ± 3 mm/s^2, ..."; of too many to read only how many there are.
std::string parameters(const json& reported) {
    constexpr std::size_t most = 12;  // a choice: most effects have up to six, a map has four a place; more fill a page
    if (reported.size() > most) return fmt::format("{} parameters, listed in diagnose/diagnosis.json", reported.size());
    std::string text;
    for (const auto& [name, p] : reported.items()) {
        if (!p["value"].is_number()) continue;
        text += text.empty() ? "" : ", ";
        text += name + " " + mesh::with_sd(p["value"].get<double>(), p["sd"].is_number() ? p["sd"].get<double>() : 0);
        if (const std::string unit = p["unit"]; unit != "1") text += " " + unit;
    }
    return text;
}

/// ln of a Bayes factor: tenths say enough, and none beyond a hundred.
std::string evidence(const json& value) {
    if (!value.is_number()) return "–";
    const double v = value.get<double>();
    constexpr double least = 0.05, large = 100;
    if (std::abs(v) < least) return "0";
    return std::abs(v) < large ? fmt::format("{:.1f}", v) : fmt::format("{:.0f}", v);
}

/// Why what leaves less than the claimed effect is not claimed, where evidence decides.
std::string why_not_the_closer(const json& candidate, const json& claimed) {
    const char* rms = keys_of(claimed).fitted;
    if (!candidate["rms_mm"].is_number() || !claimed["rms_mm"].is_number() || candidate.contains("objection") ||
        candidate[rms].get<double>() >= claimed[rms].get<double>())
        return {};
    const std::size_t own = candidate["parameters"].size(), others = claimed["parameters"].size();
    if (own <= others) return {};
    return fmt::format(
        " It fits closer than {}, but with {} parameters instead of {}, which the Bayes factor penalises.",
        claimed["effect"].get<std::string>(), own, others);
}

/// What became of an effect that was fitted to first order alone.
std::string screened_words(const json& candidate, double baseline_rms) {
    constexpr double hardly = 0.99;  // of what is left without it
    const bool has_evidence =
        candidate["log_bayes_factor"].is_number() && candidate["log_bayes_factor"].get<double>() > 0;
    const double predicted = candidate["predicted_rms_mm"].get<double>();
    // The estimate is of positions: where forces alone were read, the evidence decides.
    const bool explains = has_evidence && (predicted < hardly * baseline_rms || baseline_rms == 0);
    if (!explains)
        return has_evidence ? "Screened out: its linear estimate does not lower the rms error."
                            : "Screened out: its linear estimate explains nothing.";
    return baseline_rms > 0 ? fmt::format("Screened out: its linear estimate leaves {:.3g} mm rms.", predicted)
                            : "Screened out.";
}

/// What became of an effect first, then what it would mean.
std::string candidate_words(const json& candidate, bool claimed, double baseline_rms, const std::string& why_not) {
    const std::string meaning = prose(candidate.value("sentence", ""));
    std::string words;
    if (claimed)
        words = "<b>Claimed.</b> " + meaning;
    else if (!candidate["rms_mm"].is_number() && candidate["predicted_rms_mm"].is_number())
        words = prose(screened_words(candidate, baseline_rms));
    else if (candidate.contains("objection"))
        words = "<b>Rejected:</b> " + prose(candidate["objection"].get<std::string>()) + ".";
    else
        words = "<b>Not claimed.</b>";
    words += escape(why_not);
    if (!claimed && !meaning.empty()) words += " It would mean: " + meaning;
    const std::string numbers = parameters(candidate["parameters"]);
    if (!numbers.empty()) words += "<br><span class=\"soft\">" + prose(numbers) + "</span>";
    return words;
}

std::string named_cell(const char* name, const std::string& text) {
    return fmt::format("<td data-name=\"{}\">{}</td>", name, prose(text));
}

std::string ranking_table(const json& diagnosis) {
    const auto claimed = diagnosis["verdict"] == "missing-effect"
                             ? diagnosis["explanation"].get<std::vector<std::string>>()
                             : std::vector<std::string>{};
    const double baseline_rms = diagnosis["baseline"]["rms_mm"].get<double>();
    std::string rows;
    for (const json& c : diagnosis["ranking"]) {
        const bool is_claimed = std::ranges::find(claimed, c["effect"].get<std::string>()) != claimed.end();
        const std::string why_not =
            is_claimed || claimed.size() != 1 ? "" : why_not_the_closer(c, diagnosis["ranking"][0]);
        rows += fmt::format("<tr{}><td>{}</td>", is_claimed ? " class=\"claimed\"" : "",
                            escape(c["effect"].get<std::string>())) +
                named_cell("ln Bayes factor", evidence(c["log_bayes_factor"])) +
                named_cell("probability",
                           c["probability"].is_number() ? probability_in_words(c["probability"].get<double>()) : "–") +
                named_cell("rms error", c["rms_mm"].is_number() ? rms_in_words(c) : "") +
                named_cell("held out", c["rms_mm"].is_number() ? held_out_rms_in_words(c) : "") +
                named_cell("normalised", c["whitened_rms"].is_number() ? number(c["whitened_rms"]) : "") +
                "<td class=\"words\">" + candidate_words(c, is_claimed, baseline_rms, why_not) + "</td></tr>";
    }
    return "<div class=\"wide\" tabindex=\"0\"><table class=\"cards\"><thead><tr><th>effect</th><th>ln Bayes "
           "factor</th><th>probability</th>"
           "<th>rms error</th><th>held out</th><th>normalised</th><th class=\"words\">outcome</th>"
           "</tr></thead><tbody>" +
           rows + "</tbody></table></div>";
}

std::string baseline_line(const json& diagnosis) {
    const json& b = diagnosis["baseline"];
    std::string text = fmt::format("Baseline, without any effect: {}, {}; {} rms, {} held out, normalised {}.",
                                   law_in_words(b["law"].get<std::string>()), material_in_words(b), rms_in_words(b),
                                   held_out_rms_in_words(b), number(b["whitened_rms"]));
    if (keys_of(b).unit == std::string_view("mm"))
        text +=
            fmt::format(" Measurement noise ({}): {} mm rms.",
                        diagnosis["noise_known"].get<bool>() ? "declared" : "estimated", number(diagnosis["noise_mm"]));
    if (const json explained = diagnosis.value("explained", json()); explained.is_object())
        text += " With what is claimed: " + material_in_words(explained) + ".";
    return text;
}

std::string in_lines(const std::string& text) {
    std::string html;
    for (const char c : prose(text)) html += c == '\n' ? std::string("<br>") : std::string(1, c);
    return html;
}

/// A group of bars for each step: fitted, and held out where there is such.
std::vector<BarGroup> groups_of(const json& ladder, bool reference) {
    std::vector<BarGroup> groups;
    for (const json& step : ladder["steps"]) {
        const auto effects = step["effects"].get<std::vector<std::string>>();
        const json& error = reference ? step["reference"] : step;
        if (!error.is_object()) return {};
        const ErrorKeys keys = keys_of(error);
        BarGroup group{effects.empty() ? "nothing added" : "with " + listed(effects), {}};
        group.bars.push_back({"fitted", error[keys.fitted].get<double>(), false});
        if (error[keys.held_out].is_number())
            group.bars.push_back({"held out", error[keys.held_out].get<double>(), true});
        groups.push_back(group);
    }
    return groups;
}

/// What the model leaves, located, and how the kinds compare.
std::string where_line(const json& diagnosis) {
    const json where = diagnosis.value("where", json());
    if (!where.is_object()) return {};
    std::string kinds;
    for (const auto& [kind, ln] : where["log_bayes_factors"].items())
        if (ln.is_number()) kinds += fmt::format("{}{} {}", kinds.empty() ? "" : ", ", kind, evidence(ln));
    // Where an effect has a name, its own numbers are more informative.
    const std::string how = diagnosis["verdict"] == "unexplained"
                                ? "Fitted where models show such a source, else a linearised estimate"
                                : "A linearised estimate about the baseline";
    return fmt::format(
        "<p><b>Without assuming a specific effect:</b> {} <span class=\"soft\">{}; ln Bayes factors by kind of source, "
        "not comparable with those of the table: {}.</span></p>",
        prose(where["sentence"].get<std::string>()), how, escape(kinds));
}

bool is_among(const json& probes, const json& state) {
    return std::ranges::find(probes, state["probe"]) != probes.end();
}

/// Why probes that no fit has seen err less than those fitted, where they move the body less; `states`: as in
/// compare.json.
std::string why_held_out_errs_less(const std::vector<BarGroup>& groups, const json& held_out, const json& states) {
    if (std::ranges::none_of(groups, [](const BarGroup& group) {
            return group.bars.size() > 1 && group.bars[1].value < group.bars[0].value;
        }))
        return {};
    struct Moved {  // sum of squares [mm^2] over states
        double squares = 0;
        int states = 0;
        double rms() const { return states > 0 ? std::sqrt(squares / states) : 0; }
    } left_out, fitted;
    for (const json& state : states) {
        if (!state["rms_mm"].is_number() || !state["relative"].is_number() || !(state["relative"].get<double>() > 0))
            continue;
        const double moved = state["rms_mm"].get<double>() / state["relative"].get<double>();
        Moved& of = is_among(held_out, state) ? left_out : fitted;
        of.squares += moved * moved;
        ++of.states;
    }
    if (left_out.states == 0 || !(left_out.rms() < fitted.rms())) return {};
    return fmt::format(
        " The held-out probes move the markers by {} mm rms, the fitted ones by {} mm: errors grow with the motion, so "
        "that held-out ones can be the smaller.",
        number(left_out.rms()), number(fitted.rms()));
}

/// Which probes were held out, and how; `states`: as in compare.json.
std::string held_out_line(const std::vector<BarGroup>& groups, const json& held_out, const json& states) {
    if (held_out.empty()) return {};
    std::string probes;
    for (const json& probe : held_out) probes += (probes.empty() ? "" : ", ") + probe.dump();
    const bool in_turn = std::ranges::all_of(states, [&](const json& state) { return is_among(held_out, state); });
    return "<p class=\"soft\">Blue: error on the probes that were fitted. Orange: cross-validation error" +
           (in_turn ? ", a third of the probes held out in turn" : " on probes " + probes + ", held out of each fit") +
           "." + why_held_out_errs_less(groups, held_out, states) +
           " <span class=\"aside\">In the table above, the errors are of fits to all probes; those held out leave out "
           "one probe at a time.</span></p>";
}

}  // namespace

std::string missing_section(const json& diagnosis) {
    if (diagnosis.is_null()) return {};
    const bool is_named = diagnosis["verdict"] == "missing-effect";  // its own numbers come first
    return "<h2 id=\"missing\">What is missing</h2>" + (is_named ? "" : where_line(diagnosis)) +
           ranking_table(diagnosis) +
           "<p class=\"soft\">ln Bayes factor: the evidence for an effect over the model without effects; it is "
           "claimed from "
           "10 on, with a lead of 5. Held out: rms error on each probe by a fit to all others, one by one. Normalised: "
           "rms of the errors, "
           "each over its standard deviation by measurement noise and unknown contacts; 1 is fully explained. " +
           prose(baseline_line(diagnosis)) + " All numbers are of the finite-element model.</p>";
}

std::string ladder_section(const json& ladder, const json& compare) {
    if (ladder.is_null()) return {};
    const std::string unit = std::string(keys_of(ladder["steps"].front()).unit) + " rms";
    const std::vector<BarGroup> real_time = groups_of(ladder, false);
    return "<h2 id=\"ladder\">Ladder</h2><p>" + in_lines(ladder_in_words(ladder)) + "</p><div class=\"pair\">" +
           group_chart(real_time, "Error of the real-time model", unit) +
           group_chart(groups_of(ladder, true), "Error of the finite-element model", unit) + "</div>" +
           held_out_line(real_time, ladder["held_out_probes"], compare["probes"]);
}

std::string budget_section(const json& compare, const json& improved) {
    const auto shares_of = [](const json& budget, const std::string& title) {
        return share_bar({{"noise", budget["noise"].get<double>(), "#9aa5b1"},
                          {"coarseness of the skeleton", budget["reduction"].get<double>(), "#2a6f97"},
                          {"unexplained", budget["missing_physics"].get<double>(), "#c8741a"}},
                         title);
    };
    const json before = compare.value("budget", json());
    const json after = improved.is_object() ? improved.value("budget", json()) : json();
    if (!before.is_object() || !reads_positions(compare)) return {};  // the budget is of positions
    std::string html = "<h2 id=\"budget\">Error budget</h2>";
    if (after.is_object()) {
        const double left =
            std::pow(improved["error"]["rms_mm"].get<double>() / compare["error"]["rms_mm"].get<double>(), 2);
        html += "<p>Baseline:</p>" + shares_of(before, "Shares of the mean square error, baseline") +
                fmt::format(
                    "<p>With the missing effect added, the mean square error falls to {:.2g} % of the baseline's. Of "
                    "this:</p>",
                    100 * left) +
                shares_of(after, "Shares of the mean square error, effect added");
    } else {
        html += shares_of(before, "Shares of the mean square error");
    }
    return html +
           "<p class=\"soft\">Shares of the mean square error of the real-time model. Better sensors reduce the noise, "
           "more "
           "spheres the coarseness of the skeleton; the unexplained share is missing physics and "
           "details of contacts and clamps.</p>";
}

}  // namespace palpate::pipeline
