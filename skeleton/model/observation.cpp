#include "skeleton/model/observation.h"

#include "skeleton/model/attachment/carried_point.h"
#include "skeleton/model/growth.h"

namespace palpate::skeleton {

Points observe(const Model& model, const State& state, const std::vector<Attachment>& points) {
    const State rest = rest_state(model);
    const fem::Growth growth = physics_of(model.effects).growth;
    Points positions(static_cast<Eigen::Index>(points.size()), 3);
    for (size_t i = 0; i < points.size(); ++i)
        positions.row(static_cast<Eigen::Index>(i)) =
            carried_place(grown(points[i], rest, growth), rest, state).transpose();
    return positions;
}

Eigen::SparseMatrix<double> observation_jacobian(const Model& model, const State& state,
                                                 const std::vector<Attachment>& points) {
    const State rest = rest_state(model);
    const fem::Growth growth = physics_of(model.effects).growth;
    std::vector<Eigen::Triplet<double>> entries;
    for (size_t i = 0; i < points.size(); ++i) {
        const CarriedPoint point(grown(points[i], rest, growth), rest, state);
        for (int share = 0; share < point.shares(); ++share)
            for (int c = 0; c < 3; ++c)
                for (int d = 0; d < 6; ++d)
                    entries.emplace_back(3 * static_cast<int>(i) + c, 6 * point.sphere(share) + d,
                                         point.jacobian(share)(c, d));
    }
    Eigen::SparseMatrix<double> P(3 * static_cast<Eigen::Index>(points.size()), model.dofs());
    P.setFromTriplets(entries.begin(), entries.end());
    return P;
}

}  // namespace palpate::skeleton
