#include "pipeline/output/html/sections/stiffness_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "identify/numerics/summaries.h"
#include "pipeline/output/html/charts/charts.h"
#include "pipeline/output/html/charts/svg.h"
#include "pipeline/output/html/escape.h"
#include "pipeline/output/html/page/page_parts.h"

namespace palpate::pipeline {
namespace {

constexpr std::size_t most_chosen = 200;    // numbers that can be looked at one by one
constexpr std::size_t most_intervals = 16;  // of a unit

using Rows = std::vector<identify::PosteriorRow>;

/// 95 % of a prior.
std::pair<double, double> prior_interval(const identify::PosteriorRow& row, PriorKind kind) {
    if (kind == PriorKind::even) {
        const double reach = 0.95 * std::sqrt(3.0) * row.prior_sd;
        return {row.prior_mean - reach, row.prior_mean + reach};
    }
    const double variance = std::log1p(std::pow(row.prior_sd / row.prior_mean, 2));  // of the logarithm
    const double middle = std::log(row.prior_mean) - variance / 2;
    const double reach = identify::sds_of_95_percent * std::sqrt(variance);
    return {std::exp(middle - reach), std::exp(middle + reach)};
}

/// Can be shown on a logarithmic axis.
bool is_positive(const identify::PosteriorRow& row) { return row.q025 > 0 && row.prior_mean > 0 && row.prior_sd > 0; }

/// Places of rows, those first whose 95 % have shrunk to the least share of the prior's.
std::vector<Eigen::Index> most_informed_first(const Rows& posterior, PriorKind prior) {
    std::vector<Eigen::Index> order;
    std::vector<double> left(posterior.size());
    for (std::size_t p = 0; p < posterior.size(); ++p) {
        if (!is_positive(posterior[p])) continue;
        const auto [low, high] = prior_interval(posterior[p], prior);
        left[p] = std::log(posterior[p].q975 / posterior[p].q025) / std::log(high / low);
        order.push_back(static_cast<Eigen::Index>(p));
    }
    std::ranges::stable_sort(order, {}, [&](Eigen::Index p) { return left[static_cast<std::size_t>(p)]; });
    return order;
}

/// Kinds in the order of the rows, with the places of theirs.
std::vector<std::pair<std::string, std::vector<Eigen::Index>>> by_kind(const Rows& posterior) {
    std::vector<std::pair<std::string, std::vector<Eigen::Index>>> kinds;
    for (std::size_t p = 0; p < posterior.size(); ++p) {
        if (!is_positive(posterior[p])) continue;
        const std::string kind = posterior[p].parameter.substr(0, posterior[p].parameter.find(':'));
        auto found = std::ranges::find(kinds, kind, [](const auto& entry) { return entry.first; });
        if (found == kinds.end()) found = kinds.insert(kinds.end(), {kind, {}});
        found->second.push_back(static_cast<Eigen::Index>(p));
    }
    return kinds;
}

KnownBeforeAndAfter with_printed_name(KnownBeforeAndAfter known) {
    known.name = printed_stiffness(known.name);
    return known;
}

std::string kinds_of(const Rows& posterior, const ParticleSet& particles, PriorKind prior) {
    std::string html = "<h3>Prior and posterior</h3><div class=\"densities\">";
    bool pooled = false;
    for (const auto& [kind, places] : by_kind(posterior)) {
        const bool alone = places.size() == 1;
        pooled = pooled || !alone;
        html += density_chart(alone ? with_printed_name(density_of(posterior[static_cast<std::size_t>(places.front())],
                                                                   particles, places.front(), prior))
                                    : pooled_density(fmt::format("{}, all {}", printed_stiffness(kind), places.size()),
                                                     posterior, particles, places, prior));
    }
    html +=
        "</div><p class=\"soft\">Dashed: prior density. Filled: posterior density, of the weighted particles. Above: "
        "the posterior's median and 95 % interval";
    return html +
           (pooled ? "; of several numbers together, those of their medians, each relative to the middle of its prior. "
                     "Where prior and posterior agree, the data are uninformative.</p>"
                   : ".</p>");
}

/// Any one number, chosen from a list.
std::string one_by_one(const Rows& posterior, const ParticleSet& particles, PriorKind prior) {
    std::vector<Eigen::Index> shown = most_informed_first(posterior, prior);
    if (shown.size() <= by_kind(posterior).size()) return {};  // each has its picture already
    const std::size_t all = shown.size();
    shown.resize(std::min(all, most_chosen));
    std::string options;
    nlohmann::json pictures = nlohmann::json::array();
    for (const Eigen::Index p : shown) {
        const identify::PosteriorRow& row = posterior[static_cast<std::size_t>(p)];
        options += "<option>" + escape(printed_stiffness(row.parameter)) + (row.informed ? " ●" : "") + "</option>";
        pictures.push_back(density_chart(with_printed_name(density_of(row, particles, p, prior))));
    }
    return fmt::format(
               "<h3>One by one</h3><p><label>Number <select id=\"density-of\">{}</select></label> <span "
               "class=\"soft\">{}the best determined first; ● narrower than its prior</span></p>"
               "<div class=\"densities\" id=\"density\">{}</div>",
               options, all > most_chosen ? fmt::format("{} of {}, ", most_chosen, all) : "",
               pictures.front().get<std::string>()) +
           "<script id=\"density-data\" type=\"application/json\">" + as_script_data(pictures) + "</script><script>" +
           std::string(density_script) + "</script>";
}

/// Without the word that the chart's title has: "bending, link 17".
std::string name_of_interval(const std::string& parameter) {
    std::string name = printed_stiffness(parameter);
    const std::string word = " stiffness";
    if (const std::size_t at = name.find(word); at != std::string::npos) name.erase(at, word.size());
    return name;
}

/// What a row stands for that is of several links or spheres; "" where none is.
std::string shared_words(const Rows& posterior) {
    const auto of_several = [](const identify::PosteriorRow& row) {
        return row.link < 0 && row.parameter.find(":sphere") == std::string::npos;
    };
    return std::ranges::any_of(posterior, of_several)
               ? " A stiffness that names no link is the geometric mean over all "
                 "links that share it; for the volume, over all spheres."
               : "";
}

std::string intervals(const Rows& posterior, PriorKind prior) {
    std::map<std::string, std::vector<Interval>> by_unit;
    for (const Eigen::Index p : most_informed_first(posterior, prior)) {
        const identify::PosteriorRow& row = posterior[static_cast<std::size_t>(p)];
        auto& list = by_unit[row.unit];
        if (list.size() == most_intervals) continue;
        const auto [low, high] = prior_interval(row, prior);
        list.push_back(
            {name_of_interval(row.parameter) + (row.informed ? " ●" : ""), row.q025, row.q50, row.q975, low, high});
    }
    std::string html = "<h3>Intervals</h3><div class=\"pair\">";
    for (const auto& [unit, list] : by_unit) html += interval_chart(list, "Stiffness", unit);
    return html + "</div>";
}

}  // namespace

std::string stiffness_section(const Rows& posterior, const ParticleSet& particles, PriorKind prior,
                              const std::string& file) {
    const auto informed = std::ranges::count_if(posterior, [](const auto& row) { return row.informed; });
    std::string html = fmt::format(
        "<h2 id=\"stiffness\">Stiffness</h2><p>The measurements constrain {} of {} stiffnesses of the model to use "
        "(●); the "
        "others keep their prior, computed from the body's shape and initial material.</p>",
        informed, posterior.size());
    const bool drawn = particles.weights.size() > 0 && particles.stiffness.cols() == std::ssize(posterior) &&
                       particles.stiffness.minCoeff() > 0;
    if (drawn) html += kinds_of(posterior, particles, prior) + one_by_one(posterior, particles, prior);
    return html + intervals(posterior, prior) +
           "<p class=\"soft\">Grey: 95 % of the prior. Blue: 95 % of the posterior, with its median; the best "
           "determined first." +
           shared_words(posterior) + " All numbers are in " + escape(file) + ", where bending is called flexion.</p>";
}

}  // namespace palpate::pipeline
