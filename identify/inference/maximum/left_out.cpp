#include "identify/inference/maximum/left_out.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>

#include "identify/numerics/parallel.h"

namespace palpate::identify {
namespace {

constexpr std::size_t least_probes = 3;  // of fewer, none can be forecast from the others

/// What the measured coordinates of a probe say of its errors e [mm] under a step s along the directions,
/// e + sigma J s: |e|^2, and what goes with s and with its square.
struct Probe {
    Eigen::MatrixXd curvature;         // J^T J (r x r)
    Eigen::VectorXd slope;             // J^T e / sigma (r)
    double noise = 0, scale = 0;       // squares, over the coordinates [mm^2]
    double errors = 0;                 // |e|^2 [mm^2]
    Eigen::VectorXd errors_slope;      // J^T sigma e [mm^2] (r)
    Eigen::MatrixXd errors_curvature;  // J^T sigma^2 J [mm^2] (r x r)

    explicit Probe(Eigen::Index r)
        : curvature(Eigen::MatrixXd::Zero(r, r)),
          slope(Eigen::VectorXd::Zero(r)),
          errors_slope(slope),
          errors_curvature(curvature) {}

    /// A state of the probe: how its markers move along the directions (3m x r) [mm].
    void add(const Eigen::MatrixXd& moved, const Eigen::VectorXd& weights, const Eigen::VectorXd& e) {
        const Eigen::VectorXd is_measured = (weights.array() > 0).cast<double>();
        const Eigen::MatrixXd measured = is_measured.asDiagonal() * moved;  // sigma J = -measured
        const Eigen::MatrixXd weighted = weights.asDiagonal() * moved;
        curvature += moved.transpose() * weighted;
        slope -= weighted.transpose() * e;
        errors += is_measured.dot(e.cwiseAbs2());
        errors_slope -= measured.transpose() * e;
        errors_curvature += moved.transpose() * measured;
    }

    /// |e|^2 under a fit to all other probes. Of all probes and the prior by the directions: the curvature of half of
    /// their square, and how far its fall has settled.
    double unseen(const Eigen::MatrixXd& all, const Eigen::VectorXd& left) const {
        const Eigen::VectorXd step = (all - curvature).ldlt().solve(slope - left);
        return errors + step.dot(2 * errors_slope + errors_curvature * step);
    }
};

}  // namespace

ForecastError leave_one_out_error(const PositionDomain& domain, const LogNormalPrior& prior, const FitResult& fit,
                                  const std::vector<int>& probes, int threads) {
    std::map<int, std::vector<int>> by_probe;
    for (int s = 0; s < static_cast<int>(probes.size()); ++s) by_probe[probes[s]].push_back(s);
    if (by_probe.size() < least_probes) return {};
    std::vector<std::vector<int>> groups;
    groups.reserve(by_probe.size());
    for (const auto& [probe, states] : by_probe) groups.push_back(states);

    const ErrorJacobian jacobian = domain.jacobian(fit.theta, fit.prediction);
    const Eigen::MatrixXd directions = prior.coloured(fit.spectrum.vectors);
    std::vector<Probe> probes_left_out(groups.size(), Probe(directions.cols()));
    for_each_in_parallel(static_cast<int>(groups.size()), threads, [&](int g) {
        Probe& probe = probes_left_out[g];
        for (const int s : groups[g]) {
            probe.add(jacobian.moved_markers(s, directions), jacobian.weights(s), jacobian.errors(s));
            probe.noise += domain.states()[s].coordinates * domain.squared_noise(s);
            probe.scale += domain.states()[s].coordinates * domain.squared_scale(s);
        }
    });
    Eigen::MatrixXd all = Eigen::MatrixXd::Identity(directions.cols(), directions.cols());
    Eigen::VectorXd left = fit.spectrum.vectors.transpose() * prior.whitened(fit.theta);
    for (const Probe& probe : probes_left_out) {
        all += probe.curvature;
        left += probe.slope;
    }
    Eigen::VectorXd relative(std::ssize(groups));  // squared
    for_each_in_parallel(static_cast<int>(groups.size()), threads, [&](int g) {
        const Probe& probe = probes_left_out[g];
        relative[g] = std::max(0.0, probe.unseen(all, left) - probe.noise) / probe.scale;
    });
    return {std::sqrt(relative.mean()), domain.least_displacement(), static_cast<int>(groups.size())};
}

}  // namespace palpate::identify
