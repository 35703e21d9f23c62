#include "skeleton/statics/equilibrium.h"

#include <fmt/format.h>

#include "mesh/errors.h"
#include "skeleton/links/placed/placed_links.h"
#include "skeleton/loads/dent.h"
#include "skeleton/statics/statics.h"

namespace palpate::skeleton {

void EquilibriumOptions::validate() const {
    if (!(tolerance > 0)) throw InvalidInput(fmt::format("tolerance is {}; it must be above 0", tolerance));
    if (iterations < 1) throw InvalidInput(fmt::format("iterations is {}; it must be at least 1", iterations));
}

Equilibrium equilibrium(const Model& model, const Load& load, const EquilibriumOptions& options, const State* start,
                        const FibreStates& before) {
    return StaticsSolver(model).solve(stiffness_vector(model), load, options, start, before);
}

FibreStates flowed(const Model& model, const Equilibrium& equilibrium, const fem::Effects& extra) {
    if (model.law == EquilibriumLaw::linear) return equilibrium.before;
    return PlacedLinks(model, physics_of(model.effects, extra)).flowed(equilibrium.state, equilibrium.before);
}

Points observe(const Model& model, const Equilibrium& equilibrium, const std::vector<Attachment>& points) {
    if (model.law == EquilibriumLaw::large_rotation) return observe(model, equilibrium.state, points);
    const State rest = rest_state(model);
    Points positions = observe(model, rest, points);
    const Eigen::VectorXd moved = observation_jacobian(model, rest, points) * equilibrium.step;
    positions += Eigen::Map<const Points>(moved.data(), positions.rows(), 3);
    return positions;
}

Points observed(const Model& model, const Equilibrium& equilibrium, const Load& load,
                const std::vector<Attachment>& points) {
    Points rest(std::ssize(points), 3);
    for (std::size_t i = 0; i < points.size(); ++i) rest.row(static_cast<Eigen::Index>(i)) = points[i].rest.transpose();
    return observe(model, equilibrium, points) + dents(model, load, rest);
}

Eigen::SparseMatrix<double> observation_jacobian(const Model& model, const Equilibrium& equilibrium,
                                                 const std::vector<Attachment>& points) {
    const bool linear = model.law == EquilibriumLaw::linear;
    return observation_jacobian(model, linear ? rest_state(model) : equilibrium.state, points);
}

Eigen::SparseMatrix<double> link_forces(const Model& model, const Equilibrium& equilibrium, const fem::Effects& extra) {
    const PlacedLinks links(model, physics_of(model.effects, extra));
    return model.law == EquilibriumLaw::linear ? links.linear_forces(equilibrium.step, equilibrium.before)
                                               : links.forces(equilibrium.state, equilibrium.before);
}

}  // namespace palpate::skeleton
