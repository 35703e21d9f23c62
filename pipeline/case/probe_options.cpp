#include "pipeline/case/probe_options.h"

#include <fmt/format.h>

#include <string>

#include "mesh/errors.h"

namespace palpate::pipeline {

namespace {

void require(bool holds, const std::string& what, double value, const std::string& allowed) {
    if (!holds) throw InvalidInput(fmt::format("{} is {}, allowed is {}", what, value, allowed));
}

}  // namespace

void ProbeOptions::validate() const {
    require(probes >= 1 && probes <= most_probes, "probes", probes, fmt::format("1 to {}", most_probes));
    require(held_out >= 0 && held_out < probes, "held_out", held_out, "0 to one less than the probes");
    require(markers >= least_markers && markers <= most_markers, "markers", markers,
            fmt::format("{} to {}", least_markers, most_markers));
    require(displacement >= 0 && displacement <= most_share, "displacement", displacement,
            fmt::format("0 to {} of the longest side", most_share));
    require(radius > 0 && radius <= most_share, "radius", radius,
            fmt::format("above 0 to {} of the longest side", most_share));
    require(noise >= 0, "noise", noise, "0 mm or more");
}

}  // namespace palpate::pipeline
