// How the material of links flows, and its derivatives.

#include <cassert>

#include "skeleton/links/placed/placed_links.h"

namespace palpate::skeleton {

FibreStates PlacedLinks::flowed(const State& state, const FibreStates& before) const {
    assert(before.empty() || before.size() == fibres_per_link * links_.size());
    FibreStates now;
    if (!history_) return now;
    now.reserve(fibres_per_link * links_.size());
    for (size_t l = 0; l < links_.size(); ++l)
        for (int j = 0; j < fibres_per_link; ++j) {
            const FibreState had = before.empty() ? FibreState() : before[fibres_per_link * l + j];
            now.push_back(after_stretch(history_, had, fibre(l, j, pose(links_[l], state)).stretch()));
        }
    return now;
}

FlowDerivatives PlacedLinks::flow_derivatives(const Eigen::VectorXd& k, const State& state,
                                              const FibreStates& before) const {
    std::vector<Eigen::Triplet<double>> force_by_flow, flow_by_step, flow_by_flow;
    for (size_t l = 0; l < links_.size(); ++l) {
        const Eigen::Matrix<double, fibres_per_link, 1> strengths =
            shares_[l] * order_.link(k, static_cast<Eigen::Index>(l));
        for (int j = 0; j < fibres_per_link; ++j) {
            const int z = 3 * static_cast<int>(fibres_per_link * l + j);
            const FibreState had = before.empty() ? FibreState() : before[z / 3];
            const LinkFibre one = fibre(l, j, pose(links_[l], state));
            const HistorySlopes slopes = history_slopes(history_, had, one.stretch());
            Vec12 stretches = Vec12::Zero();
            one.add_gradient({.energy = 0, .first = 1, .second = 0}, stretches);
            const double stiffness = scales_[l] * strengths[j] * links_[l].length * links_[l].length;
            for (int c = 0; c < 3; ++c) {
                for (int r = 0; r < 3; ++r)
                    if (slopes.state(r, 1 + c) != 0) flow_by_flow.emplace_back(z + r, z + c, slopes.state(r, 1 + c));
                for (int i = 0; i < 12; ++i) {
                    const int row = i < 6 ? 6 * links_[l].a + i : 6 * links_[l].b + i - 6;
                    if (slopes.stress[c] != 0)
                        force_by_flow.emplace_back(row, z + c, -stiffness * slopes.stress[c] * stretches[i]);
                    if (slopes.state(c, 0) != 0)
                        flow_by_step.emplace_back(z + c, row, slopes.state(c, 0) * stretches[i]);
                }
            }
        }
    }
    const Eigen::Index dofs = 6 * rest_.x.rows(), flows = 3 * fibres_per_link * std::ssize(links_);
    FlowDerivatives result{Eigen::SparseMatrix<double>(dofs, flows), Eigen::SparseMatrix<double>(flows, dofs),
                           Eigen::SparseMatrix<double>(flows, flows)};
    result.force_by_flow.setFromTriplets(force_by_flow.begin(), force_by_flow.end());
    result.flow_by_step.setFromTriplets(flow_by_step.begin(), flow_by_step.end());
    result.flow_by_flow.setFromTriplets(flow_by_flow.begin(), flow_by_flow.end());
    return result;
}

}  // namespace palpate::skeleton
