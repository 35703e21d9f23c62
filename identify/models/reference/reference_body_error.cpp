#include <algorithm>
#include <cmath>
#include <iterator>

#include "fem/large_deformation/refined_equilibrium.h"
#include "identify/models/free_tools.h"
#include "identify/models/reference/reference_body_impl.h"

namespace palpate::identify {
namespace {

/// Is this another equilibrium than that on the coarse mesh? A finer mesh alters how far a body moves, even by several
/// times where few elements meet a tool, and hardly how: less than a tenth of the motion is not in proportion. In
/// another equilibrium more than half of it is not; measured under balls on bars, plates and a slender body, see
/// tests/bench/diagnosis/RESULTS.md.
bool stands_elsewhere(const Eigen::VectorXd& u, const Eigen::VectorXd& coarse) {
    constexpr double out_of_proportion = 0.3;
    if (coarse.norm() == 0) return false;
    const Eigen::VectorXd along = u.dot(coarse) / coarse.squaredNorm() * coarse;
    return u.dot(coarse) <= 0 || (u - along).norm() > out_of_proportion * u.norm();
}

}  // namespace

std::shared_ptr<ReferenceBody::Impl::FinerUnderTools> ReferenceBody::Impl::finer_for(const Action& action) const {
    if (!options.finer_under_tools) return nullptr;
    const std::shared_ptr<const mesh::VolumeMesh> mesh = options.finer_under_tools(action.motions).mesh;
    if (!mesh) return nullptr;
    const std::scoped_lock lock(mutex);
    std::shared_ptr<FinerUnderTools>& own = finer_under_tools[mesh.get()];
    if (!own) own = std::make_shared<FinerUnderTools>(*this, mesh);
    return own;
}

std::optional<MeshError> ReferenceBody::discretisation_error(const Eigen::VectorXd& q, const ModelSetting& setting,
                                                             const Action& action, const Tangent& J) const {
    if (impl_->options.measured_on_mesh || action.memory || has_free_coordinates(action)) return std::nullopt;
    // A finer mesh meets a tool that may part elsewhere, which few steps from here do not follow.
    const bool holds = std::ranges::all_of(action.motions, [&](const mesh::ToolMotion& motion) {
        return impl_->rig.tool(motion, young(setting))->is_grip();
    });
    if (!holds) return error_under_tools(q, setting, action);
    const Impl::Finer& finer = impl_->finer.get([&] {
        const mesh::VolumeMesh& coarse = impl_->body.mesh();
        const std::optional<mesh::VolumeMesh>& given = impl_->options.finer;
        if (!given) return Impl::Finer(*impl_, fem::refine(coarse));
        return Impl::Finer(*impl_, {*given, fem::interpolation(coarse, given->nodes)});
    });
    const bool small_strain = in_small_strain(setting);
    // A cable that holds its length pulls by what each step stretches it, and where it is fixed gives way ever more in
    // finer meshes: it is let go, under the tension that it has.
    fem::BodySetting own = impl_->setting(setting, action);
    bool lets_go = false;
    for (fem::TendonPull& pull : own.effects.tendons) {
        if (!pull.actuator->by_length) continue;
        lets_go = true;
        pull.friction = impl_->body.tendon_friction(q, pull, small_strain);
        pull.value = impl_->body.tendon_state(q, pull, small_strain).tension;
        pull.actuator = impl_->rig.by_tension(pull);
    }
    std::shared_ptr<const fem::BodyTangent> let_go;
    if (lets_go) let_go = impl_->body.factor(q, own, memory_of(action));
    const auto& factor = lets_go ? *let_go : dynamic_cast<const FemTangent&>(with_friction_held(J)).factor();
    const std::optional<Eigen::VectorXd> u =
        fem::refined_equilibrium({finer.own->body, finer.interpolation}, q, factor, own, finer.own->load(action));
    if (!u) return std::nullopt;
    return difference(q, finer.own->frames.positions(*u, small_strain), finer.own->body, *u, setting, action);
}

std::optional<MeshError> ReferenceBody::error_under_tools(const Eigen::VectorXd& q, const ModelSetting& setting,
                                                          const Action& action) const {
    const std::shared_ptr<Impl::FinerUnderTools> finer = impl_->finer_for(action);
    if (!finer) return std::nullopt;
    const Impl& own = *finer->body.own;
    std::vector<double> motions;
    for (const mesh::ToolMotion& motion : action.motions) {
        motions.push_back(motion.tool);
        std::ranges::copy(motion.translation, std::back_inserter(motions));
        std::ranges::copy(motion.rotation, std::back_inserter(motions));
    }
    const fem::BodySetting loading = own.setting(setting, action);
    const Eigen::VectorXd load = own.load(action), coarse = finer->interpolated(q);
    const auto last = finer->last_equilibrium(motions);
    const Eigen::VectorXd& start = last && !stands_elsewhere(*last, coarse) ? *last : coarse;
    const Eigen::VectorXd u = own.body.equilibrium(loading, load, {.tolerance = 1e-6}, &start).u;
    if (stands_elsewhere(u, coarse)) return std::nullopt;
    finer->keep(motions, u);
    return difference(q, own.frames.positions(u, in_small_strain(setting)), own.body, u, setting, action);
}

std::optional<double> ReferenceBody::remaining_mesh_error(const Action& action) const {
    if (action.motions.empty() || !impl_->options.finer_under_tools) return std::nullopt;
    const FinerMesh finer = impl_->options.finer_under_tools(action.motions);
    if (!finer.mesh) return std::nullopt;
    // Contact limits what quadratic elements gain: their error falls with the edges to the power 3/2 [Hild, Laborde,
    // Quadratic finite element methods for unilateral contact problems, Appl. Numer. Math. 41, 2002]. What is taken off
    // is the difference between a fit's e and the finer mesh's e / times^(3/2), which is left.
    return 1 / (std::pow(finer.times, 1.5) - 1);
}

MeshError ReferenceBody::difference(const Eigen::VectorXd& q, const Points& markers, const fem::HyperelasticBody& finer,
                                    const Eigen::VectorXd& u, const ModelSetting& setting, const Action& action) const {
    MeshError error{markers - observe(q, setting), -reactions(q, setting, action)};
    for (std::size_t t = 0; t < action.motions.size(); ++t)
        error.reactions.segment<6>(static_cast<Eigen::Index>(6 * t)) +=
            finer.wrench(u, impl_->rig.tool(action.motions[t], young(setting)));
    return error;
}

}  // namespace palpate::identify
