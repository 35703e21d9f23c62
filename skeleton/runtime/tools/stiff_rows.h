#pragma once

#include <vector>

#include "skeleton/runtime/forces/carried.h"

namespace palpate::runtime {

/// What resists motions along some directions of a body with a stiffness each: vertices that a tool pushes, along its
/// normal; cables that are taut, along their length.
struct StiffRows {
    /// A point, placed, and what it counts for along the direction of its row.
    struct Move {
        const RuntimePoint* point;
        Vec3 along;
    };
    struct Row {
        double stiffness;   // [N/mm]
        std::size_t count;  // of its moves, which follow those of the row before
    };
    std::vector<Row> rows;
    std::vector<Move> moves;

    void clear() {
        rows.clear();
        moves.clear();
    }
    void add(double stiffness, const RuntimePoint& point, const Vec3& along) {
        rows.push_back({stiffness, 1});
        moves.push_back({&point, along});
    }
};

}  // namespace palpate::runtime
