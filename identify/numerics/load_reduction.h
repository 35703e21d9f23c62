#pragma once

namespace palpate::identify {

/// A load without equilibrium is lowered to this share of itself, again and again, until it has one.
///
/// Design choice: each attempt costs a solve that may fail slowly; what the body bears is found to a fifth. The last
/// attempt is at a tenth of the load, 0.8^10 = 0.107: a model that does not bear that is not merely too soft.
inline constexpr double load_reduction = 0.8;
inline constexpr int most_load_reductions = 10;

}  // namespace palpate::identify
