#include "identify/recordings/assembly/map/plateau_options.h"

#include <fmt/format.h>

#include "mesh/errors.h"

namespace palpate::identify {

void PlateauOptions::validate() const {
    if (!(shortest >= 0 && shortest < 1e6))
        throw InvalidInput(
            fmt::format("plateaus.shortest: {} s is no length of a plateau; give one above 0", shortest));
    if (!(still > 0 && still < 1))
        throw InvalidInput(fmt::format("plateaus.still: {} is no share of the range; it lies between 0 and 1", still));
}

}  // namespace palpate::identify
