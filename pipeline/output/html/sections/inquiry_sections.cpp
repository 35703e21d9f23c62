#include "pipeline/output/html/sections/inquiry_sections.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identify/effects/catalogue.h"
#include "mesh/errors.h"
#include "mesh/text/words.h"
#include "pipeline/output/html/charts/charts.h"
#include "pipeline/output/html/escape.h"
#include "pipeline/output/ladder.h"
#include "pipeline/output/text/words.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

std::string number(const json& value, const char* format = "{:.3g}") {
    return value.is_number() ? fmt::format(fmt::runtime(format), value.get<double>()) : "–";
}

/// "gx 12 ± 3 mm/s^2, ..."
std::string parameters(const json& reported) {
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
    if (!candidate["rms_mm"].is_number() || !claimed["rms_mm"].is_number() || candidate.contains("objection") ||
        candidate["rms_mm"].get<double>() >= claimed["rms_mm"].get<double>())
        return {};
    const std::size_t own = candidate["parameters"].size(), others = claimed["parameters"].size();
    if (own <= others) return {};
    return fmt::format(
        " It leaves less than {}, and takes {} free numbers for that where {} has {}: any numbers fit something of the "
        "noise, and evidence takes that off.",
        claimed["effect"].get<std::string>(), own, claimed["effect"].get<std::string>(), others);
}

/// What an effect would mean, and what became of it.
std::string candidate_words(const json& candidate, bool claimed, double baseline_rms, const std::string& why_not) {
    std::string words = candidate.value("sentence", "");
    if (claimed) words = "<b>Claimed.</b> " + escape(words);
    if (words.empty()) {
        try {
            words = escape(identify::find_effect(candidate["effect"].get<std::string>())->description().meaning);
        } catch (const InvalidInput&) {  // an effect of another program's own
        }
    }
    if (candidate.contains("objection"))
        words += " No claim: " + escape(candidate["objection"].get<std::string>()) + ".";
    if (!candidate["rms_mm"].is_number() && candidate["predicted_rms_mm"].is_number() && !claimed) {
        constexpr double hardly = 0.99;  // of what is left without it
        const bool has_evidence =
            candidate["log_bayes_factor"].is_number() && candidate["log_bayes_factor"].get<double>() > 0;
        words += has_evidence && candidate["predicted_rms_mm"].get<double>() < hardly * baseline_rms
                     ? fmt::format(" Screened only: it would leave {} mm rms.", number(candidate["predicted_rms_mm"]))
                     : " Screened only: it would explain nothing.";
    }
    words += escape(why_not);
    const std::string numbers = parameters(candidate["parameters"]);
    if (!numbers.empty()) words += "<br><span class=\"soft\">" + escape(numbers) + "</span>";
    return words;
}

std::string named_cell(const char* name, const std::string& text) {
    return fmt::format("<td data-name=\"{}\">{}</td>", name, escape(text));
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
                named_cell("evidence", evidence(c["log_bayes_factor"])) +
                named_cell("probability",
                           c["probability"].is_number() ? probability_in_words(c["probability"].get<double>()) : "–") +
                named_cell("error with it", c["rms_mm"].is_number() ? number(c["rms_mm"]) + " mm" : "") +
                named_cell("held out", c["rms_mm"].is_number() && c["held_out_rms_mm"].is_number()
                                           ? number(c["held_out_rms_mm"]) + " mm"
                                           : "") +
                named_cell("over the noise", c["whitened_rms"].is_number() ? number(c["whitened_rms"]) + " ×" : "") +
                "<td class=\"words\">" + candidate_words(c, is_claimed, baseline_rms, why_not) + "</td></tr>";
    }
    return "<div class=\"wide\"><table class=\"cards\"><thead><tr><th>effect</th><th>evidence</th><th>probability</th>"
           "<th>error with it</th><th>held out</th><th>over the noise</th><th class=\"words\">in words</th>"
           "</tr></thead><tbody>" +
           rows + "</tbody></table></div>";
}

std::string baseline_line(const json& diagnosis) {
    const json& b = diagnosis["baseline"];
    std::string text =
        fmt::format("Without any of them: law {}, {}", b["law"].get<std::string>(), material_in_words(b));
    if (const json explained = diagnosis.value("explained", json()); explained.is_object())
        text += "; with what is claimed: " + material_in_words(explained);
    return text + fmt::format(". Without any: {} mm rms, {} held out, {} times the noise ({} mm, {}).",
                              number(b["rms_mm"]), number(b["held_out_rms_mm"]), number(b["whitened_rms"]),
                              number(diagnosis["noise_mm"]),
                              diagnosis["noise_known"].get<bool>() ? "as told" : "estimated");
}

