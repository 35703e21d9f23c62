#pragma once

#include <optional>
#include <string>
#include <vector>

namespace palpate::identify {

/// The error grows with the load, measured by how far it moves the model, to this power: 0 there without any load, 1
/// like a wrong stiffness, 2 and more a nonlinearity.
struct LoadExponent {
    double value = 0, sd = 0;
    std::string words;
};

/// The error of a state, against what acted on it. A load is measured by how far it moves the model: a soft place and a
/// hard one compare, and the same wrong stiffness shows as the same share of it.
struct ErrorUnderLoad {
    double load = 0;      // rms displacement of the modelled markers [mm]; 0, but for rounding: unloaded
    double rms = 0;       // [mm]
    double noise = 0;     // its share that is noise, rms [mm]; 0 when unknown
    int coordinates = 1;  // measured
    bool loaded = true;   // from outside; else it moves by what acts in every state, as gravity
};

/// p in error ~ load^p, from a line through ln(error) over ln(load), the noise taken off in squares.
///
/// A state without load says p = 0 where its error is there; where nothing is left of it but noise, it says only that p
/// is above 0. It enters at the load at which an error in proportion to the load would sink into the noise, and only
/// where its error is above that, or where the others do not tell that p is above 0. Empty when the loads do not
/// differ.
std::optional<LoadExponent> load_exponent(const std::vector<ErrorUnderLoad>& states);

}  // namespace palpate::identify
