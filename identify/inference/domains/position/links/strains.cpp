#include "identify/inference/domains/position/links/strains.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "identify/numerics/random.h"

namespace palpate::identify {
namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;
using Row = std::pair<Eigen::Index, double>;

/// The forces of the volumes after a step, of each stiffness (6N).
std::map<Eigen::Index, std::vector<Row>> volume_forces(const LinksAtRest& links, const Eigen::VectorXd& step) {
    Triplets entries;
    links.placed.volumes().add_linear_forces(step, entries);
    std::map<Eigen::Index, std::vector<Row>> forces;
    for (const auto& entry : entries) {
        if (entry.value() != 0) forces[entry.col()].emplace_back(entry.row(), entry.value());
    }
    return forces;
}

double largest(const std::map<Eigen::Index, std::vector<Row>>& forces) {
    double found = 0;
    for (const auto& [stiffness, force] : forces) {
        for (const auto& [i, value] : force) found = std::max(found, std::abs(value));
    }
    return found;
}

}  // namespace

void Strains::add_products(const fem::MultiVector& U, const fem::MultiVector& L, Eigen::VectorXd& sum) const {
    const fem::MultiVector of_U = b * U, of_L = b * L;
    const Eigen::VectorXd products = weights.cwiseProduct(of_U.cwiseProduct(of_L).rowwise().sum());
    for (std::size_t j = 0; j < of.size(); ++j) sum[of[j]] += products[static_cast<Eigen::Index>(j)];
}

std::optional<Strains> strains_of(const LinksAtRest& links) {
    const Eigen::Index dofs = Eigen::Index{6} * links.state.x.rows();
    Strains strains;
    Triplets entries;
    std::vector<double> weights;
    const auto row = [&] { return static_cast<int>(weights.size()); };
    for (Eigen::Index l = 0; l < std::ssize(links.ends); ++l) {
        for (Eigen::Index j = links.first[l]; j < links.first[l + 1]; ++j) {
            for (int i = 0; i < 12; ++i) {
                const double value = links.strains(i, j);
                if (value != 0) entries.emplace_back(row(), 6 * links.ends[l][i / 6] + i % 6, value);
            }
            weights.push_back(links.weights[j]);
            strains.of.push_back(static_cast<int>(links.order.of_link(l, links.kind[j])));
        }
    }

    // A volume withstands one strain, H = b b^T, so its force f = -H r after any step r tells it: H = f f^T / -(f . r).
    if (!links.placed.volumes().empty()) {
        const Eigen::VectorXd r = RandomStream(1, 0, 0).normals(static_cast<int>(dofs));
        const auto at_rest = volume_forces(links, Eigen::VectorXd::Zero(dofs)), moved = volume_forces(links, r);
        constexpr double rounding = 1e-9;  // of forces after a step of about 1: what swelling makes is far larger
        if (largest(at_rest) > rounding * largest(moved)) return std::nullopt;
        for (const auto& [stiffness, force] : moved) {
            double work = 0;
            for (const auto& [i, value] : force) {
                entries.emplace_back(row(), static_cast<int>(i), value);
                work -= value * r[i];
            }
            weights.push_back(1 / work);
            strains.of.push_back(static_cast<int>(stiffness));
        }
    }
    strains.b.resize(std::ssize(weights), dofs);
    strains.b.setFromTriplets(entries.begin(), entries.end());
    strains.weights = Eigen::Map<const Eigen::VectorXd>(weights.data(), std::ssize(weights));
    return strains;
}

}  // namespace palpate::identify
