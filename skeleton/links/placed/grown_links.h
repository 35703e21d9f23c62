#pragma once

#include <vector>

#include "fem/effects/material/growth.h"
#include "skeleton/links/fibres/link_fibre.h"
#include "skeleton/model/link_pose.h"

namespace palpate::skeleton {

/// A model's links after its material has grown in every free length since its rest shape was taken; stiffnesses stay
/// what they are.
///
/// Each is as much longer as its section has grown in the mean, the paper's by what there is along its axis. Where a
/// full link's section has grown by g(y, z), more on one side than on the other, it curves, too: of the elongations
/// that leave a section plane the one nearest to g has
///   k = -cov(g, y) / var(y) in the plane of flexion,   k_2 = cov(g, z) / var(z) in that of flexion_2   [1/mm].
/// Along the link these add up to turns, and about the section's centroid to partings across (LinkSection::natural).
std::vector<Link> grown_links(const Model& model, const fem::Growth& growth);

/// Each of them by itself where nothing strains it.
std::vector<LinkPose> natural_poses(const Model& model, const std::vector<Link>& grown);
/// As long, but straight: where the linear law takes links' stiffness. At ends that have turned a small step's stretch
/// would bend the link, as stiff as it is along.
std::vector<LinkPose> straight_poses(const Model& model, const std::vector<Link>& grown);

/// How long the fibres of each are where nothing strains them [mm].
using FibreLengths = std::array<double, fibres_per_link>;
std::vector<FibreLengths> fibre_lengths(const Model& model, const std::vector<Link>& grown);

}  // namespace palpate::skeleton
