#include "pipeline/output/html/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "mesh/text/atomic_file.h"
#include "pipeline/output/html/charts/svg.h"
#include "pipeline/output/html/escape.h"
#include "pipeline/output/html/page/page_parts.h"
#include "pipeline/output/html/page_frame.h"
#include "pipeline/output/html/run_files.h"
#include "pipeline/output/html/sections/damping_section.h"
#include "pipeline/output/html/sections/diagnosis_sections.h"
#include "pipeline/output/html/sections/error_section.h"
#include "pipeline/output/html/sections/fit_sections.h"
#include "pipeline/output/html/sections/stiffness_section.h"
#include "pipeline/output/html/view_data.h"
#include "pipeline/output/text/comparison/comparison.h"
#include "pipeline/output/text/diagnosis.h"
#include "pipeline/output/text/words.h"

namespace palpate::pipeline {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// The verdict, or where there is none how wrong the model is. Effects that were added without being named are said.
std::string lead(const RunFiles& files) {
    if (files.diagnosis.is_null()) return compare_in_words(files.compare);
    std::string words = diagnosis_in_words(files.diagnosis);
    std::vector<std::string> unnamed = added_effects(files);
    for (const json& effect : files.diagnosis["explanation"]) {
        const auto named = std::ranges::find(unnamed, effect.get<std::string>());
        if (named != unnamed.end()) unnamed.erase(named);
    }
    if (!unnamed.empty())
        words +=
            fmt::format(" The model below was improved with {}, which this diagnosis does not name.", listed(unnamed));
    return words;
}

std::string share_of(const json& relative) {
    if (!relative.is_number()) return "unknown";
    const double share = relative.get<double>();
    return share < 10 ? percent(share) : fmt::format("{:.0f} times", share);
}

std::string tile(const std::string& value, const std::string& what) {
    return fmt::format(R"(<div class="tile"><b>{}</b>{}</div>)", prose(value), prose(what));
}

/// "2.6 → 0.63": before and after what was added, where something was.
std::string before_and_after(const RunFiles& files, double before, const char* key) {
    if (!files.improved.is_object()) return fmt::format("{:.3g}", before);
    const json& steps = files.ladder["steps"];
    return fmt::format("{:.3g} → {:.3g}", steps.front()[key].get<double>(), steps.back()[key].get<double>());
}

/// How far the real-time model is off: by the positions, or by the forces of tools where these alone were read.
std::string error_tiles(const RunFiles& files) {
    const bool forces_alone = !reads_positions(files.compare);
    const json& error = files.compare["error"];
    const json& relative = files.improved.is_object() ? files.improved["error"]["relative"] : error["relative"];
    const std::string added = files.improved.is_object() ? ", " + with_what(files) : "";
    const std::string value =
        forces_alone ? before_and_after(files, error["reactions"]["rms_n"].get<double>(), "reactions_rms_n") + " N"
                     : before_and_after(files, error["rms_mm"].get<double>(), "rms_mm") + " mm";
    std::string html = tile(
        value,
        (forces_alone ? "rms error of tools' forces, real-time model" : "rms error of the real-time model") + added);
    if (const json& noise = error["noise_mm"]; noise.is_number())
        html += tile(fmt::format("{:.2g} mm", noise.get<double>()), "measurement noise, rms");
    return html + tile(share_of(relative),
                       (forces_alone ? "rms error over rms force" : "rms error over rms displacement") + added);
}

/// The material that finite elements come to, of the last step.
std::string material_tiles(const RunFiles& files) {
    const json& fit = files.improved.is_object() ? files.improved["baseline"] : files.compare["baseline"];
    if (!fit.is_object()) return {};
    json body = fit;
    body.erase("regions");
    const std::string words = material_in_words(body), of = " (finite elements), " + with_what(files);
    const std::size_t ratio = words.find(", ν");
    std::string html = tile(words.substr(0, ratio), "Young's modulus" + of);
    if (ratio != std::string::npos) html += tile(words.substr(ratio + 2), "Poisson's ratio");
    for (const json& region : fit.value("regions", json::array()))
        html += tile(region_in_words(region), "Young's modulus of '" + region["name"].get<std::string>() + "'" + of);
    return html;
}

/// A name of the files as words: "missing effect".
std::string with_spaces(std::string name) {
    for (const char joint : {'-', '_'}) std::ranges::replace(name, joint, ' ');
    return name;
}

/// The verdict, with the effects that it names.
std::string verdict_tile(const json& diagnosis) {
    const auto named = diagnosis["verdict"] == "missing-effect"
                           ? diagnosis["explanation"].get<std::vector<std::string>>()
                           : std::vector<std::string>{};
    return tile(with_spaces(diagnosis["verdict"].get<std::string>()),
                named.empty() ? "verdict" : "verdict: " + listed(named));
}

std::string tiles(const RunFiles& files) {
    const auto held =
        std::count_if(files.model.spheres.begin(), files.model.spheres.end(), [](auto& s) { return s.held; });
    const auto informed =
        std::count_if(files.posterior.begin(), files.posterior.end(), [](auto& r) { return r.informed; });
    std::string html = "<div class=\"tiles\">";
    if (!files.diagnosis.is_null()) html += verdict_tile(files.diagnosis);
    return html + error_tiles(files) + material_tiles(files) +
           tile(fmt::format("{} + {}", files.model.spheres.size() - held, held), "spheres, free + held") +
           tile(std::to_string(files.model.links.size()), "links") +
           tile(fmt::format("{} of {}", informed, files.posterior.size()),
                "stiffnesses constrained by the data" + (files.improved.is_object() ? ", " + with_what(files) : "")) +
           "</div>" +
           (reads_positions(files.compare)
                ? "<p class=\"soft\">Rms errors are per coordinate; largest errors are distances.</p>"
                : "");
}

/// What a print-out of one page leaves out.
std::string aside(const std::string& html) { return html.empty() ? "" : "<div class=\"aside\">" + html + "</div>"; }

/// A figure of a stage, whose name may end in its unit: "volume 90 000 mm³".
std::string figure_in_words(std::string name, const json& value) {
    std::string unit;
    for (const auto& [ending, printed] : {std::pair{"_mm3", " mm³"}, {"_mm", " mm"}, {"_n", " N"}}) {
        if (!name.ends_with(ending)) continue;
        name.resize(name.size() - std::string_view(ending).size());
        unit = printed;
    }
    if (!value.is_number()) return with_spaces(name) + " " + value.get<std::string>();
    const int digits = value.is_number_integer() ? 9 : 4;  // counts come in whole
    return with_spaces(name) + " " + plain_number(value.get<double>(), digits) + unit;
}

std::string stage_table(const RunFiles& files) {
    std::string rows;
    for (const char* stage :
         {"mesh", "skeleton", "measurements", "identify", "diagnose", "compare", "improve", "sphere_curve"}) {
        if (!files.record["stages"].contains(stage)) continue;
        const json& s = files.record["stages"][stage];
        std::string figures;
        for (const auto& [key, value] : s["figures"].items()) {
            if (!value.is_number() && !value.is_string()) continue;
            figures += figures.empty() ? "" : ", ";
            figures += figure_in_words(key, value);
        }
        rows += fmt::format("<tr><td>{}</td><td>{:.1f}</td><td>{:.0f}</td><td style=\"text-align:left\">{}</td></tr>",
                            stage, s["seconds"].get<double>(), s["peak_memory_mb"].get<double>(), escape(figures));
    }
    return "<div class=\"wide\" tabindex=\"0\"><table><tr><th>stage</th><th>seconds</th><th>peak MB</th><th "
           "style=\"text-align:left\">figures</th></tr>" +
           rows + "</table></div>";
}

std::string assumption_list(const RunFiles& files) {
    std::string items;
    for (const json& a : files.record.value("assumptions", json::array()))
        items += "<li>" + prose(a.get<std::string>()) + "</li>";
    const json skeleton = files.record["stages"].value("skeleton", json::object());
    for (const json& note : skeleton.value(json::json_pointer("/figures/notes"), json::array()))
        items += "<li>" + prose(note.get<std::string>()) + "</li>";
    const std::string of_model = files.best == "improve" ? "The model " + with_what(files) + ": " : "";
    for (const std::string& note : files.notes) items += "<li>" + prose(of_model + note) + "</li>";
    for (const json* asked : {&files.diagnosis, &files.ladder}) {
        if (asked->is_null()) continue;
        for (const json& n : (*asked)["notes"]) items += "<li>" + prose(n.get<std::string>()) + "</li>";
    }
    return items.empty() ? "" : "<h2 id=\"noted\">Assumed and noted</h2><ul>" + items + "</ul>";
}

std::string view_section(const RunFiles& files, const fs::path& run) {
    const json data = view_data(run, files.record, files.compare, files.ladder, files.diagnosis, files.posterior);
    if (data.is_null()) {
        return "<p class=\"soft\">This run was made by an older palpate: run it again to turn the body here.</p>";
    }
    std::string html(page_view);
    if (const auto left_out = data["left_out"].get<std::size_t>(); left_out > 0) {
        html += fmt::format(
            "<p class=\"soft\">{} of {} states are here, those with the largest errors; all are in the run folder.</p>",
            data["states"].size(), data["states"].size() + left_out);
    }
    return html + "<script id=\"run-data\" type=\"application/json\">" + with_printed_units(as_script_data(data)) +
           "</script><script>" + std::string(page_script) + "</script>";
}

/// What to open next, and what to type.
std::string file_section(const RunFiles& files) {
    const bool improved = files.best == "improve";
    // What forces move can be asked of it; a rig's poses stand in no table of forces.
    const bool has_forces = std::ranges::any_of(files.compare["probes"], [](const json& probe) {
        return probe.value(json::json_pointer("/load/by"), "") == "forces";
    });
    const std::string command = has_forces
                                    ? "palpate simulate " + files.best + "/model.json --probes probes.csv -o played"
                                    : "palpate play " + files.best + "/model.json";
    std::string html =
        "<h2 id=\"files\">Files</h2><ul><li><code>" + files.best + "/model.json</code> is the model to use" +
        (improved ? ", with what was missing added" : "") + ": <code>" + command +
        "</code></li><li><code>paraview --script=view.py</code> opens the run "
        "in "
        "ParaView</li><li><code>" +
        files.best + "/posterior.csv</code> holds every stiffness with its interval, <code>" +
        (improved
             ? "improve/compare.json</code> every error of this model, <code>compare/compare.json</code> those of the "
               "baseline</li>"
             : "compare/compare.json</code> every error</li>");
    if (improved)
        html += "<li><code>improve/ladder.pvd</code>: the errors at each step of the ladder, as an animation</li>";
    if (files.quality.is_null())
        html += "<li><code>palpate run ... --sphere-curve</code> measures what fewer and more spheres would do</li>";
    return html + "<li><code>palpate info .</code> in the run folder lists its files</li></ul>";
}

}  // namespace

