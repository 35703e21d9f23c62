#include "fem/linear_algebra/solver_choice.h"

#include <fmt/format.h>

#include <cmath>

#include "fem/linear_algebra/memory/free_memory.h"

namespace palpate::fem {
namespace {

// What bars of 100,000 and 300,000 nodes took on two cores, loads in eights (tests/bench/fem/RESULTS.md).
constexpr double products_per_second = 4.8e10;
constexpr double multigrid_of_a_node = 2.5e-5;  // [s]
constexpr double load_on_a_node = 5e-6;         // [s]; 7e-6 before products prefetched, of which 0.68 is left
constexpr double gigabytes_of_a_node = 7.9e-6;  // 2.5 GB of 314,847 nodes, 8.3 GB of 1,047,781
constexpr double worthwhile = 0.4;              // of a factor's time: other meshes take more iterations

/// Multiplications of a factorisation.
double factor_products(const Supernodes& structure) {
    double products = 0;
    for (int s = 0; s < structure.count(); ++s) {
        for (int c = 0; c < structure.columns(s); ++c) {
            const double height = structure.height(s) - c;
            products += height * height / 2;
        }
    }
    return products;
}

}  // namespace

double FactorCost::seconds() const { return products / products_per_second; }

FactorCost FactorCost::with_nodes(double other) const {
    const double ratio = nodes > 0 ? other / nodes : 0;
    return {other, std::pow(ratio, 4.0 / 3) * entries, ratio * matrix_gigabytes, ratio * ratio * products};
}

FactorCost cost_of_factor(const Supernodes& structure, const std::vector<std::vector<int>>& lower) {
    double blocks = 0;
    for (const auto& rows : lower) blocks += static_cast<double>(rows.size());
    return {structure.size() / 3.0, static_cast<double>(structure.first_value.back()), 9 * 16e-9 * blocks,
            factor_products(structure)};
}

double seconds_without_factor(double nodes, int loads) {
    return nodes * (multigrid_of_a_node + loads * load_on_a_node);
}

double multigrid_gigabytes(double nodes) { return gigabytes_of_a_node * nodes; }

bool is_faster_without_factor(const FactorCost& cost, int loads) {
    return loads > 0 && seconds_without_factor(cost.nodes, loads) < worthwhile * cost.seconds();
}

double usable_memory() {
    constexpr double share = 0.9;
    return share * free_memory();
}

std::string no_room_for_factor(std::ptrdiff_t unknowns, double needed, double allowed) {
    return fmt::format(
        "a factor of the stiffness matrix ({} unknowns) would take {:.3g} GB of {:.3g} GB: choose another solver, "
        "larger elements or more memory",
        unknowns, needed, allowed);
}

}  // namespace palpate::fem
