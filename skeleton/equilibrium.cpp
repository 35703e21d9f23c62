#include "skeleton/equilibrium.h"

#include <fmt/format.h>

#include "mesh/errors.h"
#include "skeleton/link_energy.h"
#include "skeleton/statics.h"

namespace palpate::skeleton {

void EquilibriumOptions::validate() const {
    if (!(tolerance > 0)) throw InvalidInput(fmt::format("tolerance is {}; it must be above 0", tolerance));
    if (iterations < 1) throw InvalidInput(fmt::format("iterations is {}; it must be at least 1", iterations));
}

Equilibrium equilibrium(const Model& model, const Load& load, const EquilibriumOptions& options, const State* start) {
    return StaticsSolver(model).solve(stiffness_vector(model), load, options, start);
}

Points observe(const Model& model, const Equilibrium& equilibrium, const std::vector<Attachment>& points) {
    if (model.law == Law::large_rotation) return observe(model, equilibrium.state, points);
    const State rest = rest_state(model);
    Points positions = observe(model, rest, points);
    const Eigen::VectorXd moved = observation_jacobian(model, rest, points) * equilibrium.step;
    positions += Eigen::Map<const Points>(moved.data(), positions.rows(), 3);
    return positions;
}

Eigen::SparseMatrix<double> observation_jacobian(const Model& model, const Equilibrium& equilibrium,
                                                 const std::vector<Attachment>& points) {
    const bool linear = model.law == Law::linear;
    return observation_jacobian(model, linear ? rest_state(model) : equilibrium.state, points);
}

Eigen::SparseMatrix<double> link_forces(const Model& model, const Equilibrium& equilibrium) {
    if (model.law == Law::large_rotation) return link_forces(model, equilibrium.state);

    // Linearised at rest: the force of link l at unit stiffness s is -(gradient + Hessian * step).
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(36 * model.links.size());
    for (size_t l = 0; l < model.links.size(); ++l) {
        const Link& link = model.links[l];
        const LinkTerms terms = link_terms(link.length, rest_direction(model, link), model.spheres[link.a].center,
                                           Mat3::Identity(), model.spheres[link.b].center, Mat3::Identity(), true);
        Vec12 step;
        step << equilibrium.step.segment<6>(Eigen::Index{6} * link.a),
            equilibrium.step.segment<6>(Eigen::Index{6} * link.b);
        for (int s = 0; s < 3; ++s) {
            const Vec12 force = -terms.gradient.col(s) - terms.hessian[s] * step;
            for (int i = 0; i < 12; ++i)
                entries.emplace_back(i < 6 ? 6 * link.a + i : 6 * link.b + i - 6, 3 * static_cast<int>(l) + s,
                                     force[i]);
        }
    }
    Eigen::SparseMatrix<double> G(model.dofs(), 3 * static_cast<Eigen::Index>(model.links.size()));
    G.setFromTriplets(entries.begin(), entries.end());
    return G;
}

}  // namespace palpate::skeleton
