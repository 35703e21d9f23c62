#pragma once

#include <string>

#include "identify/measurements/measurement_set.h"
#include "identify/measurements/rest_body.h"

namespace palpate::identify {

/// @throws InvalidInput when a contact or marker lies far off the rest surface: further than 5 % of the body's longest
/// side, beyond the radius of a contact, and outside the body for a marker. That is a wrong unit or frame.
void check_places(const MeasurementSet& set);

/// The same for the contacts of one state. `source`: begins the message.
void check_contacts(const RestBody& rest, const LoadState& state, const std::string& source);

}  // namespace palpate::identify
