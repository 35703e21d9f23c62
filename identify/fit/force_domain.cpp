#include "identify/fit/force_domain.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace palpate::identify {
namespace {

ForceStatistics zero_statistics(int P) { return {Eigen::MatrixXd::Zero(P, P), Eigen::VectorXd::Zero(P), 0}; }

void accumulate(ForceStatistics& statistics, const Eigen::MatrixXd& A, const Eigen::VectorXd& f) {
    statistics.H.noalias() += A.transpose() * A;
    statistics.g.noalias() += A.transpose() * f;
    statistics.c += f.squaredNorm();
}

double mean_link_length(const skeleton::Model& model) {
    double sum = 0;
    for (const skeleton::Link& link : model.links) sum += link.length;
    return sum / static_cast<double>(model.links.size());
}

/// Rows of the free spheres, their forces or their torques over `length`.
Eigen::VectorXi free_rows(const skeleton::Model& model, bool torques) {
    std::vector<int> rows;
    for (int i = 0; i < static_cast<int>(model.spheres.size()); ++i) {
        if (model.spheres[i].held) continue;
        for (int c = 0; c < 3; ++c) rows.push_back(6 * i + (torques ? 3 : 0) + c);
    }
    return Eigen::Map<Eigen::VectorXi>(rows.data(), static_cast<Eigen::Index>(rows.size()));
}

}  // namespace

ForceStatistics operator+(const ForceStatistics& a, const ForceStatistics& b) {
    return {a.H + b.H, a.g + b.g, a.c + b.c};
}

ForceDomain force_domain(const skeleton::Model& model, const Parameters& parameters,
                         const std::vector<MeasuredConfiguration>& measured) {
    const int P = parameters.size();
    ForceDomain result{zero_statistics(P), zero_statistics(P)};
    const Eigen::VectorXi force_rows = free_rows(model, false), torque_rows = free_rows(model, true);
    const double length = mean_link_length(model);

    for (const MeasuredConfiguration& configuration : measured) {
        // r = G k + f_ext = A m + f: A gathers the columns that share a multiplier, f keeps what stays as it is
        const Eigen::SparseMatrix<double> G = skeleton::link_forces(model, configuration.state);
        Eigen::MatrixXd A = Eigen::MatrixXd::Zero(G.rows(), P);
        Eigen::VectorXd f = skeleton::external_force(model, configuration.state, configuration.load) +
                            skeleton::effect_force(model, configuration.state);
        for (int e = 0; e < parameters.k0.size(); ++e) {
            const int p = parameters.parameter_of[e];
            if (p >= 0)
                A.col(p) += parameters.k0[e] * G.col(e);
            else
                f += parameters.k0[e] * G.col(e);
        }
        accumulate(result.forces, A(force_rows, Eigen::all), f(force_rows));
        accumulate(result.torques, A(torque_rows, Eigen::all) / length, f(torque_rows) / length);
    }
    return result;
}

Eigen::VectorXd solve_force_domain(const ForceStatistics& statistics, double prior_share) {
    // prior: weight (m - 1)^2 added to the quadratic
    const int P = static_cast<int>(statistics.g.size());
    const double weight = prior_share * statistics.H.diagonal().mean();
    const Eigen::MatrixXd H = statistics.H + weight * Eigen::MatrixXd::Identity(P, P);
    const Eigen::VectorXd g = statistics.g.array() - weight;

    // active set: parameters become free one by one, where the quadratic falls most
    Eigen::VectorXd m = Eigen::VectorXd::Zero(P);
    std::vector<int> free;
    const double rounding = 1e-15 * (1 + P) * g.cwiseAbs().maxCoeff();
    for (int round = 0; round < 3 * P; ++round) {
        const Eigen::VectorXd descent = -(H * m + g);
        int next = -1;
        for (int p = 0; p < P; ++p) {
            const bool at_bound = m[p] <= 0;
            if (at_bound && descent[p] > rounding && (next < 0 || descent[p] > descent[next])) next = p;
        }
        if (next < 0) break;
        free.push_back(next);

        while (!free.empty()) {
            const Eigen::VectorXd trial = H(free, free).ldlt().solve(-g(free));
            if (trial.minCoeff() > 0) {
                m(free) = trial;
                break;
            }
            // as far as the bound of the first parameter that would turn negative; that one is held again
            double t = 1;
            int blocking = -1;
            for (int i = 0; i < static_cast<int>(free.size()); ++i) {
                const double now = m[free[i]];
                if (trial[i] <= 0 && (blocking < 0 || now / (now - trial[i]) < t)) {
                    t = now / (now - trial[i]);
                    blocking = i;
                }
            }
            const Eigen::VectorXd now = m(free);
            m(free) = now + t * (trial - now);
            m[free[blocking]] = 0;
            free.erase(free.begin() + blocking);
        }
    }
    return m;
}

}  // namespace palpate::identify
