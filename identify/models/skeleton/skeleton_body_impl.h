#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <mutex>
#include <tuple>

#include "identify/loading/loads.h"
#include "identify/models/skeleton/skeleton_body.h"
#include "identify/models/tendon_friction.h"
#include "skeleton/effects/placed_tendon.h"
#include "skeleton/model/growth.h"
#include "skeleton/model/state.h"
#include "skeleton/model/stiffness_order.h"
#include "skeleton/statics/equilibrium.h"

namespace palpate::identify {

inline Eigen::VectorXd pack(const skeleton::State& state) {
    const Eigen::Index N = state.x.rows();
    Eigen::VectorXd q(12 * N);
    for (Eigen::Index i = 0; i < N; ++i) {
        q.segment<3>(3 * i) = state.x.row(i);
        q.segment<9>(3 * N + 9 * i) = state.R[i].reshaped();
    }
    return q;
}

inline skeleton::State unpack(const Eigen::VectorXd& q) {
    const Eigen::Index N = q.size() / 12;
    skeleton::State state{Points(N, 3), std::vector<Mat3>(N)};
    for (Eigen::Index i = 0; i < N; ++i) {
        state.x.row(i) = q.segment<3>(3 * i);
        state.R[i] = q.segment<9>(3 * N + 9 * i).reshaped(3, 3);
    }
    return state;
}

inline bool in_large_rotation(const ModelSetting& setting) {
    return static_cast<skeleton::EquilibriumLaw>(setting.law) != skeleton::EquilibriumLaw::linear;
}

class SolverTangent : public Tangent {
public:
    SolverTangent(const skeleton::Model& model, const fem::Effects& effects, const Eigen::VectorXd& k,
                  const skeleton::Load& load, const skeleton::Equilibrium& at)
        : solver_(model, effects), dofs_(model.dofs()) {
        solver_.factor_tangent(k, load, at);
    }
    Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const override { return solver_.solve_tangent(B); }
    /// An estimate: at most 500 entries of the factor for each degree of freedom.
    double gigabytes() const override { return 8e-9 * dofs_ * std::min(dofs_, 500); }

private:
    skeleton::StaticsSolver solver_;
    int dofs_;
};

/// What the links' fibres have been through.
class FibreMemory : public Memory {
public:
    explicit FibreMemory(skeleton::FibreStates states) : fibres(std::move(states)) {}
    skeleton::FibreStates fibres;
};

inline const skeleton::FibreStates& fibres_before(const Action& action) {
    static const skeleton::FibreStates none;
    const auto* own = dynamic_cast<const FibreMemory*>(action.memory.get());
    return own ? own->fibres : none;
}

/// The spheres, links and skin at rest.
BodyGeometry geometry_of(const skeleton::Model& model);

/// What SkeletonBody is made of, for its own sources alone.
struct SkeletonBody::Impl {
    explicit Impl(const Rig& the_rig) : rig(the_rig) {}
    PreparedRig rig;
    std::array<skeleton::Model, 2> by_law;  // the same but for the law
    std::vector<skeleton::Attachment> markers;
    std::vector<std::string> laws;
    std::vector<StiffnessParameter> parameters;
    Eigen::VectorXd k0;             // as skeleton::StiffnessOrder says
    std::vector<int> parameter_of;  // of each stiffness
    double young;
    BodyGeometry geometry;  // its pieces are the links, its points of the material the spheres
    std::unique_ptr<ContactLoads> loads;

    void find_kinds(double prior_sd, const std::vector<InformativePrior>& priors);

    using Place = std::tuple<double, double, double, double>;
    mutable std::mutex mutex;
    mutable std::map<Place, skeleton::Load> shares;  // of a force of 1 N along x

    const skeleton::Model& model(const ModelSetting& setting) const { return by_law[setting.law]; }
    Eigen::RowVectorXd weight_of(const skeleton::StiffnessOrder& order, Eigen::Index place,
                                 const Eigen::MatrixXd& W) const;
    skeleton::Load shares_of(const mesh::Contact& contact) const;
    skeleton::Load load(const Action& action) const;
    /// What is in force: a pressure that is known to act does so in cavities, where there are any.
    fem::Effects effects(const ModelSetting& setting, const Action& action) const {
        fem::Effects result = setting.effects;
        if (geometry.has_cavities) result.pressure += action.pressure;
        rig.add(action, young_of(setting), result);
        return result;
    }
    /// Points as far out as the material that carries them has grown.
    std::vector<skeleton::Attachment> grown(std::vector<skeleton::Attachment> points,
                                            const ModelSetting& setting) const {
        const fem::Growth& growth = setting.effects.growth;
        if (growth.none()) return points;
        const skeleton::State rest = skeleton::rest_state(model(setting));
        for (skeleton::Attachment& point : points) point = skeleton::grown(std::move(point), rest, growth);
        return points;
    }
    /// Of the tendons that rub.
    fem::TendonSliding sliding(const Eigen::VectorXd& q, const ModelSetting& setting,
                               const fem::Effects& effects) const {
        std::vector<fem::TendonSliding> each;
        for (const fem::TendonPull& pull : effects.tendons)
            if (pull.coefficient != 0)
                each.push_back(skeleton::PlacedTendon(model(setting), pull).sliding(equilibrium_of(q, setting).state));
        return together(each, by_law[0].dofs());
    }
    /// What the linear law expands about rest takes friction as it is in `state`.
    void hold_friction(const skeleton::State& state, fem::Effects& effects) const {
        for (fem::TendonPull& pull : effects.tendons)
            if (pull.coefficient != 0) pull.friction = skeleton::PlacedTendon(by_law[0], pull).friction(state);
    }
    double young_of(const ModelSetting& setting) const { return young * std::exp(setting.theta.mean()); }
    /// A configuration as the statics know it.
    skeleton::Equilibrium equilibrium_of(const Eigen::VectorXd& q, const ModelSetting& setting,
                                         const Action& action = {}) const {
        skeleton::Equilibrium at;
        at.before = fibres_before(action);
        if (static_cast<skeleton::EquilibriumLaw>(setting.law) == skeleton::EquilibriumLaw::linear) {
            at.step = q;
            at.state = skeleton::advance(skeleton::rest_state(by_law[0]), q);
        } else {
            at.state = unpack(q);
        }
        return at;
    }
    /// Forces of tools and of tendons of a given length, on all spheres (6N).
    Eigen::VectorXd grip_force(const Eigen::VectorXd& q, const ModelSetting& setting, const Action& action) const;
    /// Calls visit(point, where it is, the potential's terms times its weight) for the points that feel a tool.
    template <class Visit>
    void for_each_point_of(const mesh::ToolMotion& motion, const Eigen::VectorXd& q, const ModelSetting& setting,
                           const Visit& visit) const;
    skeleton::State tangent_state(const Eigen::VectorXd& q, const ModelSetting& setting) const {
        return static_cast<skeleton::EquilibriumLaw>(setting.law) == skeleton::EquilibriumLaw::linear
                   ? skeleton::rest_state(by_law[0])
                   : unpack(q);
    }
};

}  // namespace palpate::identify
