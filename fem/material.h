#pragma once

#include <cstddef>
#include <vector>

namespace palpate::fem {

inline constexpr double tonne_per_mm3 = 1e-12;  // one kg/m^3

/// An isotropic, linearly elastic material.
struct Material {
    double young = 0.1;     // [MPa], > 0
    double poisson = 0.45;  // [-], (-1, 0.5)
    double density = 1e-9;  // [tonne/mm^3], >= 0; 1000 kg/m^3 = 1e-9 tonne/mm^3

    double shear_modulus() const { return young / (2 * (1 + poisson)); }                          // mu [MPa]
    double bulk_modulus() const { return young / (3 * (1 - 2 * poisson)); }                       // K [MPa]
    double lame_lambda() const { return young * poisson / ((1 + poisson) * (1 - 2 * poisson)); }  // [MPa]

    /// @throws InvalidInput naming the value and the range.
    void validate() const;
};

/// What the elements of a body are made of: one material, and others in regions of it.
struct Materials {
    Material body;
    std::vector<Material> regions{};
    std::vector<int> of_element{};  // the region of each element, -1: it is of none; empty: all are of none

    const Material& of(std::size_t element) const {
        const int region = of_element.empty() ? -1 : of_element[element];
        return region < 0 ? body : regions[static_cast<std::size_t>(region)];
    }
    /// The largest of Poisson's ratios.
    double most_poisson() const;
    void validate() const;
};

}  // namespace palpate::fem
