#pragma once

#include <functional>
#include <vector>

#include "fem/rig/tendon_terms.h"
#include "identify/models/body_statics.h"

namespace palpate::identify {

// Tendons that rub, by what a model answers while friction is held.
//
// Friction has no potential: how much of the pull is left behind a turn depends on the turn. Held at the numbers p it
// leaves one, with an equilibrium q(p) and a tangent J; where p is what the path in q(p) makes of it, P(q), all forces
// balance. With B = - d residual / dp and D = dP/dq, a step solves (J + B D) dq = f, and its inverse follows from J^-1
// [Woodbury].

/// Finds p = P(q(p)), where there are tendons and they rub.
class FrictionIteration {
public:
    /// q(p) out of the tendons, `friction` set, from a configuration nearby.
    using Settle =
        std::function<Eigen::VectorXd(const std::vector<fem::TendonPull>& tendons, const Eigen::VectorXd* start)>;
    /// Friction of a tendon in q.
    using Follow = std::function<fem::TendonFriction(const fem::TendonPull& tendon, const Eigen::VectorXd& q)>;
    FrictionIteration(std::vector<fem::TendonPull> tendons, Settle settle, Follow follow);

    /// The equilibrium, sought from `first` on. @throws SolverFailure where none is found.
    Eigen::VectorXd equilibrium(const Eigen::VectorXd& first, const Eigen::VectorXd* start) const;

private:
    Eigen::VectorXd numbers_at(const Eigen::VectorXd& q) const;
    std::vector<fem::TendonPull> held_at(const Eigen::VectorXd& numbers) const;

    std::vector<fem::TendonPull> tendons_;
    Settle settle_;
    Follow follow_;
    double unit_;  // of lengths [mm]
};

/// Does any of them rub?
bool rub(const std::vector<fem::TendonPull>& tendons);

/// B (dofs x m) and D (m x dofs) of all tendons that rub.
fem::TendonSliding together(const std::vector<fem::TendonSliding>& tendons, Eigen::Index dofs);

/// The inverse of J + B D. @throws SolverFailure where there is none.
std::shared_ptr<const Tangent> tangent_with_friction(std::shared_ptr<const Tangent> held,
                                                     const fem::TendonSliding& all);
/// J, of a tangent with friction; others as they are.
const Tangent& with_friction_held(const Tangent& tangent);

}  // namespace palpate::identify
