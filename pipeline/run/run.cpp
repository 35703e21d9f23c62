#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>

#include "fem/elastic_body.h"
#include "identify/comparison/compare.h"
#include "identify/identify.h"
#include "identify/measurements/rig/fittable.h"
#include "mesh/errors.h"
#include "mesh/formats/surface/read_surface.h"
#include "mesh/formats/vtk/vtk_files.h"
#include "mesh/supports/held_parts.h"
#include "mesh/supports/region_yaml.h"
#include "mesh/text/atomic_file.h"
#include "mesh/text/words.h"
#include "pipeline/analysis/accuracy.h"
#include "pipeline/body/body.h"
#include "pipeline/body/region_field.h"
#include "pipeline/body/subject_body.h"
#include "pipeline/case/population_prior.h"
#include "pipeline/case/read_case.h"
#include "pipeline/case/settings/settings.h"
#include "pipeline/output/csv/posterior.h"
#include "pipeline/output/html/report.h"
#include "pipeline/output/identification.h"
#include "pipeline/output/json/comparison.h"
#include "pipeline/output/json/reference_comparison.h"
#include "pipeline/output/vtk/findings_file.h"
#include "pipeline/output/vtk/series.h"
#include "pipeline/output/vtk/view_script.h"
#include "pipeline/run/folder/run_folder.h"
#include "pipeline/run/run_diagnosis.h"
#include "pipeline/run/sphere_curve.h"
#include "pipeline/run/summary.h"
#include "pipeline/synthesis/probing/held_out.h"
#include "pipeline/synthesis/probing/probing.h"
#include "skeleton/construction/build.h"
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

/// The materials of regions, which stages depend on beside the files of their surfaces.
json moduli_of(const std::vector<mesh::MaterialRegion>& regions) {
    json all = json::array();
    for (const mesh::MaterialRegion& region : regions)
        all.push_back({region.name, region.label.value_or(0), region.young.value_or(0), region.poisson.value_or(0),
                       region.density.value_or(0)});
    return all;
}

/// The stages of a run, one after the other. Each leaves its result as a file and a member; a stage that was finished
/// before is read back instead.
class Run {
public:
    Run(const RunOptions& options, const Common& common)
        : common_(common),
          subject_(fittable(read_subject(read_case(options.input, options.overrides)))),
          folder_(options.output, common.force) {}

    Outcome execute() {
        Console::notices(subject_.notes);
        Console::notices(subject_.assumptions);
        mesh::write_text(folder_.path() / "case.yaml", to_yaml(subject_.settings));
        folder_.note("seed", subject_.settings.identify.seed);
        folder_.note("input", subject_.notes);
        folder_.note("assumptions", subject_.assumptions);
        make_mesh();
        make_skeleton();
        make_measurements();
        const skeleton::Model start = model_;
        calibrate();
        RunResults results;
        RunDiagnosis run_diagnosis(folder_, subject_, set_, common_);
        if (subject_.set) results.diagnosis = run_diagnosis.diagnose(start);
        results.compare = compare_all(run_diagnosis);
        if (subject_.set) results.ladder = run_diagnosis.improve(start, results.diagnosis);
        if (!results.ladder.is_null() && results.ladder["steps"].size() > 1)
            results.improved = json::parse(mesh::read_text(folder_.path() / "improve/compare.json"));
        measure_sphere_curve(folder_, subject_, {.repaired = {}, .surface = surface_, .volume = body_, .notes = {}},
                             start, common_);
        write_view_script(folder_.path() / "view.py");
        const skeleton::Model& found =
            results.improved.is_null() ? model_ : skeleton::read_model(folder_.path() / "improve/model.json");
        write_findings(folder_.path() / "findings.vtp", found, set_, results.diagnosis);
        write_report(folder_.path(), folder_.path() / "report.html");
        return conclude(results);
    }

private:
    void make_mesh() {
        const Case& c = subject_.settings;
        if (c.model) {  // there is a skeleton already: the surface is for pictures
            mesh::write_vtp(folder_.path() / "mesh/surface.vtp", subject_.surface);
            return;
        }
        json key = settings_of_stage(c, "mesh");
        key["supports"] = mesh::regions_to_yaml(subject_.supports);  // elements end at their borders
        if (!subject_.regions.empty()) key["regions"] = moduli_of(subject_.regions);
        const bool ran = folder_.stage({"mesh", key, subject_.files, {}, {"mesh/body.vtu", "mesh/surface.vtp"}}, [&] {
            const MeshedBody body = make_body(subject_, {c.edge_length, c.linear_elements}, Console::progress());
            for (const std::string& note : body.notes) Console::notice("Repair: " + note);
            mesh::write_vtu(folder_.path() / "mesh/body.vtu", body.volume,
                            regions_shown(element_regions(subject_, body)));
            mesh::write_vtp(folder_.path() / "mesh/surface.vtp", body.surface);
            return json{{"nodes", body.volume.nodes.rows()},
                        {"tetrahedra", body.volume.tetrahedra.rows()},
                        {"volume_mm3", mesh::element_volumes(body.volume).sum()},
                        {"repair", body.notes}};
        });
        mesh::MeshData data;
        body_ = mesh::read_vtu(folder_.path() / "mesh/body.vtu", &data);
        element_regions_ = regions_read(data);
        surface_ = mesh::read_surface(folder_.path() / "mesh/surface.vtp");
        tell("mesh", ran, fmt::format("{} tetrahedra, {} nodes", body_.tetrahedra.rows(), body_.nodes.rows()));
        report_supports();
    }

