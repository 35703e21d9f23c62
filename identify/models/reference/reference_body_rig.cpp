#include "identify/models/reference/reference_body_impl.h"

#include "identify/models/free_tools.h"

namespace palpate::identify {

Eigen::MatrixXd ReferenceBody::tangent_times(const Eigen::VectorXd& q, const ModelSetting& setting,
                                             const Action& action, const Eigen::MatrixXd& steps) const {
    if (has_free_coordinates(action)) return tangent_times_with_free_tools(*this, q, setting, action, steps);
    const fem::BodySetting own = impl_->setting(setting, action);
    const fem::TendonSliding sliding = impl_->sliding(q, own);
    return impl_->body.tangent(q, own, memory_of(action)) * steps +
           sliding.by_number * (sliding.number_by_point * steps);
}

std::vector<mesh::ToolMotion> ReferenceBody::motions(const Eigen::VectorXd& q, const ModelSetting& setting,
                                                     const Action& action) const {
    return posed(*this, q, setting, action).motions;
}

Eigen::VectorXd ReferenceBody::reactions(const Eigen::VectorXd& q, const ModelSetting& setting,
                                         const Action& action) const {
    if (has_free_coordinates(action)) return reactions(q, setting, posed(*this, q, setting, action));
    Eigen::VectorXd result(6 * std::ssize(action.motions));
    for (std::size_t t = 0; t < action.motions.size(); ++t)
        result.segment<6>(static_cast<Eigen::Index>(6 * t)) =
            impl_->body.wrench(q, impl_->rig.tool(action.motions[t], young(setting)));
    return result;
}

ReactionSlopes ReferenceBody::reaction_slopes(const Eigen::VectorXd& q, const ModelSetting& setting,
                                              const Action& action) const {
    if (has_free_coordinates(action)) return reaction_slopes_with_free_tools(*this, q, setting, action);
    const Eigen::Index rows = 6 * std::ssize(action.motions);
    ReactionSlopes slopes{Eigen::MatrixXd(rows, dofs()), Eigen::MatrixXd::Zero(rows, std::ssize(parameters())),
                          Eigen::MatrixXd::Zero(rows, rows)};
    for (std::size_t t = 0; t < action.motions.size(); ++t) {
        const auto tool = impl_->rig.tool(action.motions[t], young(setting));
        const auto row = static_cast<Eigen::Index>(6 * t);
        slopes.by_step.middleRows<6>(row) = impl_->body.wrench_derivative(q, tool).transpose();
        slopes.by_pose.block<6, 6>(row, row) = impl_->body.wrench_by_pose(q, tool);
    }
    slopes.by_parameter.col(ln_young) = reactions(q, setting, action);
    return slopes;
}

Eigen::MatrixXd ReferenceBody::actuation_force(const Eigen::VectorXd& q, const ModelSetting& setting,
                                               const Action& action) const {
    const bool small_strain = in_small_strain(setting);
    Eigen::MatrixXd result(dofs(), std::ssize(action.settings));
    for (std::size_t a = 0; a < action.settings.size(); ++a) {
        const mesh::ActuatorSetting& own = action.settings[a];
        auto column = result.col(static_cast<Eigen::Index>(a));
        if (const auto& cavity = impl_->rig.cavity(own.actuator)) {
            column = impl_->body.cavity_push(q, *cavity, small_strain);
        } else {
            column = impl_->body.tendon_push(q, impl_->rig.tendon(own, young(setting), setting.effects.tendon_friction),
                                             small_strain);
        }
    }
    return result;
}

}  // namespace palpate::identify
