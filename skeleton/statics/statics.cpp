#include "skeleton/statics/statics.h"

#include <cassert>

#include "skeleton/effects/placed_effects.h"
#include "skeleton/links/placed/placed_links.h"

namespace palpate::skeleton {

namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;

PlacedEffects effects_of(const Model& model, const fem::Effects& extra) {
    return {model, physics_of(model.effects, extra)};
}
PlacedLinks links_of(const Model& model, const fem::Effects& extra) {
    return {model, physics_of(model.effects, extra)};
}

// Row of entry i of a link's twelve.
int row_of(const Link& link, int i) { return i < 6 ? 6 * link.a + i : 6 * link.b + i - 6; }

}  // namespace

Eigen::SparseMatrix<double> link_forces(const Model& model, const State& state, const fem::Effects& extra) {
    return links_of(model, extra).forces(state);
}

Eigen::VectorXd stiffness_vector(const Model& model) {
    const StiffnessOrder order(model);
    Eigen::VectorXd k(order.size());
    for (Eigen::Index l = 0; l < std::ssize(model.links); ++l) {
        for (int s = 0; s < order.per_link(); ++s) k[order.of_link(l, s)] = model.links[l].stiffness[s];
    }
    if (!order.full()) return k;
    for (Eigen::Index i = 0; i < std::ssize(model.spheres); ++i) k[order.of_sphere(i)] = model.spheres[i].volume;
    return k;
}

void set_stiffness(Model& model, const Eigen::VectorXd& k) {
    const StiffnessOrder order(model);
    assert(k.size() == order.size());
    for (Eigen::Index l = 0; l < std::ssize(model.links); ++l) {
        model.links[l].gyration = radius_of_gyration(model.links[l]);
        model.links[l].stiffness = order.link(k, l);
    }
    if (!order.full()) return;
    for (Eigen::Index i = 0; i < std::ssize(model.spheres); ++i) model.spheres[i].volume = k[order.of_sphere(i)];
}

Eigen::VectorXd effect_force(const Model& model, const State& state, const fem::Effects& extra) {
    return effects_of(model, extra).force(state);
}

double potential(const Model& model, const State& state, const Load& load, const fem::Effects& extra) {
    double energy = effects_of(model, extra).energy(state).sum - external_work(model, state, load);
    const PlacedLinks links = links_of(model, extra);
    for (size_t l = 0; l < model.links.size(); ++l)
        energy += model.links[l].stiffness.dot(links.terms(l, state, false).energy);
    return energy + links.volumes().energy(stiffness_vector(model), state);
}

Eigen::VectorXd residual(const Model& model, const State& state, const Load& load, const fem::Effects& extra) {
    Eigen::VectorXd r = external_force(model, state, load) + effect_force(model, state, extra);
    const PlacedLinks links = links_of(model, extra);
    for (size_t l = 0; l < model.links.size(); ++l) {
        const Link& link = model.links[l];
        const Vec12 g = links.terms(l, state, false).gradient * link.stiffness;
        r.segment<6>(Eigen::Index{6} * link.a) -= g.head<6>();
        r.segment<6>(Eigen::Index{6} * link.b) -= g.tail<6>();
    }
    return r + links.volumes().force(stiffness_vector(model), state);
}

Eigen::SparseMatrix<double> tangent(const Model& model, const State& state, const Load& load, const fem::Effects& extra,
                                    const FibreStates& before) {
    Triplets entries;
    entries.reserve(144 * model.links.size() + 9 * model.spheres.size());
    const PlacedLinks links = links_of(model, extra);
    for (size_t l = 0; l < model.links.size(); ++l) {
        const Link& link = model.links[l];
        const Mat12 H = links.hessian(l, link.stiffness, pose(link, state), before);
        for (int j = 0; j < 12; ++j)
            for (int i = 0; i < 12; ++i) entries.emplace_back(row_of(link, i), row_of(link, j), H(i, j));
    }
    const auto add = [&](int a, int b, const PlacedEffects::Block& block) {
        for (int j = 0; j < 6; ++j)
            for (int i = 0; i < 6; ++i) {
                entries.emplace_back(6 * a + i, 6 * b + j, block(i, j));
                if (a != b) entries.emplace_back(6 * b + j, 6 * a + i, block(i, j));
            }
    };
    const auto add_pairs = [&](const auto& pairs, const auto& blocks) {
        for (size_t p = 0; p < blocks.size(); ++p) add(pairs[p][0], pairs[p][1], blocks[p]);
    };
    for (const auto& [a, b, block] : external_curvature(model, state, load)) add(a, b, -block);
    const PlacedEffects effects = effects_of(model, extra);
    add_pairs(effects.pairs(), effects.curvature(state));
    add_pairs(links.volumes().pairs(), links.volumes().curvature(stiffness_vector(model), state));
    Eigen::SparseMatrix<double> J(model.dofs(), model.dofs());
    J.setFromTriplets(entries.begin(), entries.end());
    return J;
}

}  // namespace palpate::skeleton