    /// What each support holds of the mesh, and whether that is enough.
    void report_supports() {
        json words = json::array();
        const std::vector<mesh::HeldPart> parts = mesh::held_parts(subject_.supports, body_);
        for (std::size_t i = 0; i < parts.size(); ++i) {
            words.push_back(mesh::describe_held_part(subject_.supports, parts, i, "nodes of the mesh"));
            Console::notice("held         " + words.back().get<std::string>());
        }
        for (const std::string& warning : mesh::too_little_held(subject_.supports, body_)) {
            words.push_back(warning);
            Console::warning(warning);
        }
        folder_.note("supports", words);
    }

    void make_skeleton() {
        const Case& c = subject_.settings;
        const fs::path file = folder_.path() / "skeleton/model.json";
        if (c.model) {
            take_model(*c.model);
            return;
        }
        const bool ran =
            folder_.stage({"skeleton",
                           {{"settings", settings_of_stage(c, "skeleton")},
                            {"young", subject_.material.young},
                            {"poisson", subject_.material.poisson},
                            {"density", subject_.material.density},
                            {"regions", moduli_of(subject_.regions)},
                            {"supports", mesh::regions_to_yaml(subject_.supports)}},
                           {},
                           {"mesh"},
                           {"skeleton/model.json", "skeleton/skeleton.vtp", "skeleton/medial_axis.vtp"}},
                          [&] {
                              skeleton::BuildReport report;
                              skeleton::Model model = skeleton::build_skeleton(surface_, body_, subject_.material,
                                                                               subject_.supports, c.skeleton, &report);
                              model.name = c.name;
                              std::ranges::move(take_regions(subject_.regions, subject_.material.young, model),
                                                std::back_inserter(report.notes));
                              Console::notices(report.notes);
                              skeleton::write_model(file, model);
                              skeleton::write_model_vtp(folder_.path() / "skeleton/skeleton.vtp", model);
                              mesh::write_vtp_lines(folder_.path() / "skeleton/medial_axis.vtp", report.medial_centers,
                                                    {}, {.points = {{"radius [mm]", report.medial_radii}}});
                              const auto held = std::count_if(model.spheres.begin(), model.spheres.end(),
                                                              [](auto& s) { return s.held; });
                              return json{{"spheres", model.spheres.size()},
                                          {"held_spheres", held},
                                          {"links", model.links.size()},
                                          {"coverage_mm", report.coverage},
                                          {"notes", report.notes}};
                          });
        model_ = skeleton::read_model(file);
        tell("skeleton", ran, fmt::format("{} spheres, {} links", model_.spheres.size(), model_.links.size()));
    }

    void take_model(const fs::path& given) {
        folder_.stage({"skeleton", {}, {given}, {}, {"skeleton/model.json", "skeleton/skeleton.vtp"}}, [&] {
            const skeleton::Model model = skeleton::read_model(given);
            skeleton::write_model(folder_.path() / "skeleton/model.json", model);
            skeleton::write_model_vtp(folder_.path() / "skeleton/skeleton.vtp", model);
            return json{{"spheres", model.spheres.size()}, {"links", model.links.size()}};
        });
        model_ = skeleton::read_model(folder_.path() / "skeleton/model.json");
        Console::notice(
            fmt::format("skeleton     {} spheres, {} links, as given", model_.spheres.size(), model_.links.size()));
    }

