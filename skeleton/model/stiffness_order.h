#pragma once

#include "skeleton/model/model.h"

namespace palpate::skeleton {

/// Where the stiffnesses of a model stand in one vector k: elongation, flexion and torsion of each link (3L); then,
/// when its links are full, flexion_2, shear and shear_2 of each (3L), and the volume's of each sphere (N).
class StiffnessOrder {
public:
    explicit StiffnessOrder(const Model& model)
        : links_(std::ssize(model.links)),
          spheres_(std::ssize(model.spheres)),
          full_(links_ > 0 && model.links.front().section.has_value()) {}

    bool full() const { return full_; }
    Eigen::Index size() const { return full_ ? 6 * links_ + spheres_ : 3 * links_; }
    Eigen::Index of_link(Eigen::Index link, int kind) const {
        return kind < 3 ? 3 * link + kind : 3 * links_ + 3 * link + kind - 3;
    }
    Eigen::Index of_sphere(Eigen::Index sphere) const { return 6 * links_ + sphere; }
    /// How many stiffnesses a link has.
    int per_link() const { return full_ ? 6 : 3; }
    /// What stiffness stands at a place.
    Stiffness kind(Eigen::Index place) const {
        if (place >= 6 * links_) return Stiffness::volume;
        return static_cast<Stiffness>(place % 3 + (place < 3 * links_ ? 0 : 3));
    }
    /// The link or sphere that it belongs to.
    int owner(Eigen::Index place) const {
        if (place >= 6 * links_) return static_cast<int>(place - 6 * links_);
        return static_cast<int>(place % (3 * links_) / 3);
    }

    /// Those of one link out of k.
    Stiffnesses link(const Eigen::VectorXd& k, Eigen::Index link) const {
        Stiffnesses own(per_link());
        own.head<3>() = k.segment<3>(3 * link);
        if (full_) own.tail<3>() = k.segment<3>(3 * (links_ + link));
        return own;
    }

private:
    Eigen::Index links_, spheres_;
    bool full_;
};

}  // namespace palpate::skeleton
