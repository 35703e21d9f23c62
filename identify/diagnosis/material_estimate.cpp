#include "identify/diagnosis/material_estimate.h"

#include <algorithm>
#include <cmath>

#include "identify/diagnosis/fit/priors/fit_priors.h"
#include "identify/models/reference/reference_body.h"

namespace palpate::identify {
namespace {

/// Deviation of a quantity that a setting tells, with all numbers of the fit uncertain, those of effects among them: by
/// central differences.
template <typename Quantity>
double sd_of(const Quantity& quantity, const Refit& fit) {
    constexpr double h = 1e-5;  // of logarithms, and of numbers about as large
    const Eigen::VectorXd x = fit.explanation.all();
    Explanation moved = fit.explanation;
    const auto at = [&](Eigen::Index j, double step) {
        Eigen::VectorXd there = x;
        there[j] += step;
        moved.set_all(there);
        return quantity(moved.setting());
    };
    Eigen::VectorXd slope(x.size());
    for (Eigen::Index j = 0; j < x.size(); ++j) slope[j] = (at(j, h) - at(j, -h)) / (2 * h);
    return std::sqrt(std::max({slope.dot(fit.covariance * slope), slope.dot(fit.scatter * slope), 0.0}));
}

std::vector<RegionEstimate> regions_of(const BodyModel& model, const Refit& fit) {
    std::vector<RegionEstimate> result;
    const Eigen::VectorXd theta = fit.explanation.setting().theta;
    for (Eigen::Index j = 0; j < theta.size(); ++j) {
        const auto name = region_of_parameter(model.parameters()[static_cast<std::size_t>(j)].name);
        if (!name) continue;
        const auto young_of = [j](const ModelSetting& setting) { return std::exp(setting.theta[j]); };
        const bool is_declared = fit.prior_sd[j] < told_prior_sd;
        result.push_back({*name, std::exp(theta[j]), is_declared ? missing : sd_of(young_of, fit), is_declared});
    }
    return result;
}

}  // namespace

MaterialEstimate material_of(const BodyModel& model, const Refit& fit) {
    const ModelSetting setting = fit.explanation.setting();
    MaterialEstimate result;
    result.law = model.laws()[setting.law];
    result.young = model.young(setting);
    result.young_sd = sd_of([&](const ModelSetting& at) { return model.young(at); }, fit);
    result.regions = regions_of(model, fit);

    const auto& parameters = model.parameters();
    const auto found = std::ranges::find(parameters, "compressibility", &StiffnessParameter::name);
    if (found == parameters.end()) return result;
    const auto j = found - parameters.begin();
    const auto ratio_of = [j](const ModelSetting& at) { return (1 - std::exp(at.theta[j])) / 2; };
    result.poisson = ratio_of(setting);
    result.poisson_sd = sd_of(ratio_of, fit);
    // An effect may say that it is another one.
    result.poisson_is_declared = fit.prior_sd[j] < told_prior_sd && setting.theta[j] == fit.explanation.theta[j];
    return result;
}

}  // namespace palpate::identify
