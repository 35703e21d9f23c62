#include <fmt/format.h>

#include "fem/elastic_body.h"
#include "mesh/errors.h"

namespace palpate::fem {

void ElasticBodyOptions::validate() const {
    if (threads < 1) {
        throw InvalidInput(fmt::format("threads is {}; allowed: 1 and more.", threads));
    }
    if (block < 1 || block > 1024) {
        throw InvalidInput(fmt::format("block (right-hand sides solved together) is {}; allowed: 1 to 1024.", block));
    }
    if (!(memory >= 0)) {
        throw InvalidInput(fmt::format("memory (that a factor may take) is {} GB; allowed: 0 and more.", memory));
    }
    if (loads < 0) {
        throw InvalidInput(fmt::format("loads (to be solved for) is {}; allowed: 0 and more.", loads));
    }
}

}  // namespace palpate::fem
