#pragma once

#include <optional>

#include "identify/diagnosis/diagnose_options.h"
#include "identify/diagnosis/diagnosis.h"

namespace palpate::identify {

/// What an explanation, or the baseline where there is none, leaves of the readings, as an effect that models show:
/// where a fit may begin with it.
struct Residual {
    skeleton::EffectRecord effect;
    double log_bayes_factor = 0;    // of all such sources, against nothing
    std::optional<Refit> fit = {};  // of it, where it was fitted
};

/// Absent: nothing is left that a source explains which acts alike in all states, or holds the body by springs. Those
/// that go with a load or with the time have no cause that a model knows of; faults of the readings are none of a body.
std::optional<Residual> find_residual(const BodyModel& model, const Diagnosis& diagnosis,
                                      const DiagnoseOptions& options);

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
