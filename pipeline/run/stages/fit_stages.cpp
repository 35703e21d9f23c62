#include <fmt/format.h>

#include "identify/comparison/compare.h"
#include "identify/identify.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/case/population_prior.h"
#include "pipeline/case/settings/settings.h"
#include "pipeline/command_line/terminal/console.h"
#include "pipeline/output/json/comparison.h"
#include "pipeline/output/json/reference_comparison.h"
#include "pipeline/output/results/identification.h"
#include "pipeline/output/vtk/series.h"
#include "pipeline/run/folder/report_stage.h"
#include "pipeline/run/stages/run_diagnosis.h"
#include "pipeline/run/stages/stages.h"
#include "skeleton/model/io/model_io.h"

// The stages of a run that fit the skeleton, and tell how wrong it is.

namespace palpate::pipeline::commands {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

json error_json(const Job& job, const identify::MeasurementSet& part) {
    return to_json(identify::compare(job.model, part, job.common.threads), part)["error"];
}

}  // namespace

void identification_stage(Job& job) {
    const Case& c = job.subject.settings;
    identify::IdentifyOptions options = c.identify;
    options.threads = job.common.threads;
    // Our own reference is linear, and says so.
    if (!job.subject.set) options.law = identify::LawChoice::linear;
    const json settings{{"settings", settings_of_stage(c, "identify")},
                        {"priors", priors_json(options.priors)},
                        {"seed", options.seed}};
    const bool ran = job.folder.stage(
        {"identify",
         settings,
         job.subject.set ? job.subject.files : std::vector<fs::path>{},
         job.subject.set ? std::vector<std::string>{"skeleton"} : std::vector<std::string>{"skeleton", "measurements"},
         {"identify/model.json", "identify/posterior.csv", "identify/particles.csv", "identify/identify.json",
          "identify/history.pvd"}},
        [&] {
            identify::IdentifyResult found = identify::identify(job.model, job.fit, options, Console::progress());
            // In small strain both laws agree, and a real-time model is to be bent far.
            if (!job.subject.set) found.model.law = skeleton::EquilibriumLaw::large_rotation;
            found.damping = damping_of(found.model, job.fit, options.seed, job.common);
            for (const std::string& note : found.notes)
                Console::notice((job.subject.set ? "nothing added: " : "") + note);
            write_identification(job.folder.path() / "identify", found);
            return summary_json(found);
        });
    job.model = skeleton::read_model(job.folder.path() / "identify/model.json");
    report_stage(job.folder, "identify", ran,
                 fmt::format("{} parameters, {} of them constrained by the measurements",
                             job.folder.record()["stages"]["identify"]["figures"].value("parameters", 0),
                             job.folder.record()["stages"]["identify"]["figures"].value("informed", 0)));
}

json comparison_stage(Job& job, RunDiagnosis& run_diagnosis) {
    const fs::path folder = job.folder.path() / "compare";
    json settings = job.subject.set ? run_diagnosis.settings() : json{{"noise", job.subject.settings.probing.noise}};
    const bool ran = job.folder.stage({"compare", settings, {}, {"identify"}, {"compare"}}, [&] {
        const identify::MeasurementSet& set = job.subject.set ? job.fit : job.set;
        const identify::Comparison comparison = identify::compare(job.model, set, job.common.threads);
        json result = to_json(comparison, set);
        if (!job.held_out.states.empty()) {
            result["fitted"] = error_json(job, job.fit);
            result["held_out"] = error_json(job, job.held_out);
            result["held_out"]["worst_probes"] =
                worst_probes_json(identify::compare(job.model, job.held_out, job.common.threads), job.held_out);
        }
        if (job.subject.set) {
            run_diagnosis.compare_reference(result, job.model, comparison);
        } else {
            add_own_reference(result, job.subject.settings.probing.noise);
        }
        mesh::write_text(folder / "compare.json", result.dump(2) + "\n");
        write_played_series(folder, job.model, set, comparison);
        return json{{"relative", result["error"]["relative"]}};
    });
    json result = json::parse(mesh::read_text(folder / "compare.json"));
    const json& error = result["error"];
    report_stage(job.folder, "compare", ran,
                 result["probes"].empty() && error.contains("reactions")
                     ? fmt::format("real-time model: {:.3g} N rms", error["reactions"]["rms_n"].get<double>())
                     : fmt::format("real-time model: {:.3g} mm rms", error["rms_mm"].get<double>()));
    return result;
}

}  // namespace palpate::pipeline::commands
