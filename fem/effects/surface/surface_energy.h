#pragma once

#include <memory>
#include <vector>

#include "mesh/types.h"

namespace palpate::fem {

/// An energy of the skin per area at rest, by how many times as large the area J has become, and its derivatives.
struct AreaTerms {
    double w = 0;                  // [N/mm]
    double first = 0, second = 0;  // dw/dJ, d^2 w / dJ^2
};

/// A physical effect in the skin of a body, as an energy of its area:
///   Pi = int w(X, J) dA
/// over the skin at rest, walls of cavities too, J the area that a unit of it has become: gamma J is an energy of gamma
/// per area as it stands. Written once, in force on every model of the body: the faces of finite elements, the
/// triangles of a skeleton's skin.
class SurfaceEnergy {
public:
    virtual ~SurfaceEnergy() = default;
    /// @pre J >= 0.
    virtual AreaTerms terms(const Vec3& X, double J) const = 0;
};

using SurfaceEnergies = std::vector<std::shared_ptr<const SurfaceEnergy>>;

/// Several effects together.
inline AreaTerms sum_of_terms(const SurfaceEnergies& effects, const Vec3& X, double J) {
    AreaTerms sum;
    for (const auto& effect : effects) {
        const AreaTerms terms = effect->terms(X, J);
        sum.w += terms.w;
        sum.first += terms.first;
        sum.second += terms.second;
    }
    return sum;
}

}  // namespace palpate::fem
