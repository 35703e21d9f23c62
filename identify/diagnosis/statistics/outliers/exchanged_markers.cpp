#include "identify/diagnosis/statistics/outliers/exchanged_markers.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <utility>

#include "mesh/numbers/median.h"

namespace palpate::identify {
namespace {

using Vec6 = Eigen::Vector<double, 6>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

/// A reading of three coordinates.
struct WholeReading {
    int marker = 0, reading = 0;
    Eigen::Index row = 0;  // of its first coordinate
    Vec3 at, sigma;        // [mm]
    double residual = 0;   // length, in sigmas
};

/// Readings of three coordinates, by state. `residual` (N): in sigmas.
std::map<int, std::vector<WholeReading>> whole_readings(const Problem& problem, const Eigen::VectorXd& residual) {
    std::map<int, std::vector<WholeReading>> states;
    for (Eigen::Index n = 0; n + 2 < problem.rows(); ++n) {
        if (problem.reading[n] != problem.reading[n + 2] || !problem.is_position(n)) continue;
        states[problem.state[n]].push_back({problem.channel(n), problem.reading[n], n, problem.measured.segment<3>(n),
                                            problem.sigma.segment<3>(n), residual.segment<3>(n).norm()});
    }
    return states;
}

/// What an exchange of labels adds to the errors of a pair [sigmas].
Vec6 exchanged(const WholeReading& one, const WholeReading& other) {
    Vec6 change;
    change << (other.at - one.at).cwiseQuotient(one.sigma), (one.at - other.at).cwiseQuotient(other.sigma);
    return change;
}

/// What the other readings tell of pairs.
class PairPredictions {
public:
    PairPredictions(const Whitening& V, const Eigen::VectorXd& d)
        : y_(V.apply(d)), absorbed_(V.absorbed()), weights_(V.weights()) {}

    /// [V^-1 d] of a pair.
    Vec6 pull(const WholeReading& one, const WholeReading& other) const {
        Vec6 y;
        y << y_.segment<3>(one.row), y_.segment<3>(other.row);
        return y;
    }
    /// [V^-1] of a pair: precision of its errors as predicted from all other readings.
    Mat6 precision(const WholeReading& one, const WholeReading& other) const {
        Eigen::Matrix<double, Eigen::Dynamic, 6> G(absorbed_.rows(), 6);
        G << absorbed_.middleCols<3>(one.row), absorbed_.middleCols<3>(other.row);
        Vec6 w;
        w << weights_.segment<3>(one.row), weights_.segment<3>(other.row);
        return Mat6(w.cwiseAbs2().asDiagonal()) - G.transpose() * G;
    }

private:
    Eigen::VectorXd y_;         // V^-1 d
    Eigen::MatrixXd absorbed_;  // G of V^-1 = W^2 - G^T G
    Eigen::VectorXd weights_;
};

/// Length of an error that is no more than the other readings of a state have, those of a pair apart [sigmas].
double ordinary_error(const std::vector<WholeReading>& state, std::size_t one, std::size_t other) {
    std::vector<double> lengths;
    lengths.reserve(state.size());
    for (std::size_t i = 0; i < state.size(); ++i) {
        if (i != one && i != other) lengths.push_back(state[i].residual);
    }
    const double least = chi_median[3];
    return rough_reading * (lengths.empty() ? least : std::max(mesh::upper_median(std::move(lengths)), least));
}

}  // namespace

std::vector<ExchangedMarkers> find_exchanged_markers(const Problem& problem, const Whitening& V,
                                                     const Eigen::VectorXd& d) {
    const auto states = whole_readings(problem, V.residual(d));
    const PairPredictions predictions(V, d);
    double pairs = 1;
    for (const auto& [number, state] : states) pairs += 0.5 * static_cast<double>(state.size() * (state.size() - 1));
    constexpr double false_alarms = 1e-6;  // expected in a set: design choice, as labels are exchanged rarely
    const double least = std::log(pairs / false_alarms);
    std::vector<ExchangedMarkers> likely;
    for (const auto& [number, state] : states) {
        for (std::size_t i = 0; i < state.size(); ++i) {
            for (std::size_t j = i + 1; j < state.size(); ++j) {
                // chi^2 falls by y^T P^-1 y - (y + P change)^T P^-1 (y + P change)
                const Vec6 change = exchanged(state[i], state[j]), y = predictions.pull(state[i], state[j]);
                if (change.dot(y) >= 0) continue;
                const Mat6 P = predictions.precision(state[i], state[j]);
                const double ratio = -change.dot(y) - 0.5 * change.dot(P * change);
                if (ratio < least) continue;
                const Vec6 left = y + P * change;
                const double most = ordinary_error(state, i, j);
                if (left.dot(P.ldlt().solve(left)) > 2 * most * most) continue;  // of two readings
                likely.push_back(
                    {number, {state[i].marker, state[j].marker}, {state[i].reading, state[j].reading}, ratio});
            }
        }
    }
    std::ranges::stable_sort(likely, std::greater{}, &ExchangedMarkers::log_likelihood_ratio);
    std::vector<ExchangedMarkers> result;
    std::set<int> taken;
    for (const ExchangedMarkers& one : likely) {
        if (taken.contains(one.readings.first) || taken.contains(one.readings.second)) continue;
        taken.insert({one.readings.first, one.readings.second});
        result.push_back(one);
    }
    return result;
}

}  // namespace palpate::identify
