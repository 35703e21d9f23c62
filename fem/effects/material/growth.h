#pragma once

#include <vector>

#include "fem/effects/local/locality.h"

namespace palpate::fem {

/// What the material has grown by in every free length since its rest shape was taken [-]: at X
///   everywhere + sum_i growth_i g_i(X),   > -1.
struct Growth {
    struct Part {
        Locality where;
        double growth = 0;
    };
    double everywhere = 0;
    std::vector<Part> parts{};

    bool none() const { return everywhere == 0 && parts.empty(); }
    double at(const Vec3& X) const;
    /// The mean along a straight line.
    double between(const Vec3& X, const Vec3& Y) const;
    /// Is some of the material left, wherever parts overlap?
    bool possible() const;
    void add(const Growth& more);
};

}  // namespace palpate::fem
