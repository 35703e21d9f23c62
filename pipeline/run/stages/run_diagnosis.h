#pragma once

#include "identify/comparison/comparison.h"
#include "identify/diagnosis/diagnosis.h"
#include "pipeline/case/subject/subject.h"
#include "pipeline/run/folder/run_folder.h"
#include "pipeline/run/inputs/model_and_set.h"

namespace palpate::pipeline::commands {

/// The diagnosis stages of a run on measurements: diagnose, compare, improve. A stage that was
/// finished before is read back instead; the body in finite elements is made only when a stage needs it, and diagnosed
/// once for all of them: anew for a stage that comes after one that was read back, as its fits start from what the
/// diagnosis found, and no file holds that to the last digit.
class RunDiagnosis {
public:
    /// @param set the measurements as the run takes them: its supports, its material
    RunDiagnosis(RunFolder& folder, const Subject& subject, const identify::MeasurementSet& set, const Common& common);

    /// diagnosis.json; null where there is no reference body, or no diagnosis on it: why is said aloud.
    nlohmann::json diagnose(const skeleton::Model& model);
    /// What the reference body adds to compare.json.
    void compare_reference(nlohmann::json& compare, const skeleton::Model& model,
                           const identify::Comparison& comparison);
    /// ladder.json of what the diagnosis names, added to the model as it was before identification; null without a
    /// diagnosis.
    nlohmann::json improve(const skeleton::Model& model, const nlohmann::json& diagnosis);

    /// What the reference body depends on, for the stages' keys.
    nlohmann::json settings() const;

private:
    const identify::ReferenceBody& reference();
    identify::DiagnoseOptions how(const skeleton::Model& model) const;
    const identify::Diagnosis& diagnosed(const skeleton::Model& model);

    RunFolder& folder_;
    const Subject& subject_;
    const identify::MeasurementSet& set_;
    const Common& common_;
    std::unique_ptr<identify::ReferenceBody> reference_;
    std::optional<identify::Diagnosis> diagnosis_;
    std::string why_none_;
};

}  // namespace palpate::pipeline::commands
