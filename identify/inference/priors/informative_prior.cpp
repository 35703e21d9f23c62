#include "identify/inference/priors/informative_prior.h"

#include <algorithm>
#include <cmath>

#include "identify/inference/priors/log_normal_prior.h"
#include "identify/inference/problem/parameters.h"

namespace palpate::identify {

const InformativePrior* prior_of(const std::string& parameter, double sd,
                                 const std::vector<InformativePrior>& from_specimens) {
    const auto found = std::ranges::find(from_specimens, parameter, &InformativePrior::parameter);
    return found == from_specimens.end() || found->sd > sd ? nullptr : &*found;
}

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
