#include <fmt/format.h>

#include <optional>

#include "fem/elastic_body.h"
#include "mesh/errors.h"
#include "mesh/formats/vtk/vtk_files.h"
#include "mesh/text/words.h"
#include "pipeline/analysis/accuracy.h"
#include "pipeline/case/settings/settings.h"
#include "pipeline/case/subject/subject_body.h"
#include "pipeline/command_line/terminal/console.h"
#include "pipeline/run/folder/report_stage.h"
#include "pipeline/run/inputs/model_and_set.h"
#include "pipeline/run/stages/stages.h"
#include "pipeline/synthesis/probing/held_out.h"
#include "pipeline/synthesis/probing/probing.h"

namespace palpate::pipeline::commands {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// What a second mesh says of the reference.
std::string accuracy_in_words(const RunFolder& folder) {
    const json& figures = folder.record()["stages"]["measurements"]["figures"];
    if (!figures.contains("relative_error")) return "";
    return fmt::format("; off by about {}, by comparison with a coarser mesh",
                       mesh::share_of(figures["relative_error"].get<double>(), "the displacement"));
}

void write_reference_series(const fs::path& folder, const identify::MeasurementSet& set) {
    std::vector<mesh::SeriesStep> steps;
    for (std::size_t s = 0; s < set.states.size(); ++s) {
        steps.push_back(
            {static_cast<double>(s),
             folder / "measurements/field" / fmt::format("{}_{}.vtu", set.states[s].probe, set.states[s].time)});
    }
    mesh::write_pvd(folder / "reference/reference.pvd", steps);
}

}  // namespace

void measurement_stage(Job& job) {
    const Case& c = job.subject.settings;
    if (job.subject.set) {
        job.set = *job.subject.set;
        if (!c.model) {  // the run's material counts, the set's own or not
            job.set.density = job.subject.material.density;
            if (!job.set.material) job.set.material.emplace();
            job.set.material->young = job.subject.material.young;
        }
        job.fit = without_measurement_faults(job.set, job.model.effects);
        return;
    }
    const ProbeOptions& p = c.probing;
    const bool ran = job.folder.stage(
        {"measurements",
         {{"settings", settings_of_stage(c, "measurements")},
          {"regions", moduli_of(job.subject.regions)},
          {"seed", c.identify.seed}},
         {},
         {"skeleton"},
         {"measurements", "reference/reference.pvd"}},
        [&] {
            std::optional<fem::ElasticBody> elastic;
            const auto probe = [&](int loads) {
                elastic.emplace(
                    job.body, materials_of(job.subject, job.element_regions),
                    mesh::contains(job.subject.supports, job.body.nodes),
                    fem::ElasticBodyOptions{.threads = job.common.threads, .loads = loads, .solver = c.solver});
                if (!elastic->stats().note.empty()) Console::notice(elastic->stats().note);
                return probe_body(*elastic, job.surface, job.subject.supports, p, c.identify.seed, Console::progress());
            };
            ProbedBody probed;
            try {
                probed = probe(p.probes);
            } catch (const SolverFailure& failure) {  // iterations fail where a factor, slower, may not
                if (!elastic || c.solver != fem::Solver::automatic || elastic->stats().solver == fem::Solver::factor)
                    throw;
                Console::notice(failure.what());
                probed = probe(0);
            }
            probed.set.name = c.name;
            probed.set.regions = job.subject.regions;
            write_probed_body(job.folder.path() / "measurements", probed, job.body);
            write_reference_series(job.folder.path(), probed.set);
            json figures{{"states", probed.set.states.size()},
                         {"markers", probed.set.markers.size()},
                         {"factor_seconds", elastic->stats().seconds_factor}};
            const double edge = c.edge_length > 0 ? c.edge_length : default_edge_length(job.surface);
            if (const auto accuracy = estimate_accuracy(job.subject, *elastic, edge, probed.set)) {
                figures["relative_error"] = accuracy->relative;
                figures["coarser_edge_mm"] = accuracy->coarser_edge;
                figures["coarser_nodes"] = accuracy->coarser_nodes;
            }
            return figures;
        });
    job.set = identify::read_measurement_set(job.folder.path() / "measurements");
    json held_out = json::array();
    for (int probe = 1; probe <= p.probes; ++probe) {
        if (is_held_out(probe, p)) held_out.push_back(probe);
    }
    job.folder.note("held_out_probes", held_out);
    job.fit = states_of(job.set, [&](const identify::LoadState& s) { return !is_held_out(s.probe, p); });
    job.held_out = states_of(job.set, [&](const identify::LoadState& s) { return is_held_out(s.probe, p); });
    report_stage(job.folder, "measurements", ran,
                 fmt::format("{} states in small strain, {} of them held out{}", job.set.states.size(),
                             job.held_out.states.size(), accuracy_in_words(job.folder)));
}

}  // namespace palpate::pipeline::commands