void write_report(const fs::path& run, const fs::path& page) {
    const RunFiles files = read_run(run);
    const std::string name = files.model.name.empty() ? run.filename().string() : files.model.name;
    std::string sections = aside(missing_section(files.diagnosis)) + ladder_section(files.ladder, files.compare) +
                           aside(budget_section(files.compare, files.improved)) + error_section(files);
    std::string more = stiffness_section(files.posterior, files.particles, files.prior, files.best + "/posterior.csv") +
                       damping_section(run / files.best) + convergence_section(run / "identify/convergence.csv") +
                       spheres_section(files.quality) + assumption_list(files) + file_section(files);
    more +=
        "<h2 id=\"times\">Times</h2><p class=\"soft\">The stages identify and compare used the model without added "
        "effects.</p>" +
        stage_table(files);
    more +=
        "<h2 id=\"settings\">Settings</h2><details open><summary>case.yaml: every setting, defaults included"
        "</summary><pre tabindex=\"0\">" +
        escape(files.settings) + "</pre></details>";
    sections += aside(more) + "<p class=\"soft\">palpate " + escape(files.record.value("version", "")) +
                fmt::format(", seed {}", files.record.value("seed", json()).dump()) + "</p>";
    mesh::write_text(page, page_head(name, page_style) + "<body><main><h1>" + escape(name) + "</h1><p class=\"lead\">" +
                               prose(lead(files)) + "</p>" + tiles(files) + view_section(files, run) +
                               section_links(sections) + sections + "</main></body></html>\n");
}

}  // namespace palpate::pipeline
