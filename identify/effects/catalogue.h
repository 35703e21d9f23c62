#pragma once

#include <memory>
#include <string>
#include <vector>

#include "identify/effects/effect.h"

namespace palpate::identify {

/// Every effect that is known, in the order in which they are told.
const std::vector<std::shared_ptr<const Effect>>& catalogue();

/// @throws InvalidInput naming the effects that there are, and the one that is spelled most alike.
std::shared_ptr<const Effect> find_effect(const std::string& name);

// Each effect, from its own file.
std::shared_ptr<const Effect> gravity_effect();
std::shared_ptr<const Effect> compliant_support_effect();
std::shared_ptr<const Effect> misalignment_effect();
std::shared_ptr<const Effect> force_gain_effect();
std::shared_ptr<const Effect> outliers_effect();

}  // namespace palpate::identify
