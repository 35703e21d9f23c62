#pragma once

#include "identify/fit/position_domain.h"

namespace palpate::identify {

/// The position domain of a set, with the model's own law.
inline PositionDomain make_domain(const skeleton::Model& model, Scope scope, const MeasurementSet& set) {
    return {model, model.law, group_stiffness(model, scope), collect_readings(model, set), 1};
}

}  // namespace palpate::identify
