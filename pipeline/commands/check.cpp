#include <fmt/format.h>

#include <algorithm>

#include "pipeline/case/subject.h"
#include "pipeline/commands/common.h"
#include "pipeline/results/results.h"

namespace palpate::pipeline::commands {
namespace {

std::string describe_set(const identify::MeasurementSet& set) {
    const auto loaded =
        std::count_if(set.states.begin(), set.states.end(), [](auto& s) { return !s.contacts.empty(); });
    std::size_t readings = 0, unlabelled = 0;
    for (const auto& state : set.states) {
        readings += state.readings.size();
        unlabelled += static_cast<std::size_t>(
            std::count_if(state.readings.begin(), state.readings.end(), [](auto& r) { return r.marker < 0; }));
    }
    std::string text = fmt::format("{} states ({} loaded), {} markers, {} readings", set.states.size(), loaded,
                                   set.markers.size(), readings);
    if (unlabelled) text += fmt::format(" ({} without a label: left out for now)", unlabelled);
    if (!set.position_noise) text += "; no noise is stated";
    return text + ".\n";
}

}  // namespace

Outcome check(const CheckOptions& options, const Common&) {
    const Subject subject = read_subject(read_case(options.input, options.say));
    const mesh::SurfaceReport surface = mesh::check_surface(subject.surface);
    const std::vector<std::string> faults = mesh::describe_faults(surface);

    Outcome outcome;
    outcome.text =
        fmt::format("{}: {} vertices, {} triangles, {} part{}, {:.4g} x {:.4g} x {:.4g} mm, volume {:.4g} mm^3.\n",
                    options.input.string(), surface.vertices, surface.triangles, surface.components,
                    surface.components == 1 ? "" : "s", surface.box.extent().x(), surface.box.extent().y(),
                    surface.box.extent().z(), surface.volume);
    if (subject.set) outcome.text += describe_set(*subject.set);
    for (const std::string& fault : faults) outcome.text += "  - " + fault + "\n";
    outcome.text += faults.empty() ? "The surface is sound.\n" : "";
    for (const std::string& assumption : subject.assumptions) outcome.text += "  - assumed: " + assumption + "\n";
    outcome.json = {{"surface", to_json(surface)}, {"faults", faults}, {"assumptions", subject.assumptions}};
    if (subject.set) {
        outcome.json["set"] = {{"states", subject.set->states.size()}, {"markers", subject.set->markers.size()}};
    }
    return outcome;
}

}  // namespace palpate::pipeline::commands
