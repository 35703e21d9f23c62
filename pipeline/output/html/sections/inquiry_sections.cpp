#include "pipeline/output/html/sections/inquiry_sections.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identify/effects/catalogue.h"
#include "mesh/errors.h"
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

/// So many digits, but all of those before the point.
std::string few_digits(const json& value, int digits) {
    if (!value.is_number()) return "–";
    const double v = value.get<double>();
    return std::abs(v) >= std::pow(10, digits) ? fmt::format("{:.0f}", v) : fmt::format("{:.{}g}", v, digits);
}

/// "gx 12 ± 3 mm/s^2, ..."
std::string parameters(const json& reported) {
    std::string text;
    for (const auto& [name, p] : reported.items()) {
        text += text.empty() ? "" : ", ";
        text += name + " " + few_digits(p["value"], 4);
        if (p["sd"].is_number()) text += " ± " + few_digits(p["sd"], 2);
        if (const std::string unit = p["unit"]; unit != "1") text += " " + unit;
    }
    return text;
}

/// What an effect would mean, and what became of it.
std::string candidate_words(const json& candidate, bool claimed) {
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
    if (!candidate["rms_mm"].is_number() && candidate["predicted_rms_mm"].is_number()) {
        words += fmt::format(" Screened only: it would leave {} mm rms.", number(candidate["predicted_rms_mm"]));
    }
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
    std::string rows;
    for (const json& c : diagnosis["ranking"]) {
        const bool is_claimed = std::ranges::find(claimed, c["effect"].get<std::string>()) != claimed.end();
        rows += fmt::format("<tr{}><td>{}</td>", is_claimed ? " class=\"claimed\"" : "",
                            escape(c["effect"].get<std::string>())) +
                named_cell("evidence", few_digits(c["log_bayes_factor"], 3)) +
                named_cell("probability", number(c["probability"], "{:.2f}")) +
                named_cell("error with it", c["rms_mm"].is_number() ? number(c["rms_mm"]) + " mm" : "") +
                named_cell("on probes left out",
                           c["held_out_rms_mm"].is_number() ? number(c["held_out_rms_mm"]) + " mm" : "") +
                named_cell("over the noise", c["whitened_rms"].is_number() ? number(c["whitened_rms"]) + " ×" : "") +
                "<td class=\"words\">" + candidate_words(c, is_claimed) + "</td></tr>";
    }
    return "<div class=\"wide\"><table class=\"cards\"><thead><tr><th>effect</th><th>evidence</th><th>probability</th>"
           "<th>error with it</th><th>on probes left out</th><th>over the noise</th><th class=\"words\">in words</th>"
           "</tr></thead><tbody>" +
           rows + "</tbody></table></div>";
}

std::string baseline_line(const json& diagnosis) {
    const json& b = diagnosis["baseline"];
    std::string text = fmt::format("Without any of them: law {}, E = {:.3g} MPa", b["law"].get<std::string>(),
                                   b["young_mpa"].get<double>());
    if (b["poisson"].is_number())
        text += fmt::format(", ν = {:.3f} ± {}", b["poisson"].get<double>(), number(b["poisson_sd"], "{:.2g}"));
    return text + fmt::format("; {} mm rms, {} on probes left out, {} times the noise ({} mm, {}).",
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

}  // namespace

std::string missing_section(const json& diagnosis) {
    if (diagnosis.is_null()) return {};
    return "<h2 id=\"missing\">What is missing</h2>" + ranking_table(diagnosis) +
           "<p class=\"soft\">Evidence: ln of the Bayes factor against nothing missing; a claim takes at least 10, and "
           "a "
           "lead of 5. Over the noise: rms error over what noise and unknown contacts explain; 1 is as good as it "
           "gets. " +
           escape(baseline_line(diagnosis)) + " Judged on the body in finite elements.</p>";
}

std::string ladder_section(const json& ladder) {
    if (ladder.is_null()) return {};
    std::string held_out;
    for (const json& probe : ladder["held_out_probes"]) held_out += (held_out.empty() ? "" : ", ") + probe.dump();
    return "<h2 id=\"ladder\">Ladder</h2><p>" + in_lines(ladder_in_words(ladder)) + "</p><div class=\"pair\">" +
           group_chart(groups_of(ladder, false), "Error of the skeleton", "mm rms") +
           group_chart(groups_of(ladder, true), "Error of the body in finite elements", "mm rms") + "</div>" +
           (held_out.empty()
                ? ""
                : "<p class=\"soft\">Orange: on probes held out (" + held_out + "), at once or in turn.</p>");
}

std::string budget_section(const json& compare) {
    const json budget = compare.value("budget", json());
    if (!budget.is_object()) return {};
    return "<h2 id=\"budget\">Error budget</h2>" +
           share_bar({{"noise", budget["noise"].get<double>(), "#9aa5b1"},
                      {"coarseness of the skeleton", budget["reduction"].get<double>(), "#2a6f97"},
                      {"missing physics", budget["missing_physics"].get<double>(), "#c8741a"}},
                     "Shares of the mean square error") +
           "<p class=\"soft\">Shares of the mean square error before anything is added. Noise goes with better "
           "sensors, "
           "coarseness with more spheres, missing physics with the effect that is missing.</p>";
}

}  // namespace palpate::pipeline
