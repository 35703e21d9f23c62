#pragma once

#include "fem/effects/effects.h"
#include "skeleton/links/placed/placed_links.h"
#include "skeleton/runtime/kernels/tables.h"

namespace palpate::runtime {

using PaperTable = std::vector<PaperLinks, Aligned<PaperLinks>>;
using FullTable = std::vector<FullLinks, Aligned<FullLinks>>;
using CouplingTable = std::vector<SectionCouplings, Aligned<SectionCouplings>>;
using MassTable = std::vector<Masses, Aligned<Masses>>;

/// Rows of a model's spheres, filled up to whole batches, and the two that lanes without a link take.
inline int batches_of(std::size_t n) { return static_cast<int>((n + 3) / 4); }
inline int first_idle_row(const skeleton::Model& model) { return 4 * batches_of(model.spheres.size()); }
inline int row_count(const skeleton::Model& model) { return first_idle_row(model) + 2; }

/// A model's links with the stiffnesses in force (k of each), four by four; those of the kind that they are not are
/// empty. `kept`: spheres whose volume is kept.
PaperTable paper_table(const skeleton::Model& model, const std::vector<skeleton::Stiffnesses>& k);
FullTable full_table(const skeleton::Model& model, const std::vector<skeleton::Stiffnesses>& k,
                     const std::vector<char>& kept);

/// How their strains depend on one another, four by four; empty where no link has a law.
CouplingTable coupling_table(const std::vector<skeleton::SectionLaw>& laws);

/// Masses and inertias; of held spheres, and where `moves` is not set, none.
MassTable mass_table(const skeleton::Model& model, const std::vector<char>& moves);

/// Poses at rest.
SphereRows rest_rows(const skeleton::Model& model);

}  // namespace palpate::runtime
