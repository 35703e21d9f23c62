#include "identify/inference/particles/burion2008.h"

#include <algorithm>
#include <cmath>

#include "identify/inference/particles/resampling.h"
#include "identify/numerics/random.h"

namespace palpate::identify {
namespace {

constexpr double effective_share = 0.2;         // of the particles, when the sigmas are found
constexpr double mutation_of_spread = 1.0 / 3;  // of the particles' own sd, where options.mutation is 0: a choice

/// The scale s for which exp(-e / 2 s) leaves the wanted effective sample size.
double annealed_scale(const Eigen::VectorXd& e, double wanted) {
    const double lowest = e.minCoeff();
    const auto effective = [&](double s) {
        Eigen::VectorXd log_weights = -(e.array() - lowest) / (2 * s);
        normalise(log_weights);
        return effective_samples(log_weights);
    };
    double low = 1e-30 + 1e-12 * (e.maxCoeff() - lowest), high = 1e-30 + 1e3 * (e.maxCoeff() - lowest);
    for (int i = 0; i < 100; ++i) {
        const double middle = std::sqrt(low * high);
        (effective(middle) < wanted ? low : high) = middle;
    }
    return high;
}

Eigen::VectorXd standard_deviation(const Eigen::MatrixXd& particles) {
    const Eigen::RowVectorXd mean = particles.colwise().mean();
    return ((particles.rowwise() - mean).colwise().squaredNorm() / static_cast<double>(particles.rows())).cwiseSqrt();
}

}  // namespace

BurionResult burion2008(const MeasurementModel& errors_of, int P, const BurionOptions& options,
                        const Progress& progress) {
    const int M = options.particles;
    const double side = options.search_high - options.search_low;
    BurionResult result;

    // 1-2: sample M particles uniformly in the search space V
    Eigen::MatrixXd X(M, P);
    for (int m = 0; m < M; ++m) {
        RandomStream random(options.seed, 0, m);
        for (int p = 0; p < P; ++p) X(m, p) = options.search_low + side * random.uniform();
    }

    double torque_share = 0;  // what a torque's error counts against a force's; 0: not at all
    double best_error = std::numeric_limits<double>::infinity();

    // 3: for k = 1 to K
    for (int k = 1; k <= options.iterations; ++k) {
        // 4-7: net forces and torques on every node in the measured configurations, j = 1 to J: equations (7), (8)
        const ParticleErrors e = errors_of(X);
        if (k == 1 && e.torques.size() > 0) torque_share = e.torques.mean() / e.forces.mean();
        Eigen::VectorXd both = e.forces;
        if (torque_share > 0) both += e.torques / torque_share;

        // 8: likelihood weights, equations (6) and (9); the constants of (6) fall out in line 10
        const double scale = annealed_scale(both, effective_share * M);
        const double sigma_F = options.sigma_force > 0 ? options.sigma_force : scale;
        const double sigma_T = options.sigma_torque > 0 ? options.sigma_torque : scale * torque_share;
        Eigen::VectorXd log_w = -e.forces / (2 * sigma_F);
        if (torque_share > 0) log_w -= e.torques / (2 * sigma_T);

        // 9-10: normalise weights, equation (2)
        normalise(log_w);
        result.history.push_back({static_cast<double>(k), effective_samples(log_w), X, log_w});
        Eigen::Index fittest = 0;
        log_w.maxCoeff(&fittest);
        if (both[fittest] < best_error) {
            best_error = both[fittest];
            result.best = X.row(fittest);
        }

        // 11-12: resample with the low-variance method
        const double u = RandomStream(options.seed, k, M).uniform();
        X = X(low_variance_resample(log_w, M, u), Eigen::all).eval();

        // 13-14: mutate, X = X + white noise(sigma_r); stiffness stays positive
        const Eigen::VectorXd sigma_r = options.mutation > 0
                                            ? Eigen::VectorXd::Constant(P, options.mutation * side).eval()
                                            : (mutation_of_spread * standard_deviation(X)).eval();
        for (int m = 0; m < M; ++m) {
            const Eigen::VectorXd noise = RandomStream(options.seed, k, m).normals(P);
            X.row(m) = (X.row(m).transpose() + sigma_r.cwiseProduct(noise)).cwiseAbs();
        }
        report(progress, "particles", static_cast<double>(k) / options.iterations);
    }  // 16: end for

    // "either the particle with the highest weight, or the mean values for each dimension" (section III)
    result.particles = X;
    result.log_weights = Eigen::VectorXd::Constant(M, -std::log(M));
    result.mean = X.colwise().mean();
    result.sd = standard_deviation(X);
    return result;
}

}  // namespace palpate::identify