    void make_measurements() {
        const Case& c = subject_.settings;
        if (subject_.set) {
            set_ = *subject_.set;
            if (!c.model) {  // the run's material counts, the set's own or not
                set_.density = subject_.material.density;
                if (!set_.material) set_.material.emplace();
                set_.material->young = subject_.material.young;
            }
            fit_ = without_measurement_faults(set_, model_.effects);
            return;
        }
        const ProbeOptions& p = c.probing;
        const bool ran = folder_.stage(
            {"measurements",
             {{"settings", settings_of_stage(c, "measurements")},
              {"regions", moduli_of(subject_.regions)},
              {"seed", c.identify.seed}},
             {},
             {"skeleton"},
             {"measurements", "reference/reference.pvd"}},
            [&] {
                std::optional<fem::ElasticBody> elastic;
                const auto probe = [&](int loads) {
                    elastic.emplace(body_, materials_of(subject_, element_regions_),
                                    mesh::contains(subject_.supports, body_.nodes),
                                    fem::ElasticBodyOptions{.threads = common_.threads, .loads = loads});
                    if (!elastic->stats().note.empty()) Console::notice(elastic->stats().note);
                    return probe_body(*elastic, surface_, subject_.supports, p, c.identify.seed, Console::progress());
                };
                ProbedBody probed;
                try {
                    probed = probe(p.probes);
                } catch (const SolverFailure& failure) {  // iterations fail where a factor, slower, may not
                    if (!elastic || elastic->stats().levels == 0) throw;
                    Console::notice(failure.what());
                    probed = probe(0);
                }
                probed.set.name = c.name;
                probed.set.regions = subject_.regions;
                write_probed_body(folder_.path() / "measurements", probed, body_);
                write_reference_series(probed.set);
                json figures{{"states", probed.set.states.size()},
                             {"markers", probed.set.markers.size()},
                             {"factor_seconds", elastic->stats().seconds_factor}};
                const double edge = c.edge_length > 0 ? c.edge_length : default_edge_length(surface_);
                if (const auto accuracy = estimate_accuracy(subject_, *elastic, edge, probed.set)) {
                    figures["relative_error"] = accuracy->relative;
                    figures["coarser_edge_mm"] = accuracy->coarser_edge;
                    figures["coarser_nodes"] = accuracy->coarser_nodes;
                }
                return figures;
            });
        set_ = identify::read_measurement_set(folder_.path() / "measurements");
        json held_out = json::array();
        for (int probe = 1; probe <= p.probes; ++probe) {
            if (is_held_out(probe, p)) held_out.push_back(probe);
        }
        folder_.note("held_out_probes", held_out);
        fit_ = states_of(set_, [&](const identify::LoadState& s) { return !is_held_out(s.probe, p); });
        held_out_ = states_of(set_, [&](const identify::LoadState& s) { return is_held_out(s.probe, p); });
        tell("measurements", ran,
             fmt::format("{} states in small strain, {} of them held out{}", set_.states.size(),
                         held_out_.states.size(), accuracy_in_words()));
    }

    /// What a second mesh says of the reference.
    std::string accuracy_in_words() const {
        const json& figures = folder_.record()["stages"]["measurements"]["figures"];
        if (!figures.contains("relative_error")) return "";
        return fmt::format("; off by about {}, by comparison with a coarser mesh",
                           mesh::share_of(figures["relative_error"].get<double>(), "the displacement"));
    }

    void write_reference_series(const identify::MeasurementSet& set) const {
        std::vector<mesh::SeriesStep> steps;
        for (std::size_t s = 0; s < set.states.size(); ++s) {
            steps.push_back(
                {static_cast<double>(s), folder_.path() / "measurements/field" /
                                             fmt::format("{}_{}.vtu", set.states[s].probe, set.states[s].time)});
        }
        mesh::write_pvd(folder_.path() / "reference/reference.pvd", steps);
    }

