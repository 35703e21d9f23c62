#include "pipeline/run/stages/run_diagnosis.h"

#include <fmt/format.h>

#include "identify/diagnosis/diagnose.h"
#include "identify/diagnosis/ladder/ladder.h"
#include "mesh/errors.h"
#include "mesh/supports/region_yaml.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/case/population_prior.h"
#include "pipeline/case/settings/settings.h"
#include "pipeline/command_line/terminal/console.h"
#include "pipeline/output/json/diagnosis.h"
#include "pipeline/output/json/reference_comparison.h"
#include "pipeline/output/results/identification.h"
#include "pipeline/output/results/ladder.h"
#include "pipeline/output/text/errors.h"
#include "pipeline/output/text/words.h"
#include "pipeline/output/vtk/missing_series.h"
#include "pipeline/output/vtk/stiffness_map_file.h"
#include "pipeline/run/folder/report_stage.h"

namespace palpate::pipeline::commands {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Calls `work`; what keeps it from a result becomes a reason in words.
template <typename Work>
std::string reason_of_failure(Work&& work) {
    try {
        work();
    } catch (const InvalidInput& e) {
        return e.what();
    } catch (const SolverFailure& e) {
        return e.what();
    }
    return {};
}

}  // namespace

RunDiagnosis::RunDiagnosis(RunFolder& folder, const Subject& subject, const identify::MeasurementSet& set,
                           const Common& common)
    : folder_(folder), subject_(subject), set_(set), common_(common) {
    if (!subject.settings.diagnose.reference) why_none_ = "it was not asked for";
}

json RunDiagnosis::settings() const {
    const Case& c = subject_.settings;
    return {{"settings", settings_of_stage(c, "diagnose")},
            {"edge", c.edge_length},
            {"priors", priors_json(c.identify.priors)},
            {"density", set_.density.value_or(0)},
            {"young", subject_.material.young},
            {"supports", mesh::regions_to_yaml(set_.supports)}};
}

const identify::ReferenceBody& RunDiagnosis::reference() {
    if (!reference_) reference_ = reference_of(set_, subject_.settings);
    return *reference_;
}

const identify::Diagnosis& RunDiagnosis::diagnosed(const skeleton::Model& model) {
    if (!diagnosis_) {
        diagnosis_ = identify::diagnose(reference(), set_, how(model), Console::progress());
    }
    return *diagnosis_;
}

identify::DiagnoseOptions RunDiagnosis::how(const skeleton::Model& model) const {
    const bool has_density = !subject_.set || subject_.set->density || subject_.settings.density;
    return diagnose_options(subject_.settings.diagnose, has_density, model, common_);
}

json RunDiagnosis::diagnose(const skeleton::Model& model) {
    json result;
    if (why_none_.empty()) {
        why_none_ = reason_of_failure([&] {
            const bool ran =
                folder_.stage({"diagnose", settings(), subject_.files, {"skeleton"}, {"diagnose/diagnosis.json"}}, [&] {
                    const identify::Diagnosis& found = diagnosed(model);
                    const std::string field = write_missing_series(folder_.path() / "diagnose", set_, found);
                    write_stiffness_map(folder_.path() / "diagnose", reference().body().mesh(), set_, found);
                    result = to_json(found, reference(), set_, field);
                    mesh::write_text(folder_.path() / "diagnose/diagnosis.json", result.dump(2) + "\n");
                    return json{{"verdict", result["verdict"]}};
                });
            result = json::parse(mesh::read_text(folder_.path() / "diagnose/diagnosis.json"));
            const auto named = result["explanation"].get<std::vector<std::string>>();
            report_stage(folder_, "diagnose", ran,
                         result["verdict"].get<std::string>() + (named.empty() ? "" : ": " + listed(named)));
        });
    }
    if (why_none_.empty()) return result;

    if (subject_.settings.diagnose.reference) Console::warning("What is missing stays unknown: " + why_none_);
    for (const char* stale : {"diagnose", "improve"}) fs::remove_all(folder_.path() / stale);
    return nullptr;
}

void RunDiagnosis::compare_reference(json& compare, const skeleton::Model& model,
                                     const identify::Comparison& comparison) {
    if (why_none_.empty()) {
        why_none_ = reason_of_failure([&] {
            const identify::Diagnosis& diagnosis = diagnosed(model);
            add_reference(compare, reference(), diagnosis.problem, diagnosis.baseline, set_, comparison);
            warn_of_modulus(compare, *subject_.set);  // with what the set itself says of its material
        });
    }
    if (!why_none_.empty()) add_no_reference(compare, why_none_);
}

json RunDiagnosis::improve(const skeleton::Model& model, const json& diagnosis) {
    if (diagnosis.is_null()) return nullptr;
    identify::LadderOptions how{
        .identify = subject_.settings.identify, .diagnose = this->how(model), .only_better = true};
    how.identify.threads = common_.threads;
    const auto effects = diagnosis["explanation"].get<std::vector<std::string>>();
    json settings = this->settings();
    settings["identify"] = settings_of_stage(subject_.settings, "identify");
    settings["seed"] = how.identify.seed;
    settings["effects"] = effects;
    const fs::path folder = folder_.path() / "improve";
    const bool ran = folder_.stage({"improve", settings, subject_.files, {"skeleton", "diagnose"}, {"improve"}}, [&] {
        identify::Ladder ladder =
            identify::build_ladder(model, reference(), set_, effects, how, &diagnosed(model), Console::progress());
        ladder.identified.damping = damping_of(ladder.steps.back().model, set_, how.identify.seed, common_);
        write_ladder(folder, ladder, reference());
        return json{{"steps", ladder.steps.size()}, {"rms_mm", ladder.steps.back().skeleton.rms_mm}};
    });
    json result = json::parse(mesh::read_text(folder / "ladder.json"));
    const json& steps = result["steps"];
    for (const json& note : result["notes"]) Console::notice(note.get<std::string>());
    if (steps.size() > 1) {
        const json identified = json::parse(mesh::read_text(folder / "identify.json"));
        for (const json& note : identified["notes"])
            Console::notice(fmt::format("with {}: {}", listed(effects), note.get<std::string>()));
    }
    report_stage(folder_, "improve", ran,
                 steps.size() < 2 ? (effects.empty() ? "nothing to add" : "nothing added")
                                  : fmt::format("real-time model: {} to {} rms", rms_in_words(steps.front()),
                                                rms_in_words(steps.back())));
    return result;
}

}  // namespace palpate::pipeline::commands
