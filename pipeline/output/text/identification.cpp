#include "pipeline/output/text/identification.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "mesh/text/words.h"
#include "pipeline/output/damping.h"
#include "pipeline/output/text/words.h"

namespace palpate::pipeline {
namespace {

constexpr std::size_t most_rows = 30;         // of parameters; the rest stands in posterior.csv
constexpr std::size_t most_correlations = 5;  // the rest stands in correlations.csv

std::string kind_of(const identify::PosteriorRow& row) { return row.parameter.substr(0, row.parameter.find(':')); }

/// How many parameters of each kind there are, and how many of them are informed.
std::string kinds_table(const identify::IdentifyResult& found) {
    std::map<std::string, std::pair<int, int>> kinds;
    for (const auto& row : found.posterior) {
        auto& [all, informed] = kinds[kind_of(row)];
        ++all;
        informed += row.informed ? 1 : 0;
    }
    std::string text = "  Kind of stiffness      numbers   informed by the measurements\n";
    for (const auto& [kind, counts] : kinds) {
        text += fmt::format("  {:<20} {:>9} {:>10}\n", kind, counts.first, counts.second);
    }
    return text;
}

std::string parameter_table(const identify::IdentifyResult& found) {
    std::string text = fmt::format("  {:<20} {:>10} {:>9} {:>10} {:>10}  {:<9} {}\n", "Stiffness", "mean", "sd",
                                   "2.5 %", "97.5 %", "unit", "informed");
    for (const auto& row : found.posterior) {
        text += fmt::format("  {:<20} {:>10.4g} {:>9.2g} {:>10.4g} {:>10.4g}  {:<9} {}\n", row.parameter, row.mean,
                            row.sd, row.q025, row.q975, row.unit, row.informed ? "yes" : "no");
    }
    return text;
}

std::string modes_table(const identify::IdentifyResult& found) {
    std::string text;
    for (std::size_t i = 0; i < found.modes.size(); ++i) {
        text += fmt::format("  Mode {}, {:.0f} %:", i + 1, 100 * found.modes[i].probability);
        for (std::size_t p = 0; p < found.posterior.size() && p < most_rows; ++p) {
            text += fmt::format("  {} {:.4g}", found.posterior[p].parameter,
                                found.modes[i].stiffness[static_cast<Eigen::Index>(p)]);
        }
        text += "\n";
    }
    return text;
}

}  // namespace

std::string identification_in_words(const identify::IdentifyResult& found) {
    const auto informed = std::ranges::count(found.posterior, true, &identify::PosteriorRow::informed);
    std::string text = fmt::format("  {} numbers from {} readings in {} states; {} of them informed.\n",
                                   found.posterior.size(), found.coordinates, found.states, informed);
    if (!found.fit_trace.empty()) {
        text += fmt::format("  Fit: {} steps, -ln density {:.6g} -> {:.6g} (but for a constant).\n",
                            found.fit_trace.size() - 1, found.fit_trace.front(), found.fit_trace.back());
    }
    if (!found.history.empty()) {
        const identify::FilterStep& last = found.history.back();
        text += fmt::format("  Particles: {}, of which {:.0f} effective after {} steps", last.particles.rows(),
                            last.effective_samples, found.history.size() - 1);
        if (!std::isnan(found.r_hat)) text += fmt::format("; R-hat {:.3f} of two clouds", found.r_hat);
        if (found.acceptance > 0) text += fmt::format("; {:.0f} % of moves accepted", 100 * found.acceptance);
        if (found.log_evidence != 0) text += fmt::format("; ln evidence {:.6g}", found.log_evidence);
        if (!std::isnan(found.log_evidence_sd)) text += fmt::format(" ± {:.2g}", found.log_evidence_sd);
        text += ".\n";
    }
    if (found.equilibria > 0)
        text += fmt::format("  {} solved.\n", mesh::count_of(found.equilibria, "equilibrium was", "equilibria were"));

    text += '\n';
    text += found.posterior.size() <= most_rows ? parameter_table(found) : kinds_table(found);
    if (found.modes.size() > 1) text.append("\n").append(modes_table(found));
    if (!found.correlations.empty()) {
        text += "\n  Known together rather than each alone:\n";
        for (std::size_t i = 0; i < std::min(most_correlations, found.correlations.size()); ++i) {
            const identify::Correlation& pair = found.correlations[i];
            text += fmt::format("  {} and {}: correlation {:.2f}\n", found.posterior[pair.a].parameter,
                                found.posterior[pair.b].parameter, pair.value);
        }
    }
    if (found.damping) text.append("\n").append(damping_in_words(to_json(*found.damping)));
    if (!found.notes.empty()) text += "\n";
    for (const std::string& note : found.notes) text += "  " + note + "\n";
    return text;
}

}  // namespace palpate::pipeline
