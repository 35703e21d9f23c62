#pragma once

#include "skeleton/model/state.h"

namespace palpate::skeleton {

/// Where the two ends of a link are.
struct LinkPose {
    Vec3 x_a, x_b;  // [mm]
    Mat3 R_a, R_b;
};

inline LinkPose pose(const Link& link, const State& state) {
    return {state.x.row(link.a).transpose(), state.x.row(link.b).transpose(), state.R[link.a], state.R[link.b]};
}

}  // namespace palpate::skeleton
