#include "pipeline/run/run.h"

#include "identify/measurements/rig/fittable.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/case/settings/read_case.h"
#include "pipeline/command_line/terminal/console.h"
#include "pipeline/output/csv/posterior.h"
#include "pipeline/output/html/report.h"
#include "pipeline/output/vtk/findings_file.h"
#include "pipeline/output/vtk/view_script.h"
#include "pipeline/run/stages/run_diagnosis.h"
#include "pipeline/run/stages/sphere_curve.h"
#include "pipeline/run/stages/stages.h"
#include "pipeline/run/summary.h"
#include "skeleton/model/io/model_io.h"

namespace palpate::pipeline::commands {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// @throws InvalidInput where its measurements have parts that cannot be fitted yet.
Subject fittable(Subject subject) {
    if (subject.set) identify::require_fittable(*subject.set);
    return subject;
}

/// Says what was read and assumed, and writes it down.
void note_inputs(Job& job) {
    const Subject& subject = job.subject;
    Console::notices(subject.notes);
    Console::notices(subject.assumptions);
    mesh::write_text(job.folder.path() / "case.yaml", to_yaml(subject.settings));
    job.folder.note("seed", subject.settings.identify.seed);
    job.folder.note("input", subject.notes);
    job.folder.note("assumptions", subject.assumptions);
}

Outcome conclude(const Job& job, RunResults results) {
    const fs::path& folder = job.folder.path();
    results.posterior = read_posterior(folder / "identify/posterior.csv");
    const json identified = json::parse(mesh::read_text(folder / "identify/identify.json"));
    results.modes = identified["modes"];
    results.damping = identified["damping"];
    results.spheres = static_cast<int>(job.model.spheres.size());
    results.links = static_cast<int>(job.model.links.size());
    return outcome_of(job.subject, results, job.folder);
}

}  // namespace

Outcome run(const RunOptions& options, const Common& common) {
    Job job{.common = common,
            .subject = fittable(read_subject(read_case(options.input, options.overrides))),
            .folder = {options.output, common.force}};
    const fs::path& folder = job.folder.path();
    note_inputs(job);
    mesh_stage(job);
    skeleton_stage(job);
    measurement_stage(job);
    const skeleton::Model start = job.model;
    identification_stage(job);

    RunResults results;
    RunDiagnosis run_diagnosis(job.folder, job.subject, job.set, job.common);
    if (job.subject.set) results.diagnosis = run_diagnosis.diagnose(start);
    results.compare = comparison_stage(job, run_diagnosis);
    if (job.subject.set) results.ladder = run_diagnosis.improve(start, results.diagnosis);
    if (!results.ladder.is_null() && results.ladder["steps"].size() > 1)
        results.improved = json::parse(mesh::read_text(folder / "improve/compare.json"));
    measure_sphere_curve(job.folder, job.subject,
                         {.repaired = {}, .surface = job.surface, .volume = job.body, .notes = {}}, start, common);

    write_view_script(folder / "view.py");
    const skeleton::Model& found =
        results.improved.is_null() ? job.model : skeleton::read_model(folder / "improve/model.json");
    write_findings(folder / "findings.vtp", found, job.set, results.diagnosis);
    write_report(folder, folder / "report.html");
    return conclude(job, results);
}

}  // namespace palpate::pipeline::commands
