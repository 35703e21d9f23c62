#pragma once

#include <string>
#include <vector>

#include "identify/diagnosis/diagnosis.h"
#include "identify/diagnosis/ladder/ladder_options.h"
#include "identify/measurements/measurement_set.h"

namespace palpate::identify {

/// The body on the steps of a ladder: explained with a step's effects and no others. Fits begin where a diagnosis of
/// the whole set ended.
class LadderBody {
public:
    /// Keeps references. `diagnosis`: null where there is none.
    LadderBody(const BodyModel& model, const LadderOptions& options, const Diagnosis* diagnosis)
        : model_(model), options_(options), diagnosis_(diagnosis) {}

    const BodyModel& model() const { return model_; }

    Diagnosis explained(const MeasurementSet& set, const std::vector<std::string>& effects) const;
    /// The same explanation fitted to another part of the set, under its law.
    Diagnosis explained_again(const MeasurementSet& part, const Diagnosis& found) const;

    struct Unseen {
        MeasurementSet set;  // without outliers, where these are among the effects
        HeldOut predicted;
    };
    /// What an explanation with these effects predicts for probes that it was not fitted to.
    Unseen predicted(const MeasurementSet& held_out, const std::vector<std::string>& effects,
                     const Diagnosis& found) const;

private:
    skeleton::EffectRecord start_of(const std::string& name, int which) const;

    const BodyModel& model_;
    const LadderOptions& options_;
    const Diagnosis* diagnosis_;
};

}  // namespace palpate::identify
