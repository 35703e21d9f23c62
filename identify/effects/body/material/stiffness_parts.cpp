#include "identify/effects/body/material/stiffness_parts.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
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
        StiffnessPart part{.peak = at.row(own.front()).transpose(), .ratio = std::exp(log_ratio[own.front()])};
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

std::vector<int> StiffnessEstimate::part_of_elements(const mesh::VolumeMesh& body) const {
    constexpr Eigen::Index corners = 4;
    const Eigen::Index count = body.tetrahedra.rows();
    Points centres = Points::Zero(count, 3);
    std::vector<std::vector<Eigen::Index>> around(static_cast<std::size_t>(body.nodes.rows()));  // elements of a node
    for (Eigen::Index e = 0; e < count; ++e) {
        for (Eigen::Index c = 0; c < corners; ++c) {
            centres.row(e) += body.nodes.row(body.tetrahedra(e, c)) / corners;
            around[static_cast<std::size_t>(body.tetrahedra(e, c))].push_back(e);
        }
    }
    std::vector<int> part_of(static_cast<std::size_t>(count), -1);
    const std::vector<StiffnessPart> all = parts();
    for (std::size_t p = 0; p < all.size(); ++p) {
        const double half = std::log(all[p].ratio) / 2;
        const auto is_open = [&](Eigen::Index e) {
            return part_of[static_cast<std::size_t>(e)] < 0 && log_stiffness(centres.row(e)) / half >= 1;
        };
        Eigen::Index first = 0;
        (centres.rowwise() - all[p].peak.transpose()).rowwise().squaredNorm().minCoeff(&first);
        std::vector<Eigen::Index> border{first};
        while (!border.empty()) {
            const Eigen::Index e = border.back();
            border.pop_back();
            if (!is_open(e)) continue;
            part_of[static_cast<std::size_t>(e)] = static_cast<int>(p);
            for (Eigen::Index c = 0; c < corners; ++c)
                std::ranges::copy_if(around[static_cast<std::size_t>(body.tetrahedra(e, c))],
                                     std::back_inserter(border), is_open);
        }
    }
    return part_of;
}

}  // namespace palpate::identify
