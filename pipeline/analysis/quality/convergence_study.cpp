#include "pipeline/analysis/quality/convergence_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "mesh/errors.h"
#include "pipeline/analysis/quality/calibrated.h"
#include "pipeline/synthesis/probing/held_out.h"
#include "skeleton/construction/build.h"

namespace palpate::pipeline {
namespace {

constexpr int most_spheres_with_all_probes = 200;  // a choice of time: beyond, every second probe is fitted to

/// Every second loaded state, and all unloaded ones.
ProbedQuality with_half_the_probes(const ProbedQuality& probed) {
    ProbedQuality half = probed;
    int loaded = 0;
    half.fit = states_of(probed.fit,
                         [&](const identify::LoadState& state) { return state.contacts.empty() || loaded++ % 2 == 0; });
    return half;
}

int loaded_states(const identify::MeasurementSet& set) {
    return static_cast<int>(
        std::ranges::count_if(set.states, [](const auto& state) { return !state.contacts.empty(); }));
}

int held_spheres(const skeleton::Model& model) {
    return static_cast<int>(std::ranges::count(model.spheres, true, &skeleton::Sphere::held));
}

QualityStep measure_step(const skeleton::Model& model, const ProbedQuality& probed, int threads,
                         const Progress& progress) {
    QualityStep step;
    step.held = held_spheres(model);
    step.spheres = static_cast<int>(model.spheres.size()) - step.held;
    step.links = static_cast<int>(model.links.size());
    step.shape = shape_quality(model);
    step.graph = graph_quality(model);
    step.fit = loaded_states(probed.fit);
    const CalibratedQuality fitted =
        calibrate_for_quality(model, probed, skeleton::EquilibriumLaw::linear, threads, progress);
    step.error = fitted.held_out;
    step.seconds_fit = fitted.seconds;
    return step;
}

}  // namespace

void QualityOptions::validate() const {
    for (const int count : spheres) {
        if (count < 1 || count > 20000) {
            throw InvalidInput(fmt::format("spheres of a quality step: {}; allowed are 1 to 20000", count));
        }
    }
    QualityProbing{.fit = fit, .held_out = held_out}.validate();
}

Quality measure_quality(const Subject& subject, const MeshedBody& body, const skeleton::Model& model,
                        const QualityOptions& options, const Progress& progress) {
    options.validate();
    const ProbedQuality probed = probe_for_quality(
        subject, {.fit = options.fit, .held_out = options.held_out, .threads = options.threads}, progress);
    const ProbedQuality half = with_half_the_probes(probed);
    Quality quality{.nodes = probed.nodes, .steps = {}, .notes = probed.notes};

    const auto add = [&](const skeleton::Model& measured, double seconds_build) -> QualityStep& {
        const auto count = static_cast<int>(measured.spheres.size()) - held_spheres(measured);
        const std::string what = fmt::format("fitting {} spheres", count);
        QualityStep step = measure_step(measured, count > most_spheres_with_all_probes ? half : probed, options.threads,
                                        [&](std::string_view, double share) { report(progress, what, share); });
        step.seconds_build = seconds_build;
        return quality.steps.emplace_back(std::move(step));
    };
    add(model, 0).is_own = true;

    std::vector<int> ladder = options.spheres;
    std::ranges::sort(ladder);
    ladder.erase(std::unique(ladder.begin(), ladder.end()), ladder.end());
    for (const int count : ladder) {
        if (count == quality.steps.front().spheres) continue;
        skeleton::BuildOptions how = subject.settings.skeleton;
        how.spheres = count;
        const auto start = std::chrono::steady_clock::now();
        try {
            const skeleton::Model step =
                skeleton::build_skeleton(body.surface, body.volume, subject.material, subject.supports, how);
            add(step, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
        } catch (const InvalidInput& e) {
            quality.notes.push_back(fmt::format("The ladder ends below {} spheres: {}", count, e.what()));
            break;
        }
    }
    std::ranges::stable_sort(quality.steps, {}, &QualityStep::spheres);
    if (std::ranges::any_of(quality.steps, [&](const QualityStep& step) { return step.fit < options.fit; })) {
        quality.notes.push_back(fmt::format("Skeletons of more than {} spheres were fitted to every second probe only.",
                                            most_spheres_with_all_probes));
    }
    return quality;
}

}  // namespace palpate::pipeline
