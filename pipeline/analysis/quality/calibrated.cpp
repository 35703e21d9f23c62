#include "pipeline/analysis/quality/calibrated.h"

#include <chrono>

#include "identify/comparison/compare.h"
#include "identify/inference/maximum/calibrate.h"

namespace palpate::pipeline {

CalibratedQuality calibrate_for_quality(const skeleton::Model& model, const ProbedQuality& body,
                                        skeleton::EquilibriumLaw law, int threads, const Progress& progress) {
    identify::IdentifyOptions options;
    options.law =
        law == skeleton::EquilibriumLaw::linear ? identify::LawChoice::linear : identify::LawChoice::large_rotation;
    options.threads = threads;
    const auto start = std::chrono::steady_clock::now();
    identify::Calibration found = identify::calibrate(model, collect_readings(model, body.fit), options, progress);
    CalibratedQuality result;
    result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    result.notes = std::move(found.notes);
    result.model = identify::calibrated(model, found);

    const identify::Comparison fitted = compare(result.model, body.fit, threads);
    result.fit = summarise(deviations(body.fit, fitted.predicted));
    const identify::Comparison held_out = compare(result.model, body.held_out, threads);
    result.held_out = summarise(deviations(body.held_out, held_out.predicted));
    result.overloaded_probes = static_cast<int>(held_out.overloaded_probes.size());
    return result;
}

}  // namespace palpate::pipeline
