#include "fem/effects/local/known_locality.h"

namespace palpate::fem {

std::vector<KnownParameter> locality_parameters() {
    return {{"cx", "mm"}, {"cy", "mm"}, {"cz", "mm"}, {"radius", "mm", Range::positive}};
}

Locality locality(const EffectNumbers& numbers) { return {numbers.vector("cx", "cy", "cz"), numbers["radius"]}; }

}  // namespace palpate::fem
