#include "identify/diagnosis/material_estimate.h"

#include <algorithm>
#include <cmath>

#include "identify/models/reference_body.h"

namespace palpate::identify {
namespace {

/// Of a quantity with this gradient with respect to theta (P).
double sd_along(const Eigen::VectorXd& gradient, const Refit& fit) {
    const auto variance = [&](const Eigen::MatrixXd& covariance) {
        return gradient.dot(covariance.topLeftCorner(gradient.size(), gradient.size()) * gradient);
    };
    return std::sqrt(std::max({variance(fit.covariance), variance(fit.scatter), 0.0}));
}

/// d E / d theta, by central differences.
Eigen::VectorXd slope_of_young(const BodyModel& model, const ModelSetting& setting) {
    constexpr double h = 1e-5;  // of logarithms
    Eigen::VectorXd slope(setting.theta.size());
    for (Eigen::Index j = 0; j < slope.size(); ++j) {
        ModelSetting more = setting, less = setting;
        more.theta[j] += h;
        less.theta[j] -= h;
        slope[j] = (model.young(more) - model.young(less)) / (2 * h);
    }
    return slope;
}

constexpr double fixed = 0.1;  // a prior of less, of the logarithm, leaves nothing to be fitted

std::vector<RegionEstimate> regions_of(const BodyModel& model, const Refit& fit) {
    std::vector<RegionEstimate> result;
    const Eigen::VectorXd& theta = fit.explanation.theta;
    for (Eigen::Index j = 0; j < theta.size(); ++j) {
        const auto name = region_of_parameter(model.parameters()[static_cast<std::size_t>(j)].name);
        if (!name) continue;
        const double young = std::exp(theta[j]);
        const bool is_declared = fit.prior_sd[j] < fixed;
        const double sd = is_declared ? missing : sd_along(young * Eigen::VectorXd::Unit(theta.size(), j), fit);
        result.push_back({*name, young, sd, is_declared});
    }
    return result;
}

}  // namespace

MaterialEstimate material_of(const BodyModel& model, const Refit& fit) {
    const ModelSetting setting = fit.explanation.setting();
    MaterialEstimate result;
    result.law = model.laws()[setting.law];
    result.young = model.young(setting);
    result.young_sd = sd_along(slope_of_young(model, setting), fit);
    result.regions = regions_of(model, fit);

    const auto& parameters = model.parameters();
    const auto found = std::ranges::find(parameters, "compressibility", &StiffnessParameter::name);
    if (found == parameters.end()) return result;
    // nu = (1 - e^theta) / 2
    const auto j = found - parameters.begin();
    const double ratio = std::exp(fit.explanation.theta[j]);
    result.poisson = (1 - ratio) / 2;
    result.poisson_sd = sd_along(-ratio / 2 * Eigen::VectorXd::Unit(setting.theta.size(), j), fit);
    result.poisson_is_declared = fit.prior_sd[j] < fixed;
    return result;
}

}  // namespace palpate::identify
