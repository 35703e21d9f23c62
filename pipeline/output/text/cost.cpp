#include "pipeline/output/text/cost.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fem/linear_algebra/memory/free_memory.h"
#include "pipeline/output/html/charts/svg.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

std::string duration(double seconds) {
    if (seconds < 0.95) return fmt::format("{:.1f} s", seconds);
    constexpr double minute = 60, hour = 3600, day = 86400;
    if (seconds < 2 * minute) return fmt::format("{:.2g} s", std::max(1.0, std::round(seconds)));
    if (seconds < 2 * hour) return fmt::format("{:.2g} min", seconds / minute);
    return seconds < 2 * day ? fmt::format("{:.2g} h", seconds / hour) : fmt::format("{:.3g} days", seconds / day);
}

}  // namespace

std::string duration_in_words(const json& stage) {
    const double about = stage["seconds"], most = stage["most_seconds"];
    return most > about ? fmt::format("{}, up to {}", duration(about), duration(most)) : duration(about);
}

std::string cost_lead(const json& cost) {
    const auto count = [&](const char* what) { return plain_number(cost[what]); };
    return fmt::format("A run would take about {} and {:.2g} GB on {} thread{}: {} nodes, {} spheres, {} links.",
                       duration_in_words(cost), cost["gigabytes"].get<double>(), cost["threads"].get<int>(),
                       cost["threads"] == 1 ? "" : "s", count("nodes"), count("spheres"), count("links"));
}

json to_json(const std::vector<StageCost>& stages, const WorkSize& size, int threads) {
    json list = json::array();
    double seconds = 0, most = 0, gigabytes = 0;
    for (const StageCost& one : stages) {
        list.push_back({{"stage", one.stage},
                        {"seconds", one.seconds},
                        {"most_seconds", one.most_seconds},
                        {"gigabytes", one.gigabytes},
                        {"solver", one.how}});
        seconds += one.seconds;
        most += one.most_seconds;
        gigabytes = std::max(gigabytes, one.gigabytes);
    }
    const double free = fem::free_memory();
    return {{"threads", threads},
            {"stages", list},
            {"seconds", seconds},
            {"most_seconds", most},
            {"gigabytes", gigabytes},
            {"free_gigabytes", std::isfinite(free) ? json(free) : json(nullptr)},
            {"fits", gigabytes <= free && size.probed.fits()},
            {"nodes", size.nodes},
            {"spheres", size.spheres},
            {"links", size.links},
            {"reference_nodes", size.reference_nodes}};
}

std::string cost_in_words(const json& cost, const std::string& input) {
    std::string text = cost_lead(cost) + "\n";
    for (const json& stage : cost["stages"]) {
        const auto solver = stage["solver"].get<std::string>();
        text += fmt::format("  {:<14}{:>6.2g} GB  {}{}\n", stage["stage"].get<std::string>(),
                            stage["gigabytes"].get<double>(), duration_in_words(stage),
                            solver.empty() ? "" : "; by " + solver);
    }
    const double gigabytes = cost["gigabytes"], minutes = cost["most_seconds"].get<double>() / 60;
    if (!cost["fits"].get<bool>()) {
        text += "It does not fit into this machine's memory: larger elements (--edge-length), ";
        text += "or several processes with a program that has PETSc: mpirun -n N palpate run ... --solver petsc.\n";
    }
    constexpr double reserve = 2;  // predictions are off by as much
    text += fmt::format("On a cluster: palpate run {} -o runs --workers slurm:memory={:.0f},minutes={:.0f}\n", input,
                        std::ceil(reserve * gigabytes), std::ceil(reserve * minutes));
    return text;
}

}  // namespace palpate::pipeline
