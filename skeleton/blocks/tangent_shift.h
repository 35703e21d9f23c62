#pragma once

#include <algorithm>

// Shifts that make the tangent of a Newton step positive definite, by powers of ten, as each trial costs a factor.

namespace palpate::skeleton {

/// The next to try. The first, 1e-4 of the stiffest entry, is a choice: a smaller one is often not enough, a larger one
/// holds back steps that need little.
inline double larger_shift(double shift, double stiffest) { return std::max(10 * shift, 1e-4 * stiffest); }

/// Beside more than this the tangent is below rounding: no shift will do, as where an entry is not a number.
inline bool can_shift(double shift, double stiffest) { return shift < 1e8 * stiffest; }

/// After a step that went well; 0 where less than the first would be left.
inline double smaller_shift(double shift, double stiffest) { return shift > 1e-3 * stiffest ? shift / 10 : 0; }

}  // namespace palpate::skeleton
