#include "pipeline/output/html/check/check_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "identify/effects/catalogue.h"
#include "mesh/geometry/surface_tree.h"
#include "mesh/geometry/winding.h"
#include "mesh/text/atomic_file.h"
#include "mesh/text/words.h"
#include "pipeline/output/html/check/check_picture.h"
#include "pipeline/output/html/escape.h"
#include "pipeline/output/html/page/page_parts.h"
#include "pipeline/output/html/page_frame.h"
#include "pipeline/output/text/cost.h"
#include "pipeline/output/text/preflight.h"
#include "pipeline/output/text/words.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

std::string check_tile(const std::string& value, const std::string& what) {
    return fmt::format(R"(<div class="tile"><b>{}</b>{}</div>)", prose(value), prose(what));
}

std::string items(const json& list) {
    std::string html;
    for (const json& one : list)
        html += "<li>" + prose(one.is_string() ? one.get<std::string>() : one["words"].get<std::string>()) + "</li>";
    return html.empty() ? "" : "<ul>" + html + "</ul>";
}

std::string mm(const json& value) { return value.is_number() ? fmt::format("{:.2g} mm", value.get<double>()) : "–"; }

std::string data_cell(const char* name, const std::string& text) {
    return fmt::format("<td data-name=\"{}\">{}</td>", name, prose(text));
}

std::string lead(const json& check, const json& preflight) {
    if (!check["refusal"].is_null()) return "It cannot be run: " + check["refusal"].get<std::string>() + ".";
    if (!preflight.is_null()) return preflight_lead(preflight);
    if (check.contains("no_preflight"))
        return "What the set could show was not judged: " + check["no_preflight"].get<std::string>() + ".";
    return check["faults"].empty() ? "The surface is sound."
                                   : fmt::format("The surface has {} kinds of faults.", check["faults"].size());
}

std::string tiles_of(const json& check, const json& preflight) {
    const json& surface = check["surface"];
    std::string html = "<div class=\"tiles\">" +
                       check_tile(fmt::format("{}", surface["triangles"].get<long>()), "triangles of the surface") +
                       check_tile(check["faults"].empty() ? "sound" : "faulty", "surface");
    if (check.contains("set")) {
        html += check_tile(fmt::format("{}", check["set"]["states"].get<long>()), "states") +
                check_tile(fmt::format("{}", check["set"]["markers"].get<long>()), "markers");
    }
    if (!preflight.is_null()) {
        html +=
            check_tile(
                fmt::format("{} of {}", preflight["independent"].get<long>(), preflight["coordinates"].get<long>()),
                "independent among measured coordinates") +
            check_tile(mm(preflight["noise_mm"]),
                       preflight["noise_known"].get<bool>() ? "noise, declared" : "noise, assumed: 1 % of the motion") +
            check_tile(mm(preflight["moved_mm"]), "measured displacement, rms") +
            check_tile(mm(preflight["nuisance_mm"]), "uncertainty from contacts and clamps, rms");
    }
    return html + "</div>";
}

std::string words_of_effect(const json& one) {
    std::string words;
    if (const auto effect = identify::effect_named(one["effect"])) words = escape(effect->description().meaning);
    const std::string why = one["why_not"].get<std::string>();
    const auto confused = one["confused_with"].get<std::vector<std::string>>();
    if (!why.empty()) {
        words += "<br><b>Why not:</b> " + prose(why) + ".";
    } else if (!confused.empty()) {
        words += "<br><span class=\"soft\">Could be mistaken for " + escape(listed(confused)) + ".</span>";
    }
    const json &easiest = one["easiest"]["own"], &usual = one["least"]["own"];
    const std::string effect = one["effect"];
    if (is_within_reach(one) && !easiest.is_null() && !usual.is_null() &&
        own_strength(easiest, effect) != own_strength(usual, effect))
        words += "<br><span class=\"soft\">Where it shows best: " + prose(own_strength(easiest, effect)) + ".</span>";
    return words;
}