std::string in_lines(const std::string& text) {
    std::string html;
    for (const char c : escape(text)) html += c == '\n' ? std::string("<br>") : std::string(1, c);
    return html;
}

/// A group of bars for each step: fitted, and held out where there is such.
std::vector<BarGroup> groups_of(const json& ladder, bool reference) {
    std::vector<BarGroup> groups;
    for (const json& step : ladder["steps"]) {
        const auto effects = step["effects"].get<std::vector<std::string>>();
        const json& error = reference ? step["reference"] : step;
        if (!error.is_object()) return {};
        BarGroup group{effects.empty() ? "nothing added" : "with " + listed(effects), {}};
        group.bars.push_back({"fitted", error["rms_mm"].get<double>(), false});
        if (error["held_out_rms_mm"].is_number()) {
            group.bars.push_back({"held out", error["held_out_rms_mm"].get<double>(), true});
        }
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
        kinds += fmt::format("{}{} {}", kinds.empty() ? "" : ", ", kind, evidence(ln));
    // Where an effect has a name, its own numbers tell more.
    const std::string how = diagnosis["verdict"] == "unexplained"
                                ? "Fitted where models show such a source, else to first order"
                                : "To first order, about the model without any effect";
    return fmt::format("<p><b>Whatever its name:</b> {} <span class=\"soft\">{}; evidence by kind: {}.</span></p>",
                       escape(where["sentence"].get<std::string>()), how, escape(kinds));
}

}  // namespace

std::string missing_section(const json& diagnosis) {
    if (diagnosis.is_null()) return {};
    return "<h2 id=\"missing\">What is missing</h2>" + where_line(diagnosis) + ranking_table(diagnosis) +
           "<p class=\"soft\">Evidence: ln of the Bayes factor against nothing missing; a claim takes at least 10, and "
           "a "
           "lead of 5. Held out: the error on each probe by a fit to all others, one by one. Over the noise: rms error "
           "over "
           "what noise and unknown contacts explain; 1 is as good as it gets. " +
           escape(baseline_line(diagnosis)) + " Judged on the body in finite elements.</p>";
}

std::string ladder_section(const json& ladder) {
    if (ladder.is_null()) return {};
    std::string held_out;
    for (const json& probe : ladder["held_out_probes"]) held_out += (held_out.empty() ? "" : ", ") + probe.dump();
    return "<h2 id=\"ladder\">Ladder</h2><p>" + in_lines(ladder_in_words(ladder)) + "</p><div class=\"pair\">" +
           group_chart(groups_of(ladder, false), "Error of the skeleton", "mm rms") +
           group_chart(groups_of(ladder, true), "Error of the body in finite elements", "mm rms") + "</div>" +
           (held_out.empty() ? ""
                             : "<p class=\"soft\">Orange: on held-out probes (" + held_out +
                                   "), a quarter of all at once, or a third in turn where they are few. The table "
                                   "above holds out one "
                                   "at a time, so its numbers differ a little.</p>");
}

std::string budget_section(const json& compare, const json& improved) {
    const auto shares_of = [](const json& budget, const std::string& title) {
        return share_bar({{"noise", budget["noise"].get<double>(), "#9aa5b1"},
                          {"coarseness of the skeleton", budget["reduction"].get<double>(), "#2a6f97"},
                          {"missing physics", budget["missing_physics"].get<double>(), "#c8741a"}},
                         title);
    };
    const json before = compare.value("budget", json());
    const json after = improved.is_object() ? improved.value("budget", json()) : json();
    if (!before.is_object()) return {};
    std::string html = "<h2 id=\"budget\">Error budget</h2>";
    if (after.is_object()) {
        html += "<p>Before anything was added:</p>" + shares_of(before, "Shares of the mean square error before") +
                fmt::format(
                    "<p>With what was missing, of a mean square that is {:.2g} times as large:</p>",
                    std::pow(improved["error"]["rms_mm"].get<double>() / compare["error"]["rms_mm"].get<double>(), 2)) +
                shares_of(after, "Shares of the mean square error after");
    } else {
        html += shares_of(before, "Shares of the mean square error");
    }
    return html +
           "<p class=\"soft\">Shares of the mean square error. Noise goes with better sensors, coarseness with more "
           "spheres, missing physics with the effect that is missing.</p>";
}

}  // namespace palpate::pipeline
