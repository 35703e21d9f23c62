#include "pipeline/synthesis/probing/held_out.h"

#include <algorithm>
#include <iterator>

namespace palpate::pipeline {

identify::MeasurementSet states_of(const identify::MeasurementSet& set,
                                   const std::function<bool(const identify::LoadState&)>& keep) {
    identify::MeasurementSet part = set;
    part.states.clear();
    std::copy_if(set.states.begin(), set.states.end(), std::back_inserter(part.states), keep);
    return part;
}

}  // namespace palpate::pipeline
