#include "identify/inference/problem/identify_options.h"

#include <fmt/format.h>

#include "mesh/errors.h"

namespace palpate::identify {

void IdentifyOptions::validate() const {
    const auto demand = [](bool holds, const char* option, double value, const char* allowed) {
        if (!holds) throw InvalidInput(fmt::format("option {} is {}; it must be {}", option, value, allowed));
    };
    demand(particles == 0 || particles >= 10, "particles", particles, "0 (by the method) or at least 10");
    demand(iterations >= 1, "iterations", iterations, "at least 1");
    demand(search_low > 0, "search_low", search_low, "above 0");
    demand(search_high > search_low, "search_high", search_high, "above search_low");
    if (method == Method::burion2008 && !priors.empty())
        throw InvalidInput(
            "burion2008 takes an even prior from search_low to search_high, and no other; use the method 'tempered'");
    demand(threads >= 1, "threads", threads, "at least 1");
}

}  // namespace palpate::identify
