#include "identify/effects/body/material/stiffness_parts.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <string>

namespace palpate::identify {
namespace {

fem::StiffnessMap map_of(const fem::EffectRecord& record) {
    std::map<std::string, double> values;
    for (const fem::EffectParameter& p : record.parameters) values[p.name] = p.value;
    return fem::stiffness_map(fem::EffectNumbers(std::move(values)));
}

}  // namespace

StiffnessEstimate::StiffnessEstimate(const fem::EffectRecord& record, const Eigen::MatrixXd& covariance)
    : map_(map_of(record)) {
    if (covariance.size() == 0) return;
    std::vector<Eigen::Index> amplitudes;
    for (Eigen::Index p = 0; p < covariance.rows(); ++p)
        if (is_amplitude_of_map(p)) amplitudes.push_back(p);
    covariance_ = covariance(amplitudes, amplitudes);
}

double StiffnessEstimate::sd(const Vec3& X) const {
    if (covariance_.size() == 0) return 0;
    const Eigen::VectorXd w = map_.centred_weights(X);
    return std::sqrt(std::max(0.0, w.dot(covariance_ * w)));
}

std::vector<StiffnessPart> StiffnessEstimate::parts() const {
    const double least = std::log(1.25);  // design choice: smaller differences are not listed
    constexpr double deviations = 2;
    const Points& at = map_.places();
    std::vector<double> log_ratio, sds;
    std::vector<Eigen::Index> open;
    for (Eigen::Index i = 0; i < at.rows(); ++i) {
        log_ratio.push_back(log_stiffness(at.row(i)));
        sds.push_back(sd(at.row(i)));
        if (std::abs(log_ratio[i]) > std::max(least, deviations * sds[i])) open.push_back(i);
    }
    std::ranges::stable_sort(open, std::greater{}, [&](Eigen::Index i) { return std::abs(log_ratio[i]); });
    std::vector<StiffnessPart> parts;
    while (!open.empty()) {
        std::vector<Eigen::Index> own{open.front()};
        open.erase(open.begin());
        const auto belongs = [&](Eigen::Index i) {
            return std::ranges::any_of(own, [&](Eigen::Index j) {
                return log_ratio[i] * log_ratio[j] > 0 && (at.row(i) - at.row(j)).norm() <= 2 * length();
            });
        };
        for (auto next = std::ranges::find_if(open, belongs); next != open.end();
             next = std::ranges::find_if(open, belongs)) {
            own.push_back(*next);
            open.erase(next);
        }
        StiffnessPart part{.ratio = std::exp(log_ratio[own.front()])};
        part.sd = part.ratio * sds[own.front()];
        double weight = 0;
        for (const Eigen::Index i : own) {
            part.centre += std::abs(log_ratio[i]) * at.row(i).transpose();
            weight += std::abs(log_ratio[i]);
        }
        part.centre /= weight;
        parts.push_back(part);
    }
    return parts;
}

}  // namespace palpate::identify