std::string effects_table(const json& preflight) {
    // First what could be named, of that what shows most easily.
    std::vector<const json*> order;
    for (const json& one : preflight["effects"]) order.push_back(&one);
    std::ranges::stable_sort(order, {}, [](const json* one) {
        const json& least = (*one)["least"]["of_prior"];
        return std::pair(-(*one)["share"].get<double>(), least.is_number() ? least.get<double>() : INFINITY);
    });
    std::string rows;
    for (const json* effect : order) {
        const json &one = *effect, &least = one["least"];
        const bool is_reached = is_within_reach(one);
        const std::string named = one["can_be_named"];
        rows +=
            fmt::format("<tr{}><td>{}</td>", named == "yes" || named == "mostly" ? " class=\"claimed\"" : "",
                        escape(one["effect"].get<std::string>())) +
            data_cell("could be named",
                      named == "partly" ? fmt::format("partly, {:.0f} %", 100 * one["share"].get<double>()) : named) +
            data_cell("from", threshold_in_words(one)) +
            data_cell("of its prior", is_reached ? fmt::format("{:.2g}", least["of_prior"].get<double>()) : "–") +
            data_cell("trace, rms", is_reached ? mm(least["rms_mm"]) : "–") +
            data_cell("in sigmas", is_reached && least["rms_sigma"].is_number()
                                       ? fmt::format("{:.2g}", least["rms_sigma"].get<double>())
                                       : "–") +
            "<td class=\"words\">" + words_of_effect(one) + "</td></tr>";
    }
    return "<div class=\"wide\" tabindex=\"0\"><table class=\"cards\"><thead><tr><th>effect</th><th>could be "
           "named</th><th>from</th>"
           "<th>of its prior</th><th>trace, rms</th><th>in σ</th><th class=\"words\">in "
           "words</th></tr></thead><tbody>" +
           rows + "</tbody></table></div>";
}

std::string effects_section(const json& preflight) {
    return "<h2 id=\"effects\">What could be named</h2><p>The strength from which each effect would be named, ahead of "
           "all others and beyond what is uncertain about contacts and clamps, by the rules of the diagnosis; and "
           "the trace that it then leaves in the readings. Effects with a place or a direction are evaluated for forty "
           "of them; the strength stated is sufficient in half of these.</p>" +
           effects_table(preflight);
}

std::string parameters_section(const json& preflight) {
    std::string html;
    for (const std::string& sentence : parameter_sentences(preflight)) html += "<li>" + prose(sentence) + "</li>";
    return "<h2 id=\"parameters\">Which parameters it would determine</h2><ul>" + html + "</ul><p class=\"soft\">" +
           fmt::format("Judged at E&nbsp;=&nbsp;{:.3g}&nbsp;MPa, {}, before any fit.",
                       preflight["guess"]["young_mpa"].get<double>(),
                       preflight["guess"]["from"] == "set" ? "the set's first guess"
                                                           : "at which a linear body moves as far as was measured") +
           "</p>";
}

/// Where markers stand, as far as that is in order: nothing where there are none.
std::string markers_in_words(const identify::MeasurementSet& set) {
    constexpr double on = 1e-3;  // of the longest side: what rounding and the surface's own facets leave
    const mesh::SurfaceTree tree(set.rest_surface);
    const double most = on * mesh::bounding_box(set.rest_surface.vertices).longest_side();
    long off = 0;
    double farthest = 0;
    for (const identify::Marker& marker : set.markers) {
        constexpr double half = 0.5;  // windings: 1 inside, 0 outside
        const double distance = tree.closest(marker.rest).distance;
        if (marker.anchor || distance <= most || mesh::winding_number(set.rest_surface, marker.rest) > half) continue;
        ++off;
        farthest = std::max(farthest, distance);
    }
    if (set.markers.empty()) return ".";
    if (off == 0) return ", and every marker is on, in, or attached to the body.";
    return fmt::format(". {} off the surface by up to {:.2g} mm, attached to nothing.",
                       mesh::count_of(off, "marker stands", "markers stand"), farthest);
}

std::string readings_section(const json& preflight, const identify::MeasurementSet& set) {
    const json &odd = preflight["suspicions"], &repeats = preflight["repeats"];
    std::string html = "<h2 id=\"readings\">Which readings look off</h2>";
    html += odd.empty() ? "<p>None: readings agree with their neighbours" + markers_in_words(set) + "</p>" : items(odd);
    html += "<h2 id=\"repeats\">Which states repeat</h2>";
    return html + (repeats.empty() ? "<p>None. Repeats determine the noise, and whether the body comes back.</p>"
                                   : items(repeats));
}

