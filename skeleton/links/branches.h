#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "skeleton/model/model.h"
#include "skeleton/model/state.h"

namespace palpate::skeleton {

/// How spheres hang on those that are held where links make no loops, as in a chain or a limb with its branches.
///
/// There a step need not go straight. A link whose ends turn by w and whose far end is to part from the near one by d
/// carries its arm a to exp(w) (a + d - w x a): the same to first order, but a turn leaves the arm's length. So a step
/// of Newton's method may bend a long chain far, where a straight one stretches each of its links by its turn squared.
class Branches {
public:
    Branches() = default;
    /// `moves`: of each sphere. None where links make a loop, or a path from one held sphere to another.
    Branches(const std::vector<Link>& links, const std::vector<char>& moves);

    bool empty() const { return tree_edges_.empty(); }
    struct TreeEdge {
        int sphere, near;  // the end that moves, and the one that it hangs on
    };
    /// From the held spheres outwards: as many as spheres move.
    const std::vector<TreeEdge>& tree_edges() const { return tree_edges_; }

    /// What a twig's arm becomes by a share of a step: `parts`, how far the step takes its ends apart, and `turns`, the
    /// mean of their turns.
    static Vec3 carried(const Vec3& arm, const Vec3& parts, const Vec3& turns, double share) {
        return rotation(share * turns) * (arm + share * stretch(arm, parts, turns));
    }
    /// The part of a step that is no turn.
    static Vec3 stretch(const Vec3& arm, const Vec3& parts, const Vec3& turns) { return parts - turns.cross(arm); }

private:
    std::vector<TreeEdge> tree_edges_;
};

}  // namespace palpate::skeleton
