#pragma once

#include "identify/diagnosis/fit/refit.h"

namespace palpate::identify {

/// A fit of the same body to other states of its set.
struct NeighbouringFit {
    const Problem* problem;
    const Refit* fit;
    bool knows_mesh_error = true;  // is the error of the mesh that came off that problem's readings that of the fit?
};

/// The fit as an initial guess for another problem: its configurations, without its data-dependent parts; none if
/// actions of that problem were not part of the fit.
std::optional<Refit> start_at(const NeighbouringFit& near, const Problem& problem);

}  // namespace palpate::identify
