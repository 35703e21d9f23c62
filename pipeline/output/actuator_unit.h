#pragma once

#include "mesh/core/actuator.h"

namespace palpate::pipeline {

/// Of an actuator's values: a pressure, a length drawn in, or a tension.
inline const char* unit_of(const mesh::Actuator& actuator) {
    const auto* tendon = std::get_if<mesh::TendonActuator>(&actuator.kind);
    return !tendon ? "MPa" : tendon->by_length ? "mm" : "N";
}

}  // namespace palpate::pipeline
