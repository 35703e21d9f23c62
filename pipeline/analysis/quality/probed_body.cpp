#include "pipeline/analysis/quality/probed_body.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "mesh/errors.h"
#include "pipeline/synthesis/blind_set.h"
#include "pipeline/synthesis/probing/held_out.h"

namespace palpate::pipeline {
namespace {

constexpr double finer = 0.8;     // edges against those that were asked for
constexpr int fit_markers = 150;  // as a run reads
constexpr int all_markers = ProbeOptions::most_markers;

/// Numbers of the probes that are held out, of 1 to `probes`. Drawn: directions come round every four probes, and a
/// regular choice might meet one of them only.
std::vector<char> draw_held_out(int probes, int held_out, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::vector<std::pair<std::uint64_t, int>> order;
    for (int p = 1; p <= probes; ++p) order.emplace_back(random(), p);
    std::ranges::sort(order);
    std::vector<char> held(static_cast<std::size_t>(probes) + 1, 0);
    for (int i = 0; i < held_out; ++i) held[order[i].second] = 1;
    return held;
}

/// Markers are ordered such that those at the beginning are spread over the surface.
identify::MeasurementSet with_fewer_markers(identify::MeasurementSet set, std::size_t markers) {
    if (set.markers.size() > markers) set.markers.resize(markers);
    for (identify::LoadState& state : set.states) {
        std::erase_if(state.readings, [&](const auto& reading) { return reading.marker >= std::ssize(set.markers); });
    }
    return set;
}

}  // namespace

void QualityProbing::validate() const {
    const auto require = [](const char* option, int value) {
        if (value < 1 || value > 1000) {
            throw InvalidInput(fmt::format("{} is {} probes, allowed is 1 to 1000", option, value));
        }
    };
    require("fit", fit);
    require("held_out", held_out);
}

ProbedQuality probe_for_quality(const Subject& subject, const QualityProbing& options, const Progress& progress) {
    options.validate();
    Subject probed = subject;
    probed.settings.linear_elements = false;
    probed.settings.edge_length *= finer;
    probed.settings.probing = {.probes = options.fit + options.held_out, .markers = all_markers};
    const BlindSetOptions how{.law = options.law, .levels = 1, .noise = 0};
    const std::uint64_t seed = subject.settings.identify.seed;
    const Specimen specimen = finite_element_specimen(probed, how, progress);
    const BlindSet blind_set = synthesise(specimen, probed.settings.probing, how, seed, options.threads, progress);

    const std::vector<char> held_out = draw_held_out(options.fit + options.held_out, options.held_out, seed);
    ProbedQuality result;
    result.nodes = static_cast<int>(specimen.volume.nodes.rows());
    result.notes = blind_set.notes;
    result.fit = with_fewer_markers(states_of(blind_set.set, [&](const auto& state) { return !held_out[state.probe]; }),
                                    fit_markers);
    result.held_out = states_of(blind_set.set, [&](const auto& state) { return held_out[state.probe] != 0; });
    return result;
}

}  // namespace palpate::pipeline
