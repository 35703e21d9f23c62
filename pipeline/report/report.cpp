#include "pipeline/report/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "mesh/errors.h"
#include "mesh/io/atomic_file.h"
#include "pipeline/report/charts.h"
#include "pipeline/report/escape.h"
#include "pipeline/report/inquiry_sections.h"
#include "pipeline/report/page.h"
#include "pipeline/report/picture.h"
#include "pipeline/results/compare_words.h"
#include "pipeline/results/diagnosis_words.h"
#include "pipeline/results/posterior_file.h"
#include "skeleton/model_io.h"

namespace palpate::pipeline {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// All that a page is made of, read from the run folder.
struct RunFiles {
    json record, compare;
    json diagnosis, ladder;  // null where the run did not ask
    std::string settings;
    std::vector<identify::PosteriorRow> posterior;
    skeleton::Model model;
};

json read_json(const fs::path& file) {
    try {
        return json::parse(mesh::read_text(file));
    } catch (const json::exception& e) {
        throw InvalidInput(fmt::format("{}: is no JSON: {}", file.string(), e.what()));
    }
}

json read_if_there(const fs::path& file) { return fs::exists(file) ? read_json(file) : json(); }

RunFiles read_run(const fs::path& run) {
    return {read_json(run / "run.json"),
            read_json(run / "compare/compare.json"),
            read_if_there(run / "diagnose/diagnosis.json"),
            read_if_there(run / "improve/ladder.json"),
            mesh::read_text(run / "case.yaml"),
            read_posterior(run / "identify/posterior.csv"),
            skeleton::read_model(run / "identify/model.json")};
}

/// The verdict, or where nobody asked for it how wrong the model is.
std::string lead(const RunFiles& files) {
    return files.diagnosis.is_null() ? compare_in_words(files.compare) : diagnosis_in_words(files.diagnosis);
}

std::string percent(const json& relative) {
    return relative.is_number() ? fmt::format("{:.1f} %", 100 * relative.get<double>()) : "unknown";
}

std::string tile(const std::string& value, const std::string& what) {
    return fmt::format(R"(<div class="tile"><b>{}</b>{}</div>)", escape(value), escape(what));
}

std::string tiles(const RunFiles& files) {
    const auto held =
        std::count_if(files.model.spheres.begin(), files.model.spheres.end(), [](auto& s) { return s.held; });
    const auto informed =
        std::count_if(files.posterior.begin(), files.posterior.end(), [](auto& r) { return r.informed; });
    return "<div class=\"tiles\">" +
           (files.diagnosis.is_null() ? "" : tile(files.diagnosis["verdict"].get<std::string>(), "verdict")) +
           tile(percent(files.compare["error"]["relative"]), "rms error over rms displacement") +
           tile(fmt::format("{:.3g} mm", files.compare["error"]["max_mm"].get<double>()), "largest error") +
           tile(fmt::format("{} + {}", files.model.spheres.size() - held, held), "spheres, free + held") +
           tile(std::to_string(files.model.links.size()), "links") +
           tile(fmt::format("{} of {}", informed, files.posterior.size()), "stiffnesses informed by the data") +
           tile(skeleton::law_names[static_cast<std::size_t>(files.model.law)], "law that the model plays by") +
           "</div>";
}

std::string pictures(const RunFiles& files) {
    std::vector<Dot> dots;
    for (const json& m : files.compare["markers"]) {
        dots.push_back({{m["at"][0].get<double>(), m["at"][1].get<double>(), m["at"][2].get<double>()},
                        m["rms_mm"].get<double>(),
                        m.value("strange", false)});
    }
    const bool strange = std::ranges::any_of(dots, [](const Dot& dot) { return dot.strange; });
    return "<div class=\"pair\"><figure>" + skeleton_picture(files.model) +
           "<figcaption class=\"soft\">Spheres and links; spheres that are held in "
           "orange.</figcaption></figure><figure>" +
           dot_picture(files.model, dots, "mm") + "<figcaption class=\"soft\">Where the model is wrong." +
           (strange ? " Orange rings: finite elements do not explain it either." : "") + "</figcaption></figure></div>";
}

std::string probe_chart(const RunFiles& files) {
    const json held_out = files.record.value("held_out_probes", json::array());
    std::vector<Bar> rms, relative;
    for (const json& p : files.compare["probes"]) {
        const bool kept = std::find(held_out.begin(), held_out.end(), p["probe"]) != held_out.end();
        const std::string label = fmt::format("probe {}, time {:g}{}", p["probe"].get<int>(), p["time"].get<double>(),
                                              kept ? ", held out" : "");
        rms.push_back({label, p["rms_mm"].get<double>(), kept});
        if (p["relative"].is_number()) relative.push_back({label, 100 * p["relative"].get<double>(), kept});
    }
    return "<div class=\"pair\">" + bar_chart(rms, "Error of each state", "mm rms") +
           bar_chart(relative, "Error over displacement of each state", "%") + "</div>" +
           (held_out.empty() ? "" : "<p class=\"soft\">Orange: kept from the fit.</p>");
}

/// Intervals of up to so many parameters, those that the data inform first.
std::string posterior_charts(const RunFiles& files) {
    constexpr std::size_t most = 24;
    std::map<std::string, std::vector<Interval>> by_unit;
    std::vector<const identify::PosteriorRow*> rows;
    for (const auto& row : files.posterior) rows.push_back(&row);
    std::stable_sort(rows.begin(), rows.end(), [](auto* a, auto* b) { return a->informed > b->informed; });
    for (const auto* row : rows) {
        auto& list = by_unit[row->unit];
        if (list.size() == most || row->q025 <= 0) continue;
        list.push_back({row->parameter, row->q025, row->mean, row->q975, row->prior_mean - 2 * row->prior_sd,
                        row->prior_mean + 2 * row->prior_sd});
    }
    std::string html = "<div class=\"pair\">";
    for (const auto& [unit, list] : by_unit) html += interval_chart(list, "Identified stiffness", unit);
    html += "</div><p class=\"soft\">Blue: 95 % of the posterior, with its mean. Grey: prior.";
    if (files.posterior.size() > 2 * most) html += " The best informed ones; all are in identify/posterior.csv.";
    return html + "</p>";
}

std::string stage_table(const RunFiles& files) {
    std::string rows;
    for (const char* stage : {"mesh", "skeleton", "measurements", "identify", "diagnose", "compare", "improve"}) {
        if (!files.record["stages"].contains(stage)) continue;
        const json& s = files.record["stages"][stage];
        std::string figures;
        for (const auto& [key, value] : s["figures"].items()) {
            if (!value.is_number() && !value.is_string()) continue;
            figures += figures.empty() ? "" : ", ";
            figures +=
                key + " " + (value.is_number() ? fmt::format("{:.4g}", value.get<double>()) : value.get<std::string>());
        }
        rows += fmt::format("<tr><td>{}</td><td>{:.1f}</td><td>{:.0f}</td><td style=\"text-align:left\">{}</td></tr>",
                            stage, s["seconds"].get<double>(), s["peak_memory_mb"].get<double>(), escape(figures));
    }
    return "<table><tr><th>stage</th><th>seconds</th><th>peak MB</th><th style=\"text-align:left\">figures</th></tr>" +
           rows + "</table>";
}

std::string assumption_list(const RunFiles& files) {
    std::string items;
    for (const json& a : files.record.value("assumptions", json::array()))
        items += "<li>" + escape(a.get<std::string>()) + "</li>";
    for (const json& n : files.record["stages"]["identify"]["figures"].value("notes", json::array())) {
        items += "<li>" + escape(n.get<std::string>()) + "</li>";
    }
    for (const json* asked : {&files.diagnosis, &files.ladder}) {
        if (asked->is_null()) continue;
        for (const json& n : (*asked)["notes"]) items += "<li>" + escape(n.get<std::string>()) + "</li>";
    }
    return items.empty() ? "" : "<h2>Assumed and noted</h2><ul>" + items + "</ul>";
}

}  // namespace

void write_report(const fs::path& run, const fs::path& page) {
    const RunFiles files = read_run(run);
    const std::string name = escape(files.model.name.empty() ? run.filename().string() : files.model.name);
    std::string html =
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
        "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">"
        "<meta name=\"generator\" content=\"palpate\"><title>" +
        name + "</title><style>" + page_style + "</style></head><body><h1>" + name + "</h1><p class=\"lead\">" +
        escape(lead(files)) + "</p>" + tiles(files);
    html += missing_section(files.diagnosis) + ladder_section(files.ladder) + budget_section(files.compare);
    html += "<h2>Model</h2>" + pictures(files);
    html += "<h2>Error</h2><p>" + escape(compare_in_words(files.compare)) + "</p>" + probe_chart(files);
    html += "<h2>Stiffness</h2>" + posterior_charts(files) + assumption_list(files);
    html += "<h2>Stages</h2>" + stage_table(files);
    html += "<h2>Settings</h2><pre>" + escape(files.settings) + "</pre><p class=\"soft\">palpate " +
            escape(files.record.value("version", "")) + "</p></body></html>\n";
    mesh::write_text(page, html);
}

}  // namespace palpate::pipeline
