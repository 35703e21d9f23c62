#include "fem/effects/material/growth.h"

#include <algorithm>

#include "mesh/errors.h"

namespace palpate::fem {

double Growth::at(const Vec3& X) const {
    double sum = everywhere;
    for (const Part& part : parts) sum += part.growth * part.where.weight(X);
    return sum;
}

double Growth::between(const Vec3& X, const Vec3& Y) const {
    if (parts.empty()) return everywhere;
    constexpr int slices = 8;
    double sum = 0;
    for (int i = 0; i < slices; ++i) sum += at(X + (i + 0.5) / slices * (Y - X));
    return sum / slices;
}

bool Growth::possible() const {
    double least = everywhere;
    for (const Part& part : parts) least += std::min(part.growth, 0.0);
    return least > -1;
}

void Growth::add(const Growth& more) {
    everywhere += more.everywhere;
    parts.insert(parts.end(), more.parts.begin(), more.parts.end());
    if (!possible())
        throw InvalidInput(
            "swelling and local swelling together shrink the material to nothing: their growths must "
            "stay above -1 where they overlap");
}

}  // namespace palpate::fem
