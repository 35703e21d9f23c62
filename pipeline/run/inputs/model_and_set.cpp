#include "pipeline/run/inputs/model_and_set.h"

#include <fmt/format.h>

#include <algorithm>

#include "identify/effects/catalogue.h"
#include "identify/measurements/plausibility.h"
#include "identify/measurements/rig/fittable.h"
#include "identify/models/skeleton/skeleton_body.h"
#include "identify/motion/damping.h"
#include "mesh/errors.h"
#include "mesh/supports/region_yaml.h"
#include "pipeline/body/reference_body.h"
#include "pipeline/case/subject/subject.h"
#include "pipeline/command_line/terminal/console.h"
#include "skeleton/model/io/model_io.h"

namespace palpate::pipeline::commands {

ModelAndSet read_model_and_set(const std::filesystem::path& model, const std::filesystem::path& set) {
    std::vector<std::string> notes;
    skeleton::Model read = skeleton::read_model(model);
    identify::MeasurementSet measured = read_measurements(set, notes);
    Console::notices(notes);
    return put_together(std::move(read), std::move(measured), set.string());
}

ModelAndSet put_together(skeleton::Model model, identify::MeasurementSet set, const std::string& set_name) {
    ModelAndSet read{std::move(model), std::move(set)};
    identify::require_fittable(read.set);
    if (mesh::regions_to_yaml(read.model.supports) != mesh::regions_to_yaml(read.set.supports)) {
        Console::notice("The model and the set give different supports: the set's are taken.");
        read.model.supports = read.set.supports;
        for (skeleton::Sphere& sphere : read.model.spheres) {
            sphere.held = mesh::contains(read.set.supports, sphere.center);
        }
        if (std::ranges::all_of(read.model.spheres, &skeleton::Sphere::held)) {
            throw InvalidInput(
                fmt::format("{}: the supports hold all {} spheres of the model, nothing is left to move. Give "
                            "'supports' the part that is held, in the set's own unit.",
                            set_name, read.model.spheres.size()));
        }
    }
    return read;
}

identify::MeasurementSet without_measurement_faults(const identify::MeasurementSet& set,
                                                    const std::vector<skeleton::EffectRecord>& effects) {
    identify::MeasurementSet result = set;
    for (const skeleton::EffectRecord& effect : effects) {
        if (skeleton::is_body_effect(effect.name)) continue;
        result = identify::find_effect(effect.name)->corrected(result, effect);
        Console::notice(fmt::format("The model records a fault of the measurement: {}. It is taken off the readings.",
                                    effect.name));
    }
    return result;
}

bool have_forces(const std::vector<identify::LoadState>& states) {
    return std::ranges::any_of(states, identify::has_contact_force);
}

std::string command_to_play(const std::filesystem::path& model, const identify::MeasurementSet& set) {
    if (!have_forces(set.states)) return "palpate play " + model.string();
    return fmt::format("palpate simulate {} --probes {} -o played", model.string(),
                       (set.folder / "probes.csv").lexically_normal().string());
}

std::unique_ptr<identify::ReferenceBody> reference_of(const identify::MeasurementSet& set, const Case& settings) {
    Reference reference = make_reference(set, settings.edge_length, Console::progress(), settings.identify.priors);
    Console::notices(reference.notes);
    if (!reference.body) {
        throw InvalidInput("the body cannot be made of finite elements: " + reference.why_none);
    }
    return std::move(reference.body);
}

std::unique_ptr<identify::BodyModel> body_to_diagnose(const std::string& kind, const ModelAndSet& given,
                                                      const Case& settings) {
    if (kind != "skeleton") return reference_of(given.set, settings);
    constexpr double start_young = 0.1;  // [MPa], where the set has no guess
    constexpr double prior_sd = 3;       // of the logarithm of a stiffness that no specimen tells of
    const bool is_declared = given.set.material && given.set.material->young > 0;
    return std::make_unique<identify::SkeletonBody>(
        given.model, given.set.markers, is_declared ? given.set.material->young : start_young,
        identify::Rig{given.set.tools, given.set.actuators}, prior_sd, settings.identify.priors);
}

void warn_of_modulus(const nlohmann::json& compare, const identify::MeasurementSet& set) {
    if (!compare["baseline"].is_object()) return;
    const std::string words = identify::implausible_modulus(compare["baseline"]["young_mpa"], set);
    if (!words.empty()) Console::warning(words);
}

std::optional<identify::DampingResult> damping_of(skeleton::Model& model, const identify::MeasurementSet& set,
                                                  std::uint64_t seed, const Common& common) {
    try {
        identify::DampingOptions options;
        options.seed = seed;
        options.threads = common.threads;
        return identify::identify_damping(model, set, options, Console::progress());
    } catch (const InvalidInput& e) {
        Console::warning(fmt::format("damping was not identified: {}", e.what()));
    } catch (const SolverFailure& e) {
        Console::warning(fmt::format("damping was not identified: {}", e.what()));
    }
    return std::nullopt;
}

identify::DiagnoseOptions diagnose_options(const RunDiagnosisOptions& wanted, bool has_density,
                                           const skeleton::Model& model, const Common& common) {
    identify::DiagnoseOptions options = wanted.in_set(has_density);
    options.known = model.effects;
    options.refit.threads = common.threads;
    return options;
}

}  // namespace palpate::pipeline::commands
