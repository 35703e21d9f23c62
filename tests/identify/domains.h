#pragma once

#include "identify/inference/domains/position/position_domain.h"

namespace palpate::identify {

/// The position domain of a set, with the model's own law.
inline PositionDomain make_domain(const skeleton::Model& model, Scope scope, const MeasurementSet& set) {
    return {model, model.law, group_stiffness(model, scope), collect_readings(model, set), 1};
}

/// Central differences of half the chi^2.
inline Eigen::VectorXd numeric_gradient(const PositionDomain& domain, const Eigen::VectorXd& theta) {
    constexpr double h = 1e-5;
    Eigen::VectorXd gradient(theta.size());
    for (Eigen::Index p = 0; p < theta.size(); ++p) {
        const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(theta.size(), p);
        gradient[p] = (domain.chi_squared(domain.predict(theta + step, 1)) -
                       domain.chi_squared(domain.predict(theta - step, 1))) /
                      (4 * h);
    }
    return gradient;
}

}  // namespace palpate::identify
