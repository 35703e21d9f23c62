#include "identify/inference/problem/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "mesh/errors.h"
#include "skeleton/model/stiffness_order.h"
#include "skeleton/statics/statics.h"

namespace palpate::identify {
namespace {

using skeleton::Stiffness;

constexpr double own_weight = 1;  // of a link in its prior, as much as that of the neighbours at one end

/// Of those that share a multiplier: 0 for all, the zone, or the link or sphere itself.
int group_of(const skeleton::Model& model, Scope scope, Stiffness kind, int owner) {
    if (scope == Scope::uniform || (scope == Scope::zones && kind == Stiffness::volume)) return 0;
    return scope == Scope::zones ? model.links[owner].zone : owner;
}

std::string name_of(Scope scope, Stiffness kind, int group) {
    const char* name = skeleton::stiffness_names[static_cast<int>(kind)];
    const bool is_volume = kind == Stiffness::volume;
    if (scope == Scope::uniform || (scope == Scope::zones && is_volume)) return name;
    return fmt::format("{}:{}{}", name, scope == Scope::zones ? "zone" : is_volume ? "sphere" : "link", group);
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

std::vector<MarkovField::Edge> neighbours(const skeleton::Model& model, const Parameters& parameters) {
    // of each kind: the multiplier of each link, or sphere, and which meet at each sphere
    std::vector<MarkovField::Edge> edges;
    for (int kind = 0; kind < static_cast<int>(std::size(skeleton::stiffness_names)); ++kind) {
        const bool is_volume = static_cast<Stiffness>(kind) == Stiffness::volume;
        std::vector<int> of_owner(is_volume ? model.spheres.size() : model.links.size(), -1);
        for (int p = 0; p < parameters.size(); ++p) {
            if (static_cast<int>(parameters.list[p].kind) == kind) of_owner[parameters.list[p].owners.front()] = p;
        }
        std::vector<std::vector<int>> meeting(model.spheres.size());
        for (std::size_t l = 0; l < model.links.size(); ++l) {
            const auto& [a, b] = std::pair(model.links[l].a, model.links[l].b);
            const int at_a = is_volume ? of_owner[b] : of_owner[l], at_b = is_volume ? of_owner[a] : of_owner[l];
            if (at_a >= 0) meeting[a].push_back(at_a);
            if (at_b >= 0) meeting[b].push_back(at_b);
        }
        for (std::size_t i = 0; i < meeting.size(); ++i) {
            const std::vector<int>& here = meeting[i];
            if (is_volume && of_owner[i] < 0) continue;
            for (std::size_t a = 0; a < here.size(); ++a) {
                if (is_volume) {
                    edges.push_back({of_owner[i], here[a], 1 / static_cast<double>(here.size())});
                    continue;
                }
                for (std::size_t b = 0; b < a; ++b) {
                    edges.push_back({here[a], here[b], 1 / static_cast<double>(here.size() - 1)});
                }
            }
        }
    }
    return edges;
}

std::shared_ptr<const MarkovField> smoothness_field(const skeleton::Model& model, const Parameters& parameters) {
    return std::make_shared<MarkovField>(parameters.size(), neighbours(model, parameters), own_weight);
}

Eigen::VectorXd spread_kinds(const Parameters& fine, const Parameters& uniform, const Eigen::VectorXd& theta) {
    Eigen::VectorXd result(fine.size());
    for (int p = 0; p < fine.size(); ++p) {
        const auto same = std::ranges::find(uniform.list, fine.list[p].kind, &Parameter::kind);
        result[p] = theta[same - uniform.list.begin()];
    }
    return result;
}

Parameters group_stiffness(const skeleton::Model& model, Scope scope, const std::vector<skeleton::Stiffness>& fixed) {
    Parameters result;
    result.k0 = skeleton::stiffness_vector(model);
    result.parameter_of = Eigen::VectorXi::Constant(result.k0.size(), -1);

    // links by group, and in a group by kind; then volumes
    const skeleton::StiffnessOrder order(model);
    std::map<std::tuple<bool, int, Stiffness>, std::vector<Eigen::Index>> members;
    for (Eigen::Index place = 0; place < order.size(); ++place) {
        const Stiffness kind = skeleton::as_identified(order.kind(place));
        if (!(result.k0[place] > 0) || std::ranges::find(fixed, kind) != fixed.end()) continue;
        members[{kind == Stiffness::volume, group_of(model, scope, kind, order.owner(place)), kind}].push_back(place);
    }
    for (const auto& [key, places] : members) {
        const auto& [is_volume, group, kind] = key;
        Parameter parameter{name_of(scope, kind, group), kind, scope == Scope::links && !is_volume ? group : -1, {}, 0};
        double log_sum = 0;
        for (const Eigen::Index place : places) {
            result.parameter_of[place] = result.size();
            parameter.owners.push_back(order.owner(place));
            log_sum += std::log(result.k0[place]);
        }
        parameter.stiffness = std::exp(log_sum / static_cast<double>(places.size()));
        result.list.push_back(std::move(parameter));
    }
    if (result.list.empty()) {
        throw InvalidInput(
            "the model has nothing to identify: all stiffnesses of its links are zero or fixed; "
            "give the links start values above zero");
    }
    return result;
}

}  // namespace palpate::identify
