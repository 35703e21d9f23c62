#pragma once

#include <filesystem>
#include <memory>

#include "identify/diagnosis/diagnose_options.h"
#include "identify/measurements/measurement_set.h"
#include "identify/models/reference/reference_body.h"
#include "identify/motion/damping_result.h"
#include "pipeline/case/case.h"
#include "pipeline/command_line/terminal/outcome.h"
#include "skeleton/model/model.h"

namespace palpate::pipeline::commands {

struct ModelAndSet {
    skeleton::Model model;
    identify::MeasurementSet set;
};

/// A model and measurements, read; where they give different supports the set's win, said aloud.
/// @throws InvalidInput where the set has parts that cannot be fitted yet.
ModelAndSet read_model_and_set(const std::filesystem::path& model, const std::filesystem::path& set);

/// The same of what is read already. `set_name`: of the set in messages.
ModelAndSet put_together(skeleton::Model model, identify::MeasurementSet set, const std::string& set_name);

/// The set as a model understands it: without the faults of the measurement that the model records.
identify::MeasurementSet without_measurement_faults(const identify::MeasurementSet& set,
                                                    const std::vector<skeleton::EffectRecord>& effects);

/// The set's body in finite elements, with the edge length and the priors of the settings; what it assumes is said
/// aloud. @throws InvalidInput telling why there is none.
std::unique_ptr<identify::ReferenceBody> reference_of(const identify::MeasurementSet& set, const Case& settings);

/// Does a force press the body in any state? Others are of weight, tools and actuators, which `simulate` does not play.
bool have_forces(const std::vector<identify::LoadState>& states);

/// What to type next with a model that lacks nothing: to play the set's forces, or where it has none the model by hand.
std::string command_to_play(const std::filesystem::path& model, const identify::MeasurementSet& set);

/// What errors are judged on: "reference", or "skeleton", which starts from the set's Young's modulus where it has one.
/// @throws InvalidInput telling why there is no reference.
std::unique_ptr<identify::BodyModel> body_to_diagnose(const std::string& kind, const ModelAndSet& given,
                                                      const Case& settings);

/// Says aloud where a fit's Young's modulus hints at a slip of units. `compare`: with the baseline that was fitted.
void warn_of_modulus(const nlohmann::json& compare, const identify::MeasurementSet& set);

/// How a model's motion dies away, from the set's recordings, put into the model; nothing without recordings. Where it
/// cannot be told, that is said aloud.
std::optional<identify::DampingResult> damping_of(skeleton::Model& model, const identify::MeasurementSet& set,
                                                  std::uint64_t seed, const Common& common);

/// Options of a diagnosis of what a model lacks besides the effects that it has.
identify::DiagnoseOptions diagnose_options(const RunDiagnosisOptions& wanted, bool has_density,
                                           const skeleton::Model& model, const Common& common);

}  // namespace palpate::pipeline::commands
