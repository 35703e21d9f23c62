#pragma once

namespace palpate::skeleton {

/// What joins two spheres.
enum class LinkKind {
    full,        // elongation, torsion, and shear apart from flexion in two planes; beside them a volume term a sphere
    burion2008,  // the paper's: elongation, flexion, torsion
};

/// Do its links have a section and six stiffnesses?
constexpr bool is_full(LinkKind kind) { return kind != LinkKind::burion2008; }

}  // namespace palpate::skeleton
