#include "identify/inference/problem/inform.h"

#include <cmath>

namespace palpate::identify {

std::vector<std::string> inform(LogNormalPrior& prior, const Parameters& parameters,
                                const std::vector<InformativePrior>& from_specimens) {
    std::vector<std::string> informed;
    for (Eigen::Index p = 0; p < parameters.size(); ++p) {
        const Parameter& parameter = parameters.list[static_cast<std::size_t>(p)];
        const InformativePrior* own = prior_of(parameter.name, prior.sd[p], from_specimens);
        if (!own) continue;
        prior.mean[p] = own->mean - std::log(parameter.stiffness);
        prior.sd[p] = own->sd;
        informed.push_back(parameter.name);
    }
    return informed;
}

}  // namespace palpate::identify
