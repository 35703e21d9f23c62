#include "identify/live/change_detector.h"

#include <algorithm>
#include <cmath>

namespace palpate::identify {
namespace {

constexpr double expected = 3, alarming = 15;  // of the cumulative sum of -ln p: what is taken off it, and its bound
constexpr double most_surprising = 12;         // -ln p of one reading: one alone is a slip, not a change

}  // namespace

void ChangeDetector::add(const StateName& name, double p, const StateReadings& readings,
                         const LinearisedReading& local) {
    const double surprise = std::min(most_surprising, -std::log(std::max(p, 1e-300)));
    sum = std::max(0.0, sum + surprise - expected);
    if (sum == 0) {
        since.reset();
        off.setZero();
        count = 0;
        return;
    }
    if (!since) since = name;
    ++count;
    for (std::size_t i = 0; i < readings.markers.size(); ++i) {
        const auto row = static_cast<Eigen::Index>(3 * i);
        const double variance = local.variance.segment<3>(row).sum();
        if (variance > 0) {
            off[readings.markers[i]] += 3 * local.d.segment<3>(row).squaredNorm() / variance;
        }
    }
}

std::optional<Alarm> ChangeDetector::alarm(const std::vector<Marker>& markers) const {
    if (sum < alarming || !since) return std::nullopt;
    Alarm alarm{*since};
    if (off.size() == 0) return alarm;
    Eigen::Index worst = 0;
    const double most = off.maxCoeff(&worst);
    alarm.marker = static_cast<int>(worst);
    alarm.at = markers[alarm.marker].rest;
    alarm.whitened_rms = std::sqrt(most / (3.0 * std::max(1, count)));
    return alarm;
}

}  // namespace palpate::identify
