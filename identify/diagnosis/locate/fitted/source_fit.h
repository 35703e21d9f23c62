#pragma once

#include <optional>

#include "identify/diagnosis/diagnose_options.h"
#include "identify/diagnosis/locate/missing_source.h"

namespace palpate::identify {

/// The fit that sources are located beside. A constant one bends a fit until the stiffness does what the source does;
/// so where most of what a fit leaves is alike in all states, it is fitted anew to how the states differ. Its `error`
/// is that of the problem itself.
Refit beside_constant_sources(const BodyModel& model, const Problem& problem, const Refit& fit,
                              const RefitOptions& options);

/// A source that was located beside a fit, fitted to the readings: place, size and strength at the equilibria that they
/// come to, where first order tells of a strong one in kind alone, and not always of that. Every source that models
/// show is tried, and the likeliest from several places and under every law. It stays as it is where one that models do
/// not show is likelier than all fits, and where no fit is likelier than the one `without` a source. The fit; absent:
/// it stays.
std::optional<Refit> fit_source(const BodyModel& model, const Problem& problem, const Refit& beside,
                                const Refit& without, const DiagnoseOptions& options, MissingSource& source);

}  // namespace palpate::identify
