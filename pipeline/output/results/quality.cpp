#include "pipeline/output/results/quality.h"

#include <fmt/format.h>

namespace palpate::pipeline {
namespace {

nlohmann::json step_json(const QualityStep& r) {
    return {
        {"own", r.is_own},
        {"spheres", r.spheres},
        {"held", r.held},
        {"links", r.links},
        {"coverage_mm", r.shape.coverage},
        {"coverage_share", r.shape.coverage_share},
        {"covered", r.shape.covered},
        {"outside", r.shape.outside},
        {"components", r.graph.parts},
        {"body_components", r.graph.body_parts},
        {"handles", r.graph.handles},
        {"body_handles", r.graph.body_handles},
        {"loops", r.graph.loops},
        {"links_outside", r.graph.links_outside},
        {"error", {{"rms", r.error.rms}, {"median", r.error.median}, {"p90", r.error.p90}, {"pooled", r.error.pooled}}},
        {"fit_probes", r.fit},
        {"held_out_probes", r.error.probes}};
}

}  // namespace

std::string quality_table(const Quality& quality) {
    std::string text = fmt::format(
        "Quality against {} nodes of finite elements, after a fit link by link; errors of held-out probes, relative, "
        "%.\n{:>8} {:>6} {:>12} {:>8} {:>8} {:>6} {:>8} {:>8} {:>7} {:>7} {:>7} {:>7} {:>7}\n",
        quality.nodes, "spheres", "links", "coverage mm", "% size", "covered", "out", "parts", "handles", "rms",
        "median", "p90", "pooled", "fit s");
    for (const QualityStep& r : quality.steps) {
        text += fmt::format(
            "{:>8} {:>6} {:>12.3g} {:>8.2f} {:>7.1f}% {:>5.1f}% {:>8} {:>8} {:>7.2f} {:>7.2f} {:>7.2f} {:>7.2f} "
            "{:>7.1f}\n",
            fmt::format("{}{}", r.is_own ? "*" : "", r.spheres), r.links, r.shape.coverage,
            100 * r.shape.coverage_share, 100 * r.shape.covered, 100 * r.shape.outside,
            fmt::format("{} of {}", r.graph.parts, r.graph.body_parts),
            fmt::format("{} of {}", r.graph.handles, r.graph.body_handles), 100 * r.error.rms, 100 * r.error.median,
            100 * r.error.p90, 100 * r.error.pooled, r.seconds_fit);
    }
    return text + "* the model that was written\n";
}

nlohmann::json quality_json(const Quality& quality) {
    nlohmann::json result = {
        {"format", "palpate-quality/1"}, {"reference_nodes", quality.nodes}, {"notes", quality.notes}};
    result["rungs"] = nlohmann::json::array();
    for (const QualityStep& step : quality.steps) result["rungs"].push_back(step_json(step));
    return result;
}

std::string quality_csv(const Quality& quality) {
    std::string text =
        "# palpate: quality of a skeleton at several numbers of spheres; errors are relative, of held-out probes\n"
        "own,spheres,held,links,coverage_mm,coverage_share,covered,outside,components,body_components,handles,"
        "body_handles,loops,links_outside,rms,median,p90,pooled,fit_probes,held_out_probes\n";
    for (const QualityStep& r : quality.steps) {
        text += fmt::format(
            "{},{},{},{},{:.6g},{:.6g},{:.6g},{:.6g},{},{},{},{},{},{},{:.6g},{:.6g},{:.6g},{:.6g},{},{}\n",
            r.is_own ? 1 : 0, r.spheres, r.held, r.links, r.shape.coverage, r.shape.coverage_share, r.shape.covered,
            r.shape.outside, r.graph.parts, r.graph.body_parts, r.graph.handles, r.graph.body_handles, r.graph.loops,
            r.graph.links_outside, r.error.rms, r.error.median, r.error.p90, r.error.pooled, r.fit, r.error.probes);
    }
    return text;
}

}  // namespace palpate::pipeline
