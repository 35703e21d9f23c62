#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "fem/hyperelastic_body.h"
#include "identify/inference/priors/informative_prior.h"
#include "identify/measurements/measurement_set.h"
#include "identify/models/body_model.h"
#include "identify/models/rig.h"
#include "mesh/core/material_region.h"

namespace palpate::identify {

/// Quadratic tetrahedra of a body, finer in a part of it.
struct FinerMesh {
    std::shared_ptr<const mesh::VolumeMesh> mesh;  // null: there is none
    double times = 1;                              // as short edges there
};

struct ReferenceBodyOptions {
    double density = 1e-9;               // [tonne/mm^3]
    std::optional<double> young = {};    // a first guess [MPa]
    std::optional<double> poisson = {};  // as it is told, not to be fitted; absent: it is
    fem::Dilatation dilatation = fem::Dilatation::mean;
    fem::Solver solver = fem::Solver::automatic;  // of tangents
    bool measured_on_mesh = false;                // what is measured was computed on this very mesh, and has its errors
    /// Quadratic tetrahedra of the same body that tell the error of the others; absent: those with halved edges.
    std::optional<mesh::VolumeMesh> finer = {};
    /// The same where tools that may part touch it in an action: one that is finer there; absent: none tells.
    std::function<FinerMesh(const std::vector<mesh::ToolMotion>&)> finer_under_tools = {};
    Rig rig = {};                                    // what may touch the body, and act within it
    std::vector<mesh::MaterialRegion> regions = {};  // whose surfaces the elements follow
    std::vector<InformativePrior> priors = {};       // of "young" and "compressibility", from other specimens
};

/// The name of the parameter ln E of a region.
std::string region_parameter(const std::string& region);
/// The region whose parameter has that name; none: it is no region's.
std::optional<std::string> region_of_parameter(const std::string& parameter);

/// The body of finite elements as a model: laws linear, svk, neo-hooke; parameters ln E and ln(1 - 2 nu) of the body,
/// and ln E of each region (region_parameter), of which one that is known is not fitted. A region without a ratio of
/// its own has the body's.
///
/// Without the physics that it lacks it has next to no error of its own, so what it cannot explain is physics.
/// A configuration is the displacement of the nodes (3n), and so is a step.
class ReferenceBody : public BodyModel {
public:
    /// `mesh`: quadratic tetrahedra. @throws InvalidInput where the supports hold too little of it.
    ReferenceBody(const mesh::VolumeMesh& mesh, const std::vector<mesh::Region>& supports,
                  const std::vector<Marker>& markers, const ReferenceBodyOptions& options = {});
    ~ReferenceBody() override;

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
    std::optional<MeshError> discretisation_error(const Eigen::VectorXd& q, const ModelSetting& setting,
                                                  const Action& action, const Tangent& J) const override;
    std::optional<double> remaining_mesh_error(const Action& action) const override;
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

    const fem::HyperelasticBody& body() const;
    /// Young's modulus and Poisson's ratio of a setting.
    fem::Material material(const ModelSetting& setting) const;
    /// What each region is made of.
    std::vector<fem::Material> region_materials(const ModelSetting& setting) const;
    /// The region of each element, -1: it is of none; empty: there are no regions.
    const std::vector<int>& region_of_element() const;

private:
    struct Impl;
    /// The same where tools touch that hold no material.
    std::optional<MeshError> error_under_tools(const Eigen::VectorXd& q, const ModelSetting& setting,
                                               const Action& action) const;
    /// Between an equilibrium on a finer mesh, where markers stand at `markers`, and one here.
    MeshError difference(const Eigen::VectorXd& q, const Points& markers, const fem::HyperelasticBody& finer,
                         const Eigen::VectorXd& u, const ModelSetting& setting, const Action& action) const;

    std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::identify
