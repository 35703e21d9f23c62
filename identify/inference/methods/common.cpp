#include <fmt/format.h>

#include <algorithm>

#include "identify/inference/domains/force/node_configuration.h"
#include "identify/inference/methods/methods.h"
#include "identify/loading/readings.h"
#include "mesh/errors.h"

namespace palpate::identify {

std::vector<MeasuredConfiguration> complete_configurations(const skeleton::Model& model, const MeasurementSet& set,
                                                           const char* method) {
    std::vector<MeasuredConfiguration> measured = measured_configurations(model, set);
    if (measured.empty()) {
        throw InvalidInput(fmt::format(
            "measurement set '{}' has no loaded state in which every sphere's place and turn are known, which {} "
            "needs: at least three markers on each sphere, not in line, or the full field; "
            "method tempered in the position domain does without",
            set.name, method));
    }
    return measured;
}

std::vector<StateReadings> informative_readings(const skeleton::Model& model, const MeasurementSet& set) {
    std::vector<StateReadings> readings = collect_readings(model, set);
    if (std::ranges::none_of(readings, &StateReadings::informs_stiffness)) {
        throw InvalidInput(
            fmt::format("measurement set '{}' has no state with both a load and a labelled reading: stiffness "
                        "shows only under a force or a known weight; add a row with a force to probes.csv and its "
                        "markers to positions.csv, or tell 'density' and 'gravity' in set.yaml",
                        set.name));
    }
    return readings;
}

}  // namespace palpate::identify
