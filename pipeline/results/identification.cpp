#include "pipeline/results/identification.h"

#include "mesh/io/atomic_file.h"
#include "pipeline/case/names.h"
#include "pipeline/results/posterior_file.h"
#include "pipeline/results/results.h"
#include "pipeline/results/series.h"
#include "skeleton/model_io.h"

namespace palpate::pipeline {

void write_identification(const std::filesystem::path& folder, const identify::IdentifyResult& found) {
    write_particle_series(folder / "history.pvd", found);
    mesh::write_text(folder / "posterior.csv", posterior_csv(found.posterior));
    mesh::write_text(folder / "identify.json", summary_json(found).dump(2) + "\n");
    skeleton::write_model_vtp(folder / "model.vtp", found.model);
    skeleton::write_model(folder / "model.json", found.model);
}

nlohmann::json identify_settings(const identify::IdentifyOptions& options) {
    nlohmann::json fixed = nlohmann::json::array();
    for (const auto kind : options.fixed) fixed.push_back(name_of(stiffnesses, kind));
    return {{"fixed", fixed},
            {"parameters", name_of(scopes, options.scope)},
            {"method", name_of(methods, options.method)},
            {"law", name_of(law_choices, options.law)},
            {"particles", options.particles},
            {"iterations", options.iterations},
            {"search_low", options.search_low},
            {"search_high", options.search_high},
            {"seed", options.seed}};
}

}  // namespace palpate::pipeline
