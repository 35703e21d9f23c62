#include "identify/diagnosis/ladder/ladder_body.h"

#include <algorithm>

#include "identify/diagnosis/diagnose.h"
#include "identify/diagnosis/ladder/understood_set.h"
#include "identify/effects/catalogue.h"

namespace palpate::identify {

Diagnosis LadderBody::explained(const MeasurementSet& set, const std::vector<std::string>& effects) const {
    DiagnoseOptions options = options_.diagnose;
    options.screen = false;
    for (std::size_t e = 0; e < effects.size(); ++e) {
        const auto before =
            std::ranges::count(effects.begin(), effects.begin() + static_cast<std::ptrdiff_t>(e), effects[e]);
        options.known.push_back(start_of(effects[e], static_cast<int>(before)));
    }
    if (!set_readings_aside(effects)) options.without.push_back(effect_of_single_readings()->name());
    const bool has_residual = options_.residual && options_.residual->fit &&
                              std::ranges::find(effects, options_.residual->effect.name) != effects.end();
    if (diagnosis_ && has_residual) {
        // Far from where the diagnosis ended: what it knows of the law and of the mesh's error does not hold.
        options.law = options_.residual->fit->explanation.law;
        options.near = NeighbouringFit{&diagnosis_->problem, &*options_.residual->fit, false};
    } else if (diagnosis_) {
        options.law = diagnosis_->law;
        options.near =
            NeighbouringFit{&diagnosis_->problem, effects.empty() ? &diagnosis_->baseline : &diagnosis_->best()};
    }
    return diagnose(model_, set, options);
}

/// @param which of those of this name
skeleton::EffectRecord LadderBody::start_of(const std::string& name, int which) const {
    if (diagnosis_) {
        int next = which;
        for (const Candidate& candidate : diagnosis_->ranking) {
            if (candidate.effect->name() != name || candidate.estimate.effect.name.empty()) continue;
            if (next-- == 0) return candidate.estimate.effect;
        }
    }
    if (options_.residual && options_.residual->effect.name == name) return options_.residual->effect;
    for (const skeleton::EffectRecord& told : options_.start)
        if (told.name == name && which-- == 0) return told;
    return {name, {}};
}

Diagnosis LadderBody::explained_again(const MeasurementSet& part, const Diagnosis& found) const {
    DiagnoseOptions options = options_.diagnose;
    options.screen = false;
    options.law = found.law;
    options.known = estimate(found);
    options.near = NeighbouringFit{&found.problem, &found.best()};
    if (found.outliers.readings.empty()) options.without.push_back(effect_of_single_readings()->name());
    return diagnose(model_, part, options);
}

LadderBody::Unseen LadderBody::predicted(const MeasurementSet& held_out, const std::vector<std::string>& effects,
                                         const Diagnosis& found) const {
    const RefitOptions& how = options_.diagnose.refit;
    const Refit& fit = found.best();
    Unseen result{held_out, predict(model_, make_problem(held_out, found.noise), fit, how)};
    if (!set_readings_aside(effects)) return result;
    const Problem problem = make_problem(held_out, found.noise);
    const Eigen::VectorXd& residual = result.predicted.residual;
    const Outliers off =
        find_outliers(problem, residual, find_exchanged_markers(problem, noise_alone(problem.rows()), residual));
    result.set = without_readings(held_out, off.readings);
    result.predicted = predict(model_, make_problem(result.set, found.noise), fit, how);
    return result;
}

}  // namespace palpate::identify
