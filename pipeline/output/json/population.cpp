#include "pipeline/output/json/population.h"

#include <algorithm>

#include "identify/numerics/summaries.h"

namespace palpate::pipeline {
namespace {

using nlohmann::json;

/// The middle and 95 % of what is normal about a mean, in the number's own unit.
json interval(const SharedNumber& number, double mean, double sd) {
    const double below = number_at(number.scale, mean - identify::sds_of_95_percent * sd);
    const double above = number_at(number.scale, mean + identify::sds_of_95_percent * sd);
    return {
        {"low", std::min(below, above)}, {"value", number_at(number.scale, mean)}, {"high", std::max(below, above)}};
}

}  // namespace

json population_json(const std::vector<SharedNumber>& numbers, const std::vector<identify::PooledNumber>& pooled) {
    json result = {{"format", "palpate-population/1"}, {"numbers", json::array()}};
    for (std::size_t n = 0; n < numbers.size(); ++n) {
        const SharedNumber& number = numbers[n];
        const identify::PooledNumber& all = pooled[n];
        json specimens = json::array();
        for (const identify::PooledSpecimen& one : all.specimens) {
            specimens.push_back({{"run", one.specimen},
                                 {"own", interval(number, one.own_mean, one.own_sd)},
                                 {"pooled", interval(number, one.mean, one.sd)},
                                 {"p_value", one.p_value},
                                 {"outlying", one.is_outlying}});
        }
        result["numbers"].push_back(
            {{"name", number.name},
             {"unit", number.unit},
             {"of", number.of},
             {"scale", scale_name(number.scale)},
             {"mean", interval(number, all.mean, all.mean_sd)},
             {"spread", {{"low", all.spread_low}, {"value", all.spread}, {"high", all.spread_high}}},
             {"next", interval(number, all.next_mean, all.next_sd)},
             {"specimens", std::move(specimens)},
             {"without", number.without}});
    }
    return result;
}

}  // namespace palpate::pipeline
