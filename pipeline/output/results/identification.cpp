#include "pipeline/output/results/identification.h"

#include <fmt/format.h>

#include "mesh/text/atomic_file.h"
#include "pipeline/analysis/particles.h"
#include "pipeline/output/csv/posterior.h"
#include "pipeline/output/damping.h"
#include "pipeline/output/json/comparison.h"
#include "pipeline/output/vtk/series.h"
#include "skeleton/model/io/model_io.h"

namespace palpate::pipeline {
namespace {

std::string correlations_csv(const identify::IdentifyResult& found) {
    std::string text = "parameter,other,correlation\n";
    for (const identify::Correlation& pair : found.correlations) {
        text += fmt::format("{},{},{:.3f}\n", found.posterior[pair.a].parameter, found.posterior[pair.b].parameter,
                            pair.value);
    }
    return text;
}

/// -ln of the posterior density, but for a constant, along the fit; then temperatures and effective samples of the
/// particles.
std::string convergence_csv(const identify::IdentifyResult& found) {
    std::string text = "stage,step,minus_log_density,temperature,effective_samples\n";
    for (std::size_t i = 0; i < found.fit_trace.size(); ++i) {
        text += fmt::format("fit,{},{},,\n", i, found.fit_trace[i]);
    }
    for (std::size_t i = 0; i < found.history.size(); ++i) {
        text +=
            fmt::format("particles,{},,{},{}\n", i, found.history[i].temperature, found.history[i].effective_samples);
    }
    return text;
}

}  // namespace

void write_identification(const std::filesystem::path& folder, const identify::IdentifyResult& found) {
    write_particle_series(folder / "history.pvd", found);
    mesh::write_text(folder / "posterior.csv", posterior_csv(found.posterior));
    mesh::write_text(folder / "particles.csv", particles_csv(found));
    mesh::write_text(folder / "correlations.csv", correlations_csv(found));
    mesh::write_text(folder / "convergence.csv", convergence_csv(found));
    if (found.damping) mesh::write_text(folder / "damping.csv", damping_csv(*found.damping));
    mesh::write_text(folder / "identify.json", summary_json(found).dump(2) + "\n");
    skeleton::write_model_vtp(folder / "model.vtp", found.model);
    skeleton::write_model(folder / "model.json", found.model);
}

}  // namespace palpate::pipeline
