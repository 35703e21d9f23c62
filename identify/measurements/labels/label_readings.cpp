#include "identify/measurements/labels/label_readings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "identify/measurements/labels/coherent_drift.h"
#include "mesh/numbers/median.h"

namespace palpate::identify {
namespace {

constexpr double smoothness = 0.8, reach = 0.1;  // of the markers' largest extent
constexpr double first_sigma = 3;                // of the distance between neighbours
constexpr double least_sigma = 1e-3;             // of it, where the noise is less
constexpr double clear = 0.9;                    // probability
constexpr double clearly_nearer = 0.5;           // than the second nearest

/// What is the same for all states.
struct Markers {
    Points rest;  // (m x 3) [mm]
    DriftOptions how;

    explicit Markers(const MeasurementSet& set) : rest(std::ssize(set.markers), 3) {
        for (Eigen::Index m = 0; m < rest.rows(); ++m) rest.row(m) = set.markers[m].rest.transpose();
        const double box = (rest.colwise().maxCoeff() - rest.colwise().minCoeff()).maxCoeff();
        const double extent = box > 0 ? box : 1;  // one marker alone
        const double apart = neighbour_distance(extent);
        how.smoothness = smoothness * extent;
        how.reach = reach * extent;
        how.first_sigma = first_sigma * apart;
        how.least_sigma = std::max(least_sigma * apart, set.position_noise.value_or(0));
    }

    /// Median over the markers of the distance to the nearest other; `extent` for one alone.
    double neighbour_distance(double extent) const {
        if (rest.rows() < 2) return extent;
        std::vector<double> nearest;
        nearest.reserve(rest.rows());
        for (Eigen::Index m = 0; m < rest.rows(); ++m) {
            Eigen::VectorXd squares = (rest.rowwise() - rest.row(m)).rowwise().squaredNorm();
            squares[m] = extent * extent;
            nearest.push_back(std::sqrt(squares.minCoeff()));
        }
        return mesh::upper_median(std::move(nearest));
    }
};

/// A reading of some coordinates is of the moved marker that is clearly the nearest in them; -1 where none is.
int nearest_in(const Vec3& reading, const Points& moved, const std::vector<char>& is_taken, double near) {
    int best = -1;
    double first = std::numeric_limits<double>::infinity(), second = first;
    for (Eigen::Index m = 0; m < moved.rows(); ++m) {
        const Eigen::Array3d off = reading.array() - moved.row(m).transpose().array();
        if (is_taken[m] != 0 || off.isNaN().all()) continue;
        const double distance = std::sqrt(off.isNaN().select(0, off).square().sum());
        if (distance < first) {
            second = std::exchange(first, distance);
            best = static_cast<int>(m);
        } else {
            second = std::min(second, distance);
        }
    }
    return first < clearly_nearer * second && first < near ? best : -1;
}

void label(const Markers& markers, LoadState& state) {
    // the complete readings lead
    std::vector<int> rows, known;
    std::vector<char> is_taken(markers.rest.rows(), 0);
    for (int r = 0; r < static_cast<int>(state.readings.size()); ++r) {
        const Reading& reading = state.readings[r];
        if (reading.since) continue;  // a difference is no place
        if (reading.marker >= 0) is_taken[reading.marker] = 1;
        if (reading.position.array().isNaN().any()) continue;
        rows.push_back(r);
        known.push_back(reading.marker);
    }
    Points readings(std::ssize(rows), 3);
    for (Eigen::Index i = 0; i < readings.rows(); ++i) readings.row(i) = state.readings[rows[i]].position.transpose();
    const Drift drift = coherent_drift(markers.rest, readings, known, markers.how);

    // clear on both sides
    for (Eigen::Index i = 0; i < readings.rows(); ++i) {
        Eigen::Index m = 0;
        if (known[i] >= 0 || drift.P.col(i).maxCoeff(&m) < clear) continue;
        if (drift.P.row(m).sum() - drift.P(m, i) > 1 - clear) continue;
        state.readings[rows[i]].marker = static_cast<int>(m);
        is_taken[m] = 1;
    }
    for (Reading& reading : state.readings) {
        if (reading.marker >= 0 || !reading.position.array().isNaN().any()) continue;
        reading.marker = nearest_in(reading.position, drift.moved, is_taken, markers.how.first_sigma);
        if (reading.marker >= 0) is_taken[reading.marker] = 1;
    }
}

}  // namespace

LabelledSet label_readings(const MeasurementSet& set) {
    LabelledSet result{set, 0, 0};
    const auto is_bare = [](const Reading& reading) { return reading.marker < 0; };
    std::optional<Markers> markers;
    for (LoadState& state : result.set.states) {
        const auto bare = static_cast<int>(std::ranges::count_if(state.readings, is_bare));
        if (bare == 0 || set.markers.empty()) continue;
        if (!markers) markers.emplace(set);
        label(*markers, state);
        const auto left = static_cast<int>(std::ranges::count_if(state.readings, is_bare));
        result.matched += bare - left;
        result.left_out += left;
    }
    return result;
}

std::vector<std::string> notes(const LabelledSet& labelled) {
    std::vector<std::string> words;
    if (labelled.matched > 0) {
        words.push_back(
            fmt::format("{} unlabelled readings were given the marker that has come there, all markers "
                        "moving as one smooth field",
                        labelled.matched));
    }
    if (labelled.left_out > 0) {
        words.push_back(
            fmt::format("{} unlabelled readings were left out: their marker is ambiguous", labelled.left_out));
    }
    return words;
}

}  // namespace palpate::identify
