#include "pipeline/output/html/sections/error_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <vector>

#include "pipeline/output/html/charts/charts.h"
#include "pipeline/output/html/charts/picture.h"
#include "pipeline/output/html/escape.h"
#include "pipeline/output/text/comparison/comparison.h"
#include "pipeline/output/text/comparison/worst.h"
#include "pipeline/output/text/words.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

std::string figure(const std::string& picture, const std::string& words) {
    return "<figure>" + picture + "<figcaption class=\"soft\">" + words + "</figcaption></figure>";
}

std::string pictures(const RunFiles& files) {
    double highest = 0;
    for (const Dot& dot : files.errors_before) highest = std::max(highest, dot.value);
    const bool strange = std::ranges::any_of(files.errors_before, [](const Dot& dot) { return dot.strange; });
    std::string html =
        "<div class=\"pair\">" + figure(skeleton_picture(files.model), "Spheres and links. Orange: held spheres.");
    if (!reads_positions(files.compare)) return html + "</div>";  // the others are of markers
    html += figure(dot_picture(files.model, files.errors_before, highest, "mm"),
                   std::string("Marker errors") + (files.errors_after.empty() ? "." : ", baseline.") +
                       (strange ? " Orange ring: the finite-element model does not explain the error either." : ""));
    if (!files.errors_after.empty()) {
        const auto effects = files.ladder["steps"].back()["effects"].get<std::vector<std::string>>();
        html += figure(dot_picture(files.model, files.errors_after, highest, "mm"),
                       "Marker errors with " + listed(effects) + ", on the same scale.");
    }
    return html + "</div>";
}

/// Errors of the states, of compare.json's "probes"; `share`: over their displacements.
std::vector<Bar> error_bars(const RunFiles& files, const json& compare, bool share) {
    const json held_out = files.record.value("held_out_probes", json::array());
    std::vector<Bar> bars;
    const auto add = [&](const json& p, const json& value, double factor) {
        const bool kept = std::find(held_out.begin(), held_out.end(), p["probe"]) != held_out.end();
        const std::string label = fmt::format("probe {}, time {:g}{}", p["probe"].get<int>(), p["time"].get<double>(),
                                              kept ? ", held out" : "");
        if (value.is_number()) bars.push_back({label, factor * value.get<double>(), kept});
    };
    for (const json& p : compare["probes"]) add(p, share ? p["relative"] : p["rms_mm"], share ? 100 : 1);
    if (compare["probes"].empty() && !share)
        for (const json& force : compare.value("tool_forces", json::array())) add(force, force["error_n"], 1);
    return bars;
}

/// 1 sigma of the readings [mm].
std::optional<double> noise_of(const json& compare) {
    const json& noise = compare["error"]["noise_mm"];
    if (!noise.is_number()) return std::nullopt;
    return noise.get<double>();
}

std::string probe_chart(const RunFiles& files) {
    const bool held_out = !files.record.value("held_out_probes", json::array()).empty();
    const std::optional<double> noise = noise_of(files.compare);
    const char* unit = reads_positions(files.compare) ? "mm rms" : "N";
    std::string html = "<div class=\"pair\">";
    if (files.improved.is_object()) {
        html += bar_chart(error_bars(files, files.compare, false), "Error of each state, nothing added", unit, noise) +
                bar_chart(error_bars(files, files.improved, false), "Error of each state, " + with_what(files), unit,
                          noise);
    } else {
        html += bar_chart(error_bars(files, files.compare, false), "Error of each state", unit, noise) +
                bar_chart(error_bars(files, files.compare, true), "Error over displacement of each state", "%");
    }
    return html + "</div>" + (held_out ? "<p class=\"soft\">Orange: held out of the fit.</p>" : "");
}

/// "forces [N]": what acts in the states of a comparison; "" where that is not one thing, or nothing.
std::string load_axis(const json& compare) {
    std::set<std::string> axes;
    for (const json& p : compare["probes"]) {
        const json load = p.value("load", json());
        if (!load.is_object()) return {};
        if (load["unit"].is_string())
            axes.insert(fmt::format("{} [{}]", load["by"].get<std::string>(), load["unit"].get<std::string>()));
    }
    return axes.size() == 1 ? *axes.begin() : "";
}

/// The error of each state over how much acts in it.
ChartLine errors_under_load(const json& compare, const std::string& label) {
    ChartLine dots{.label = label, .points = {}, .drawn = ChartLine::Drawn::dots};
    for (const json& p : compare["probes"]) {
        const json load = p.value("load", json());
        if (load.is_object()) dots.points.emplace_back(load["value"].get<double>(), p["rms_mm"].get<double>());
    }
    return dots;
}

/// The noise over all loads of some errors.
ChartLine noise_line(const ChartLine& errors, double noise) {
    const auto [least, most] = std::ranges::minmax(errors.points);
    return {.label = "noise", .points = {{least.first, noise}, {most.first, noise}}, .drawn = ChartLine::Drawn::line};
}

/// Whether the error comes with the load: there without any, in proportion, or faster.
std::string load_chart(const RunFiles& files) {
    const std::string axis = load_axis(files.compare);
    if (axis.empty()) return {};
    std::vector<ChartLine> curves{errors_under_load(files.compare, "nothing added")};
    if (files.improved.is_object()) curves.push_back(errors_under_load(files.improved, with_what(files)));
    if (const auto noise = noise_of(files.compare); noise && !curves.front().points.empty())
        curves.push_back(noise_line(curves.front(), *noise));
    const std::string chart = line_chart(curves, "Error of each state over its load [mm rms]", axis);
    if (chart.empty()) return {};
    std::string words =
        "An error that is present without load does not come from stiffness; one in proportion to the load does; one "
        "that grows faster indicates a nonlinearity.";
    // With an effect in, the model moves without load, too: its exponent is not about what acts alone.
    if (const json exponent = files.compare.value("load_exponent", json());
        exponent.is_object() && !files.compare["adequate"].get<bool>())
        words += " Baseline: " + prose(exponent["words"].get<std::string>()) + ".";
    return "<div class=\"pair\">" + figure(chart, words) + "</div>";
}

/// The worst probes and markers, and the part of the body, as compare prints them.
std::string worst_section(const json& compare) {
    const std::string table = worst_table(compare);
    return table.empty() ? "" : "<pre class=\"table\" tabindex=\"0\">" + escape(table) + "</pre>";
}

}  // namespace

std::string error_section(const RunFiles& files) {
    std::string html = "<h2 id=\"errors\">Remaining error</h2>";
    if (files.improved.is_object()) {
        html += "<p>" +
                prose(compare_in_words(files.improved,
                                       "The real-time model " + with_what(files) + ", fitted to all probes,")) +
                "</p>" + worst_section(files.improved);
    } else {
        if (!files.diagnosis.is_null()) html += "<p>" + prose(compare_in_words(files.compare)) + "</p>";
        html += worst_section(files.compare);
    }
    return html + "<div class=\"aside\">" + pictures(files) + probe_chart(files) + load_chart(files) + "</div>";
}

}  // namespace palpate::pipeline