std::string gain_words(const json& experiment) {
    const auto opens = experiment["opens"].get<std::vector<std::string>>();
    std::string words = opens.empty() ? "" : "<b>Shows " + escape(listed(opens)) + ".</b> ";
    std::string eased;
    for (const json& gain : experiment["gains"]) {
        const std::string effect = gain["effect"];
        if (std::ranges::find(opens, effect) != opens.end()) continue;
        const json &before = gain["least_before"], &after = gain["least_after"];
        const std::string by =
            before.is_number() && after.is_number()
                ? fmt::format(" (at {:.0f} % of today's threshold)", 100 * after.get<double>() / before.get<double>())
            : after.is_number() ? fmt::format(" (from {:.2g} of its prior)", after.get<double>())
                                : fmt::format(" (in {:.0f} % of the cases)", 100 * gain["share_after"].get<double>());
        eased += (eased.empty() ? "" : ", ") + escape(effect) + by;
    }
    return words + (eased.empty() ? "" : "<span class=\"soft\">Easier to identify: " + eased + ".</span>");
}

std::string experiments_section(const json& preflight) {
    std::string rows;
    for (const json& one : preflight["experiments"]) {
        rows += "<tr><td class=\"words\">" + prose(one["words"].get<std::string>()) + ".</td>" +
                data_cell("states", std::to_string(one["states"].get<long>())) + "<td class=\"words\">" +
                gain_words(one) + "</td></tr>";
    }
    if (rows.empty())
        return "<h2 id=\"next\">What the next hour in the lab should bring</h2><p>Nothing that was tried would show "
               "much more.</p>";
    return "<h2 id=\"next\">What the next hour in the lab should bring</h2><p>Each was added to the set with readings "
           "of all "
           "markers, as noisy as the set's, and the effects were judged again; the best comes first.</p><div "
           "class=\"wide\" tabindex=\"0\">"
           "<table class=\"cards\"><thead><tr><th class=\"words\">do</th><th>states</th><th class=\"words\">it "
           "brings</th></tr></thead><tbody>" +
           rows + "</tbody></table></div>";
}

std::string files_section(const json& check) {
    std::string html = "<h2 id=\"body\">Body, supports, assumptions</h2>";
    json words = check["faults"];
    for (const json& held : check.value("supports", json::array()))
        words.push_back("Held by " + held["words"].get<std::string>() + ".");
    for (const char* key : {"warnings", "notes", "assumptions"})
        for (const json& one : check.value(key, json::array())) words.push_back(one);
    for (const json& one : check.value("set_words", json::array())) words.push_back(one);
    return html + items(words);
}

std::string cost_section(const json& cost) {
    if (cost.is_null()) return "";
    std::string rows;
    for (const json& stage : cost["stages"])
        rows += "<tr><th scope=\"row\">" + escape(stage["stage"].get<std::string>()) + "</th>" +
                data_cell("time", duration_in_words(stage)) +
                data_cell("memory", fmt::format("{:.2g} GB", stage["gigabytes"].get<double>())) +
                data_cell("solver", stage["solver"].get<std::string>()) + "</tr>";
    return "<h2 id=\"cost\">What a run would take</h2><p>" + prose(cost_lead(cost)) +
           R"(</p><div class="scroll" tabindex="0"><table><thead><tr><th>stage</th><th>time</th><th>memory</th>)"
           "<th>solver</th></tr></thead><tbody>" +
           rows + "</tbody></table></div>";
}

}  // namespace

void write_check_page(const std::filesystem::path& page, const Subject& subject, const json& check) {
    const json preflight = check.value("preflight", json());
    const std::string name =
        "Check of " + (subject.set && !subject.set->name.empty() ? subject.set->name : subject.settings.name);
    std::string sections;
    if (!preflight.is_null())
        sections = effects_section(preflight) + experiments_section(preflight) +
                   readings_section(preflight, *subject.set) + parameters_section(preflight);
    sections += files_section(check) + cost_section(check.value("cost", json()));
    mesh::write_text(page, page_head(name, page_style) + "<body><main><h1>" + escape(name) + "</h1>" +
                               std::string(check_view) + "<script id=\"check-data\" type=\"application/json\">" +
                               as_script_data(check_picture(subject, preflight)) + "</script><script>" +
                               std::string(check_script) + "</script><p class=\"lead\">" +
                               prose(lead(check, preflight)) + "</p>" + tiles_of(check, preflight) +
                               section_links(sections) + sections + "</main></body></html>\n");
}

}  // namespace palpate::pipeline
