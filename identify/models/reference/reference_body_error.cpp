#include <algorithm>
#include <cmath>
#include <iterator>

#include "fem/large_deformation/refined_equilibrium.h"
#include "identify/models/free_tools.h"
#include "identify/models/reference/reference_body_impl.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

/// Of the displacement: a finer mesh that moves the body by more stands in another of its equilibria. Where it did not,
/// the mesh would be too coarse to correct for.
constexpr double another_equilibrium = 0.5;

bool stands_elsewhere(const Eigen::VectorXd& u, const Eigen::VectorXd& coarse) {
    return (u - coarse).norm() > another_equilibrium * coarse.norm();
}

// From there alone: a path from rest may lead to another equilibrium.
constexpr fem::NewtonOptions from_the_start{.tolerance = 1e-6, .load_steps = 0};

/// The equilibrium that a configuration out of balance relaxes to: forces that hold it there are taken away in parts.
/// @throws SolverFailure where it slips off.
Eigen::VectorXd relaxed(const fem::HyperelasticBody& body, const fem::BodySetting& setting, const Eigen::VectorXd& load,
                        Eigen::VectorXd u) {
    Eigen::VectorXd holding = -body.residual(u, setting, load);
    for (std::size_t n = 0; n < body.held().size(); ++n)
        if (body.held()[n]) holding.segment<3>(static_cast<Eigen::Index>(3 * n)).setZero();
    constexpr double first = 0.25, least = 1.0 / 64;  // parts of the forces: beyond, it is at the end of its branch
    for (double share = 1, part = first; share > 0;) {
        const double next = std::max(share - part, 0.0);
        try {
            u = body.equilibrium(setting, load + next * holding, from_the_start, &u).u;
            share = next;
            part *= 2;
        } catch (const SolverFailure&) {
            part /= 2;
            if (part < least) throw;
        }
    }
    return u;
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
    const Eigen::VectorXd& start = last ? *last : coarse;
    std::optional<Eigen::VectorXd> at_once;
    try {
        at_once = own.body.equilibrium(loading, load, from_the_start, &start).u;
    } catch (const SolverFailure&) {  // too far from there
    }
    const Eigen::VectorXd u =
        at_once && !stands_elsewhere(*at_once, coarse) ? *at_once : relaxed(own.body, loading, load, coarse);
    if (stands_elsewhere(u, coarse))
        throw SolverFailure("A finer mesh knows no equilibrium under the tool next to that of this one.");
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