    void calibrate() {
        const Case& c = subject_.settings;
        identify::IdentifyOptions options = c.identify;
        options.threads = common_.threads;
        // Our own reference is linear, and says so.
        if (!subject_.set) options.law = identify::LawChoice::linear;
        const json settings{{"settings", settings_of_stage(c, "identify")},
                            {"priors", priors_json(options.priors)},
                            {"seed", options.seed}};
        const bool ran = folder_.stage(
            {"identify",
             settings,
             subject_.set ? subject_.files : std::vector<fs::path>{},
             subject_.set ? std::vector<std::string>{"skeleton"} : std::vector<std::string>{"skeleton", "measurements"},
             {"identify/model.json", "identify/posterior.csv", "identify/particles.csv", "identify/identify.json",
              "identify/history.pvd"}},
            [&] {
                identify::IdentifyResult found = identify::identify(model_, fit_, options, Console::progress());
                // In small strain both laws agree, and a real-time model is to be bent far.
                if (!subject_.set) found.model.law = skeleton::EquilibriumLaw::large_rotation;
                found.damping = damping_of(found.model, fit_, options.seed, common_);
                for (const std::string& note : found.notes)
                    Console::notice((subject_.set ? "nothing added: " : "") + note);
                write_identification(folder_.path() / "identify", found);
                return summary_json(found);
            });
        model_ = skeleton::read_model(folder_.path() / "identify/model.json");
        tell("identify", ran,
             fmt::format("{} parameters, {} of them informed by the measurements",
                         folder_.record()["stages"]["identify"]["figures"].value("parameters", 0),
                         folder_.record()["stages"]["identify"]["figures"].value("informed", 0)));
    }

    json compare_all(RunDiagnosis& run_diagnosis) {
        const fs::path folder = folder_.path() / "compare";
        json settings = subject_.set ? run_diagnosis.settings() : json{{"noise", subject_.settings.probing.noise}};
        const bool ran = folder_.stage({"compare", settings, {}, {"identify"}, {"compare"}}, [&] {
            const identify::MeasurementSet& set = subject_.set ? fit_ : set_;
            const identify::Comparison comparison = identify::compare(model_, set, common_.threads);
            json result = to_json(comparison, set);
            if (!held_out_.states.empty()) {
                result["fitted"] = error_json(fit_);
                result["held_out"] = error_json(held_out_);
                result["held_out"]["worst_probes"] =
                    worst_probes_json(identify::compare(model_, held_out_, common_.threads), held_out_);
            }
            if (subject_.set) {
                run_diagnosis.compare_reference(result, model_, comparison);
            } else {
                add_own_reference(result, subject_.settings.probing.noise);
            }
            mesh::write_text(folder / "compare.json", result.dump(2) + "\n");
            write_played_series(folder, model_, set, comparison);
            return json{{"relative", result["error"]["relative"]}};
        });
        json result = json::parse(mesh::read_text(folder / "compare.json"));
        const json& error = result["error"];
        tell("compare", ran,
             result["probes"].empty() && error.contains("reactions")
                 ? fmt::format("{:.3g} N rms", error["reactions"]["rms_n"].get<double>())
                 : fmt::format("{:.3g} mm rms", error["rms_mm"].get<double>()));
        return result;
    }

    json error_json(const identify::MeasurementSet& part) const {
        return to_json(identify::compare(model_, part, common_.threads), part)["error"];
    }

    Outcome conclude(RunResults results) const {
        results.posterior = read_posterior(folder_.path() / "identify/posterior.csv");
        const json identified = json::parse(mesh::read_text(folder_.path() / "identify/identify.json"));
        results.modes = identified["modes"];
        results.damping = identified["damping"];
        results.spheres = static_cast<int>(model_.spheres.size());
        results.links = static_cast<int>(model_.links.size());
        return outcome_of(subject_, results, folder_);
    }

    void tell(const std::string& stage, bool ran, const std::string& what) const {
        report_stage(folder_, stage, ran, what);
    }

    Common common_;
    Subject subject_;
    RunFolder folder_;
    mesh::VolumeMesh body_;
    std::vector<int> element_regions_;  // of the body; empty: it is of one material
    mesh::Surface surface_;
    skeleton::Model model_;
    identify::MeasurementSet set_, fit_, held_out_;
};

}  // namespace

Outcome run(const RunOptions& options, const Common& common) { return Run(options, common).execute(); }

}  // namespace palpate::pipeline::commands
