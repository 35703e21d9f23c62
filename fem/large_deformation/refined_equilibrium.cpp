#include "fem/large_deformation/refined_equilibrium.h"

#include "fem/large_deformation/solve/two_grid.h"
#include "mesh/errors.h"

namespace palpate::fem {
namespace {

constexpr double left = 0.05;         // of the difference between the meshes, at the end
constexpr double forcing = 0.02;      // of a step's error, below what Newton's linearisation leaves [Dembo et al. 1982]
constexpr int most_steps = 3;         // of Newton's method; one or two suffice
constexpr double shortest = 1.0 / 8;  // step

void clear_held(const std::vector<char>& held, Eigen::VectorXd& x) {
    for (std::size_t n = 0; n < held.size(); ++n)
        if (held[n]) x.segment<3>(3 * static_cast<Eigen::Index>(n)).setZero();
}

/// The net force on what is free; nothing where an element is inside out.
std::optional<Eigen::VectorXd> net_force(const HyperelasticBody& body, const Eigen::VectorXd& u,
                                         const BodySetting& setting, const Eigen::VectorXd& f) {
    try {
        Eigen::VectorXd r = body.residual(u, setting, f);
        clear_held(body.held(), r);
        return r;
    } catch (const SolverFailure&) {
        return std::nullopt;
    }
}

}  // namespace

std::optional<Eigen::VectorXd> refined_equilibrium(const RefinedBody& refined, const Eigen::VectorXd& coarse,
                                                   const BodyTangent& J, const BodySetting& setting,
                                                   const Eigen::VectorXd& f) {
    if (release_supports(setting.effects)) return std::nullopt;
    const HyperelasticBody& body = refined.body;
    const Points interpolated = refined.interpolation * Eigen::Map<const Points>(coarse.data(), coarse.size() / 3, 3);
    Eigen::VectorXd u = Eigen::Map<const Eigen::VectorXd>(interpolated.data(), interpolated.size());
    clear_held(body.held(), u);
    std::optional<Eigen::VectorXd> r = net_force(body, u, setting, f);
    if (!r) return std::nullopt;
    const Eigen::VectorXd start = u;
    for (int step = 0; step < most_steps; ++step) {
        std::optional<TwoGrid> tangent;
        try {
            tangent.emplace(body.tangent(u, setting), body.held(), refined.interpolation, J);
        } catch (const SolverFailure&) {  // its diagonal is not positive definite
            return std::nullopt;
        }
        const double energy = r->dot(tangent->estimate(*r));
        const Eigen::VectorXd move = tangent->solve(*r, forcing);
        bool falls = false;
        Eigen::VectorXd next;  // what the net force there calls for
        for (double share = 1; share >= shortest && !falls; share /= 2) {
            const Eigen::VectorXd trial = u + share * move;
            const std::optional<Eigen::VectorXd> force = net_force(body, trial, setting, f);
            if (!force) continue;
            next = tangent->estimate(*force);
            falls = force->dot(next) < energy;
            if (!falls) continue;
            u = trial;
            r = force;
        }
        if (!falls) return std::nullopt;
        if (next.norm() <= left * (u - start).norm()) return u;
    }
    return std::nullopt;
}

}  // namespace palpate::fem
