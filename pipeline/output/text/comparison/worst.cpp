#include "pipeline/output/text/comparison/worst.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "pipeline/output/text/words.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

constexpr std::size_t most_listed_rows = 4;  // of probes, and of markers

/// The entries with the largest errors, largest first; `error`: their key.
std::vector<json> worst_of(const json& entries, const char* error) {
    std::vector<json> worst;
    for (const json& entry : entries)
        if (entry[error].is_number()) worst.push_back(entry);
    std::ranges::stable_sort(worst, std::greater{}, [&](const json& e) { return e[error].get<double>(); });
    worst.resize(std::min(worst.size(), most_listed_rows));
    return worst;
}

std::string where(const json& at, const json& compare) {
    if (!at.is_array()) return "no load";
    const std::string part = compare.contains("box") ? part_of_body(at, compare["box"]) : "";
    return part.empty() ? place(at) + " mm" : fmt::format("{} mm, {}", place(at), part);
}

/// What acts in a state: where it is pressed, else what drives it.
std::string what_acts(const json& probe, const json& compare) {
    const json driven = probe.value("driven_by", json());
    return probe.value("at", json()).is_null() && driven.is_string() ? driven.get<std::string>()
                                                                     : where(probe.value("at", json()), compare);
}

std::string marker_name(const json& marker) { return marker.value("name", marker["marker"].dump()); }

std::string worst_positions(const json& compare) {
    const std::vector<json> probes = worst_of(compare["probes"], "rms_mm");
    const std::vector<json> markers = worst_of(compare["markers"], "rms_mm");
    if (probes.empty() || markers.empty()) return {};
    std::string text = fmt::format("  {:<24} {:>10} {:>10} {:>9}  {}\n", "Largest errors", "rms mm", "max mm",
                                   "relative", "load applied at");
    for (const json& p : probes) {
        text +=
            fmt::format("  {:<24} {:>10.3g} {:>10.3g} {:>9}  {}\n",
                        fmt::format("probe {}, {:g} s", p["probe"].get<int>(), p["time"].get<double>()),
                        p["rms_mm"].get<double>(), p["max_mm"].get<double>(),
                        p["relative"].is_number() ? percent(p["relative"].get<double>()) : "-", what_acts(p, compare));
    }
    text += fmt::format("  {:<24} {:>10} {:>20}  {}\n", "Markers", "rms mm", "", "rest position");
    for (const json& m : markers) {
        text += fmt::format("  {:<24} {:>10.3g} {:>20}  {}\n", "marker " + marker_name(m), m["rms_mm"].get<double>(),
                            "", where(m["at"], compare));
    }
    return text;
}

double length_of(const json& vector) {
    double squares = 0;
    for (const json& component : vector)
        if (component.is_number()) squares += std::pow(component.get<double>(), 2);
    return std::sqrt(squares);
}

std::string worst_forces(const json& compare) {
    const std::vector<json> forces = worst_of(compare.value("tool_forces", json::array()), "error_n");
    if (forces.empty()) return {};
    std::string text = fmt::format("  {:<24} {:>10} {:>10} {:>9}  {}\n", "Largest force errors", "error N", "read N",
                                   "relative", "tool at");
    for (const json& force : forces) {
        const double error = force["error_n"].get<double>(), read = length_of(force["measured_n"]);
        text += fmt::format("  {:<24} {:>10.3g} {:>10.3g} {:>9}  {}, {}\n",
                            fmt::format("probe {}, {:g} s", force["probe"].get<int>(), force["time"].get<double>()),
                            error, read, read > 0 ? percent(error / read) : "-", force["tool"].get<std::string>(),
                            where(force["at"], compare));
    }
    return text;
}

}  // namespace

std::string part_of_body(const json& at, const json& box) {
    constexpr double side = 0.2;  // of the box
    std::array<double, 3> low{}, size{};
    for (std::size_t a = 0; a < 3; ++a) {
        low[a] = box["min"][a].get<double>();
        size[a] = box["max"][a].get<double>() - low[a];
    }
    const auto longest = static_cast<std::size_t>(std::ranges::max_element(size) - size.begin());
    std::string words;
    const auto add = [&](const std::string& word) { words += (words.empty() ? "" : ", ") + word; };
    for (const std::size_t a : {longest, (longest + 1) % 3, (longest + 2) % 3}) {
        if (!(size[a] > 0)) continue;
        const double share = (at[a].get<double>() - low[a]) / size[a];
        if (share > side && share < 1 - side) continue;
        const bool is_high = share > 0.5;
        if (a == longest)
            add(fmt::format("{}{} end", is_high ? '+' : '-', "xyz"[a]));
        else if (a == 2)
            add(is_high ? "top" : "bottom");
        else
            add(fmt::format("{}{} side", is_high ? '+' : '-', "xyz"[a]));
    }
    return words.empty() ? "middle" : words;
}

std::string worst_table(const json& compare) { return worst_positions(compare) + worst_forces(compare); }

}  // namespace palpate::pipeline
