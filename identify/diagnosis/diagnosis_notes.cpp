#include "identify/diagnosis/diagnosis_notes.h"

#include <fmt/format.h>

#include "identify/diagnosis/search/mesh_correction.h"

namespace palpate::identify {
namespace {

/// Sensors finer than the body's mesh see its errors, which no effect explains.
void note_mesh_error(const DiagnoseOptions& options, double moved, Diagnosis& diagnosis) {
    if (diagnosis.verdict != Verdict::unexplained) return;
    const Problem& problem = diagnosis.problem;
    const double left = problem.rms_mm(diagnosis.best().residual.cwiseProduct(problem.sigma));
    constexpr double most = 0.015;  // of the displacement: what meshes and their contacts may be off by
    if (left > most * moved || moved == 0) return;
    diagnosis.notes.push_back(
        fmt::format("The residual, {:.3g} mm rms, is {:.2g} % of the displacement, which discretisation error may "
                    "explain. Shorter elements (--edge-length) reduce it; a noise of {:.3g} mm or more covers it.",
                    left, 100 * left / moved, options.resolution * moved));
}

}  // namespace

void note_outliers(const MeasurementSet& set, int readings, Diagnosis& diagnosis) {
    const Outliers& outliers = diagnosis.outliers;
    diagnosis.notes.push_back(
        fmt::format("{} of {} readings are outliers and were set aside.", outliers.readings.size(), readings));
    for (const ExchangedMarkers& one : outliers.exchanged) {
        const LoadState& state = set.states[one.state];
        diagnosis.notes.push_back(fmt::format(
            "In probe {} at {:g} s the markers {} and {} look exchanged: with their labels swapped both fit. Swap them "
            "in positions.csv to use their readings.",
            state.probe, state.time, label_of(set.markers[one.markers.first]),
            label_of(set.markers[one.markers.second])));
    }
}

void note_limits(const DiagnoseOptions& options, double moved, Diagnosis& diagnosis) {
    note_mesh_error(options, moved, diagnosis);
    if (options.refit.magnitude == MagnitudeUse::alternative && diagnosis.best().has_known_magnitude)
        diagnosis.notes.emplace_back(
            "Gravity was fitted with the earth's magnitude, 9.81 m/s² over all its components, as the evidence prefers "
            "that to a free magnitude; '--gravity unknown' leaves it free.");
    if (std::string note = note_of_correction(diagnosis.problem); !note.empty())
        diagnosis.notes.push_back(std::move(note));
}

}  // namespace palpate::identify
