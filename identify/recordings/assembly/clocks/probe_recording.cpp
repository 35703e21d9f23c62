#include "identify/recordings/assembly/clocks/probe_recording.h"

#include <Eigen/Dense>
#include <algorithm>

namespace palpate::identify {
namespace {

/// Mean of some points along an axis, frame by frame.
Eigen::VectorXd mean_along(const ProbeRecording& probe, const std::vector<std::string>& names, const Vec3& axis) {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(probe.times.size());
    for (const std::string& name : names) {
        Eigen::Matrix3Xd at = probe.point(name)->at;
        if (probe.is_planar) at.row(2).setZero();
        sum += at.transpose() * axis;
    }
    return sum / static_cast<double>(names.size());
}

}  // namespace

const NamedSignal* ProbeRecording::channel(const std::string& name) const {
    const auto found = std::ranges::find(channels, name, &NamedSignal::name);
    return found == channels.end() ? nullptr : &*found;
}

const RecordedPoint* ProbeRecording::point(const std::string& name) const {
    const auto found = std::ranges::find(points, name, &RecordedPoint::name);
    return found == points.end() ? nullptr : &*found;
}

void add_quantities(const ImportMap& map, ProbeRecording& probe) {
    for (const MappedQuantity& quantity : map.quantities) {
        const auto is_there = [&](const std::string& name) { return probe.point(name) != nullptr; };
        if (!std::ranges::all_of(quantity.points, is_there) || !std::ranges::all_of(quantity.minus, is_there)) continue;
        Eigen::VectorXd values = mean_along(probe, quantity.points, quantity.along);
        if (!quantity.minus.empty()) values -= mean_along(probe, quantity.minus, quantity.along);
        const Signal told = without_gaps({probe.times, values});
        if (told.values.size() > 0) values.array() -= told.values[0];
        probe.channels.push_back({quantity.name, "mm", {probe.times, values}});
    }
}

Signal leading_motion(const ProbeRecording& probe) {
    const auto frames = probe.times.size();
    Eigen::MatrixXd X(3 * std::ssize(probe.points), frames);
    for (std::size_t p = 0; p < probe.points.size(); ++p)
        X.middleRows(3 * static_cast<Eigen::Index>(p), 3) = probe.points[p].at;
    for (auto row : X.rowwise()) {
        const Signal told = without_gaps({probe.times, row.transpose()});
        const double mean = told.values.size() > 0 ? told.values.mean() : 0;
        row = row.array().isFinite().select(row.array() - mean, 0).matrix().eval();
    }
    Eigen::VectorXd v = X.colwise().norm().transpose();
    v.array() -= v.mean();
    for (int step = 0; step < 100 && v.norm() > 0; ++step) v = (X.transpose() * (X * v)).normalized();
    return {probe.times, v};
}

}  // namespace palpate::identify
