#include "identify/models/skeleton/skeleton_body_impl.h"

#include "fem/rig/tool_potential.h"
#include "identify/models/free_tools.h"
#include "skeleton/effects/placed_effects.h"
#include "skeleton/effects/placed_tendon.h"
#include "skeleton/loads/cavities.h"
#include "skeleton/model/attachment/carried_point.h"
#include "skeleton/statics/statics.h"

namespace palpate::identify {

Eigen::MatrixXd SkeletonBody::tangent_times(const Eigen::VectorXd& q, const ModelSetting& setting, const Action& action,
                                            const Eigen::MatrixXd& steps) const {
    if (has_free_coordinates(action)) return tangent_times_with_free_tools(*this, q, setting, action, steps);
    skeleton::Model model = impl_->model(setting);
    skeleton::set_stiffness(model, stiffness(setting));
    const skeleton::Load load = in_large_rotation(setting) ? impl_->load(action) : skeleton::Load{};
    const fem::Effects effects = impl_->effects(setting, action);
    const fem::TendonSliding sliding = impl_->sliding(q, setting, effects);
    return skeleton::tangent(model, impl_->tangent_state(q, setting), load, effects, fibres_before(action)) * steps +
           sliding.by_number * (sliding.number_by_point * steps);
}

Eigen::VectorXd SkeletonBody::Impl::grip_force(const Eigen::VectorXd& q, const ModelSetting& setting,
                                               const Action& action) const {
    fem::Effects holding{.tendon_friction = setting.effects.tendon_friction};
    rig.add(action, young_of(setting), holding);
    holding.cavities.clear();
    std::erase_if(holding.tendons, [](const fem::TendonPull& pull) { return !pull.actuator->by_length; });
    if (holding.empty()) return Eigen::VectorXd::Zero(by_law[0].dofs());
    if (!in_large_rotation(setting)) hold_friction(equilibrium_of(q, setting).state, holding);
    const skeleton::PlacedEffects placed(model(setting), holding);
    return in_large_rotation(setting) ? placed.force(unpack(q)) : placed.linear_force(q);
}

template <class Visit>
void SkeletonBody::Impl::for_each_point_of(const mesh::ToolMotion& motion, const Eigen::VectorXd& q,
                                           const ModelSetting& setting, const Visit& visit) const {
    fem::Effects holding;
    holding.tools = {rig.tool(motion, young_of(setting))};
    const skeleton::PlacedEffects placed(model(setting), holding);
    placed.for_each_point_of_tool(0, tangent_state(q, setting),
                                  [&](const skeleton::CarriedPoint& at, fem::PointTerms terms) {
                                      Vec3 x = at.x();
                                      if (!in_large_rotation(setting)) {
                                          // As at rest, to first order.
                                          Vec3 moved = Vec3::Zero();
                                          for (int i = 0; i < at.shares(); ++i)
                                              moved += at.jacobian(i) * q.segment<6>(Eigen::Index{6} * at.sphere(i));
                                          x += moved;
                                          terms.gradient += terms.hessian * moved;
                                      }
                                      visit(at, x, terms);
                                  });
}

std::vector<mesh::ToolMotion> SkeletonBody::motions(const Eigen::VectorXd& q, const ModelSetting& setting,
                                                    const Action& action) const {
    return posed(*this, q, setting, action).motions;
}

Eigen::VectorXd SkeletonBody::reactions(const Eigen::VectorXd& q, const ModelSetting& setting,
                                        const Action& action) const {
    if (has_free_coordinates(action)) return reactions(q, setting, posed(*this, q, setting, action));
    Eigen::VectorXd result = Eigen::VectorXd::Zero(6 * std::ssize(action.motions));
    for (std::size_t t = 0; t < action.motions.size(); ++t) {
        const Vec3 origin = impl_->rig.tool(action.motions[t], 1)->origin();
        impl_->for_each_point_of(action.motions[t], q, setting,
                                 [&](const skeleton::CarriedPoint&, const Vec3& x, const fem::PointTerms& terms) {
                                     result.segment<6>(static_cast<Eigen::Index>(6 * t)) +=
                                         fem::PointOnTool(terms, x - origin).wrench;
                                 });
    }
    return result;
}

ReactionSlopes SkeletonBody::reaction_slopes(const Eigen::VectorXd& q, const ModelSetting& setting,
                                             const Action& action) const {
    if (has_free_coordinates(action)) return reaction_slopes_with_free_tools(*this, q, setting, action);
    const Eigen::Index rows = 6 * std::ssize(action.motions), parameters = std::ssize(impl_->parameters);
    ReactionSlopes slopes{Eigen::MatrixXd::Zero(rows, dofs()), {}, Eigen::MatrixXd::Zero(rows, rows)};
    for (std::size_t t = 0; t < action.motions.size(); ++t) {
        const Vec3 origin = impl_->rig.tool(action.motions[t], 1)->origin();
        const auto row = static_cast<Eigen::Index>(6 * t);
        impl_->for_each_point_of(action.motions[t], q, setting,
                                 [&](const skeleton::CarriedPoint& at, const Vec3& x, const fem::PointTerms& terms) {
                                     const fem::PointOnTool part(terms, x - origin);
                                     slopes.by_pose.block<6, 6>(row, row) += part.wrench_by_pose;
                                     for (int i = 0; i < at.shares(); ++i)
                                         slopes.by_step.block<6, 6>(row, Eigen::Index{6} * at.sphere(i)) +=
                                             part.by_pose.transpose() * at.jacobian(i);
                                 });
    }
    // Young's modulus goes with the mean of all logarithms.
    slopes.by_parameter =
        reactions(q, setting, action) * Eigen::RowVectorXd::Constant(parameters, 1 / static_cast<double>(parameters));
    return slopes;
}

Eigen::MatrixXd SkeletonBody::actuation_force(const Eigen::VectorXd& q, const ModelSetting& setting,
                                              const Action& action) const {
    const skeleton::Model& model = impl_->model(setting);
    const skeleton::State state = impl_->tangent_state(q, setting);
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(dofs(), std::ssize(action.settings));
    for (std::size_t a = 0; a < action.settings.size(); ++a) {
        const mesh::ActuatorSetting& own = action.settings[a];
        Eigen::VectorXd column = Eigen::VectorXd::Zero(dofs());
        if (const auto& cavity = impl_->rig.cavity(own.actuator)) {
            skeleton::Cavities(model, *cavity).add_gradient(state, 1, column);
        } else {
            const skeleton::PlacedTendon tendon(
                model, impl_->rig.tendon(own, young(setting), setting.effects.tendon_friction));
            tendon.add(state, tendon.terms(state).by_value, -1, column);
        }
        result.col(static_cast<Eigen::Index>(a)) = column;
    }
    return result;
}

}  // namespace palpate::identify
