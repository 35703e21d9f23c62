#pragma once

#include <Eigen/Geometry>

#include "skeleton/runtime/forces/link_tables.h"
#include "skeleton/runtime/kernels/tables.h"
#include "skeleton/runtime/walk_order.h"
#include "tests/skeleton/test_models.h"

namespace palpate::runtime {

/// A state as the runtime's rows.
inline SphereRows rows_of(const ReorderedModel& reordered, const skeleton::State& state) {
    SphereRows rows = rest_rows(reordered.model);
    for (std::size_t i = 0; i < reordered.place.size(); ++i) {
        double* row = rows.data() + row_length * reordered.place[i];
        const Vec3 x = state.x.row(static_cast<Eigen::Index>(i));
        std::copy_n(x.data(), 3, row);
        std::copy_n(Eigen::Quaterniond(state.R[i]).coeffs().data(), 4, row + 4);
    }
    return rows;
}

/// Rows of forces as a generalized force (6N) of the model in its own order.
inline Eigen::VectorXd vector_of(const ReorderedModel& reordered, const SphereRows& rows) {
    Eigen::VectorXd v(6 * std::ssize(reordered.place));
    for (std::size_t i = 0; i < reordered.place.size(); ++i) {
        const double* row = rows.data() + row_length * reordered.place[i];
        for (int c = 0; c < 6; ++c) v[static_cast<Eigen::Index>(6 * i) + c] = row[c + c / 3];
    }
    return v;
}

/// A box of skin round a block of spheres, and a support at its low end in x; each vertex follows up to six spheres,
/// with parts of their relative motion, as placed skins do.
void give_skin(skeleton::Model& model);
/// A closed cavity in the middle of it.
void add_cavity(skeleton::Model& model);

/// Effects whose second derivative is that of the model, but for the turning of points' arms.
std::vector<skeleton::EffectRecord> playable_effects();

}  // namespace palpate::runtime
