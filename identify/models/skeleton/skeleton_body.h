#pragma once

#include "identify/inference/priors/informative_prior.h"
#include "identify/measurements/measurement_set.h"
#include "identify/models/body_model.h"
#include "identify/models/rig.h"
#include "skeleton/model/model.h"
#include "skeleton/statics/equilibrium.h"

namespace palpate::identify {

/// The skeleton as a model: laws linear and large-rotation; a parameter for each kind of stiffness, the logarithm of a
/// multiplier on all links. Effects come with the setting, not from the model.
///
/// A configuration by the linear law is a step from rest (6N); by the other the centres (N x 3), then the rotations
/// (9 numbers each).
class SkeletonBody : public BodyModel {
public:
    /// `young`: of the body that the skeleton stands for, as it comes [MPa]; for how deep a contact may dent.
    /// `rig`: what may touch it, and act within it. `prior_sd`: of each parameter, but for
    /// those that other specimens tell of.
    SkeletonBody(const skeleton::Model& model, const std::vector<Marker>& markers, double young, const Rig& rig = {},
                 double prior_sd = 3, const std::vector<InformativePrior>& priors = {});
    ~SkeletonBody() override;

    int dofs() const override;
    const std::vector<std::string>& laws() const override;
    const std::vector<StiffnessParameter>& parameters() const override;
    const BodyGeometry& geometry() const override;
    double young(const ModelSetting& setting) const override;
    bool is_nonlinear(const ModelSetting& setting) const override;
    Eigen::VectorXd rest(const ModelSetting& setting) const override;
    Eigen::VectorXd equilibrium(const ModelSetting& setting, const Action& action,
                                const Eigen::VectorXd* start = nullptr, const Tangent* guide = nullptr) const override;
    Eigen::VectorXd residual(const Eigen::VectorXd& q, const ModelSetting& setting,
                             const Action& action) const override;
    std::shared_ptr<const Tangent> tangent(const Eigen::VectorXd& q, const ModelSetting& setting,
                                           const Action& action) const override;
    Eigen::MatrixXd parameter_force(const Eigen::VectorXd& q, const ModelSetting& setting,
                                    const Action& action) const override;
    Points observe(const Eigen::VectorXd& q, const ModelSetting& setting) const override;
    Eigen::SparseMatrix<double> observation(const Eigen::VectorXd& q, const ModelSetting& setting) const override;
    Eigen::VectorXd advance(const Eigen::VectorXd& q, const Eigen::VectorXd& step,
                            const ModelSetting& setting) const override;
    std::shared_ptr<const Memory> remember(const Eigen::VectorXd& q, const ModelSetting& setting,
                                           const Action& action) const override;
    Eigen::VectorXd contact_force(const Eigen::VectorXd& q, const ModelSetting& setting,
                                  const mesh::Contact& contact) const override;
    Eigen::MatrixXd piece_force(const Eigen::VectorXd& q, const ModelSetting& setting, const Action& action,
                                const Eigen::MatrixXd& W) const override;
    Points skin_positions(const Eigen::VectorXd& q, const ModelSetting& setting) const override;
    Eigen::SparseMatrix<double> skin_motion(const Eigen::VectorXd& q, const ModelSetting& setting) const override;
    Eigen::SparseMatrix<double> material_motion() const override;
    Eigen::MatrixXd support_motion(const Vec3& centre) const override;
    std::vector<mesh::ToolMotion> motions(const Eigen::VectorXd& q, const ModelSetting& setting,
                                          const Action& action) const override;
    Eigen::VectorXd reactions(const Eigen::VectorXd& q, const ModelSetting& setting,
                              const Action& action) const override;
    ReactionSlopes reaction_slopes(const Eigen::VectorXd& q, const ModelSetting& setting,
                                   const Action& action) const override;
    Eigen::MatrixXd actuation_force(const Eigen::VectorXd& q, const ModelSetting& setting,
                                    const Action& action) const override;
    Eigen::MatrixXd tangent_times(const Eigen::VectorXd& q, const ModelSetting& setting, const Action& action,
                                  const Eigen::MatrixXd& steps) const override;

    /// A configuration as the statics know it.
    skeleton::Equilibrium equilibrium_at(const Eigen::VectorXd& q, const ModelSetting& setting) const;

    /// Stiffnesses of a setting, as skeleton::StiffnessOrder says.
    Eigen::VectorXd stiffness(const ModelSetting& setting) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::identify
