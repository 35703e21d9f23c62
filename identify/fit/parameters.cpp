#include "identify/fit/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "mesh/errors.h"
#include "skeleton/statics.h"

namespace palpate::identify {
namespace {

/// Links of a scope that share a multiplier: 0 for all, the zone, or the link itself.
int group_of(const skeleton::Model& model, Scope scope, int link) {
    if (scope == Scope::uniform) return 0;
    return scope == Scope::zones ? model.links[link].zone : link;
}

std::string name_of(Scope scope, int kind, int group) {
    const char* stiffness = skeleton::stiffness_names[kind];
    if (scope == Scope::uniform) return stiffness;
    return fmt::format("{}:{}{}", stiffness, scope == Scope::zones ? "zone" : "link", group);
}

}  // namespace

Eigen::VectorXd Parameters::stiffness(const Eigen::VectorXd& theta) const {
    Eigen::VectorXd k = k0;
    for (int e = 0; e < k.size(); ++e) {
        if (parameter_of[e] >= 0) k[e] *= std::exp(theta[parameter_of[e]]);
    }
    return k;
}

Eigen::SparseMatrix<double> Parameters::derivative(const Eigen::VectorXd& k) const {
    std::vector<Eigen::Triplet<double>> entries;
    for (int e = 0; e < k.size(); ++e) {
        if (parameter_of[e] >= 0) entries.emplace_back(e, parameter_of[e], k[e]);
    }
    Eigen::SparseMatrix<double> D(k.size(), size());
    D.setFromTriplets(entries.begin(), entries.end());
    return D;
}

Eigen::VectorXd Parameters::units() const {
    Eigen::VectorXd values(size());
    for (int p = 0; p < size(); ++p) values[p] = list[p].stiffness;
    return values;
}

Parameters group_stiffness(const skeleton::Model& model, Scope scope, const std::vector<skeleton::Stiffness>& fixed) {
    Parameters result;
    result.k0 = skeleton::stiffness_vector(model);
    result.parameter_of = Eigen::VectorXi::Constant(result.k0.size(), -1);

    // by group, then elongation, flexion, torsion
    std::map<std::pair<int, int>, std::vector<int>> members;
    for (int link = 0; link < static_cast<int>(model.links.size()); ++link) {
        for (int kind = 0; kind < 3; ++kind) {
            const bool is_fixed = std::ranges::find(fixed, static_cast<skeleton::Stiffness>(kind)) != fixed.end();
            if (!is_fixed && result.k0[3 * link + kind] > 0) {
                members[{group_of(model, scope, link), kind}].push_back(link);
            }
        }
    }
    for (const auto& [key, links] : members) {
        const auto [group, kind] = key;
        double log_sum = 0;
        for (const int link : links) {
            result.parameter_of[3 * link + kind] = result.size();
            log_sum += std::log(result.k0[3 * link + kind]);
        }
        result.list.push_back({name_of(scope, kind, group), static_cast<skeleton::Stiffness>(kind),
                               scope == Scope::links ? group : -1, links,
                               std::exp(log_sum / static_cast<double>(links.size()))});
    }
    if (result.list.empty()) {
        throw InvalidInput(
            "the model has nothing to identify: all stiffnesses of its links are zero or fixed; "
            "give the links start values above zero");
    }
    return result;
}

}  // namespace palpate::identify
