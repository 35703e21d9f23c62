#include "identify/inference/priors/informative_prior.h"

#include <algorithm>

namespace palpate::identify {

const InformativePrior* prior_of(const std::string& parameter, double sd,
                                 const std::vector<InformativePrior>& from_specimens) {
    const auto found = std::ranges::find(from_specimens, parameter, &InformativePrior::parameter);
    return found == from_specimens.end() || found->sd > sd ? nullptr : &*found;
}

}  // namespace palpate::identify
