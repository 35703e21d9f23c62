#pragma once

#include <map>
#include <mutex>
#include <tuple>

#include "fem/interpolation/interpolation.h"
#include "fem/interpolation/refine.h"
#include "fem/large_deformation/lazy.h"
#include "fem/large_deformation/material_law_names.h"
#include "identify/models/marker_frames.h"
#include "identify/models/reference/reference_body.h"
#include "identify/models/reference/reference_material.h"
#include "identify/models/tendon_friction.h"

namespace palpate::identify {

class FemTangent : public Tangent {
public:
    explicit FemTangent(std::shared_ptr<const fem::BodyTangent> factor) : factor_(std::move(factor)) {}
    Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const override { return factor_->solve(B); }
    double gigabytes() const override { return factor_->gigabytes(); }
    const fem::BodyTangent& factor() const { return *factor_; }

private:
    std::shared_ptr<const fem::BodyTangent> factor_;
};

inline bool in_small_strain(const ModelSetting& setting) {
    return static_cast<fem::MaterialLaw>(setting.law) == fem::MaterialLaw::linear;
}

class FemMemory : public Memory {
public:
    explicit FemMemory(std::shared_ptr<const fem::MaterialState> the_state) : state(std::move(the_state)) {}
    std::shared_ptr<const fem::MaterialState> state;
};

inline const fem::MaterialState* memory_of(const Action& action) {
    const auto* own = dynamic_cast<const FemMemory*>(action.memory.get());
    return own ? own->state.get() : nullptr;
}

/// What ReferenceBody is made of, for its own sources alone.
struct ReferenceBody::Impl {
    Impl(const mesh::VolumeMesh& mesh, const std::vector<mesh::Region>& the_supports,
         const std::vector<Marker>& the_markers, const ReferenceBodyOptions& the_options)
        : supports(the_supports),
          markers(the_markers),
          options(the_options),
          regions(element_regions(mesh, options.regions, options.density)),
          body(mesh, mesh::contains(supports, mesh.nodes), options.dilatation, regions, options.solver),
          frames(mesh, markers),
          rig(options.rig),
          density(options.density) {
        geometry.size = (mesh.nodes.colwise().maxCoeff() - mesh.nodes.colwise().minCoeff()).maxCoeff();
    }

    std::vector<mesh::Region> supports;
    std::vector<Marker> markers;
    ReferenceBodyOptions options;

    fem::ElementRegions regions;
    fem::HyperelasticBody body;
    MarkerFrames frames;
    PreparedRig rig;
    double density;
    BodyGeometry geometry;
    std::vector<std::string> laws = fem::material_law_choices();
    std::vector<StiffnessParameter> parameters;
    std::vector<int> skin_nodes, material_nodes;  // of BodyGeometry's points

    /// The body on a finer mesh.
    struct Finer;
    fem::Lazy<Finer> finer;
    /// The same on meshes that are finer under tools, each with its last equilibrium of each action, by motions.
    struct FinerUnderTools;
    mutable std::map<const mesh::VolumeMesh*, std::shared_ptr<FinerUnderTools>> finer_under_tools;
    std::shared_ptr<FinerUnderTools> finer_for(const Action& action) const;

    // A contact's nodal forces per newton do not depend on the configuration: each is made once.
    using Place = std::tuple<double, double, double, double>;
    mutable std::mutex mutex;
    mutable std::map<Place, Eigen::VectorXd> shares;  // (n)

    std::vector<fem::Material> region_materials(const ModelSetting& s, const fem::Material& material) const {
        std::vector<fem::Material> result;
        for (std::size_t r = 0; r < options.regions.size(); ++r)
            result.push_back(
                region_material(options.regions[r], s.theta[first_region + static_cast<Eigen::Index>(r)], material));
        return result;
    }
    fem::BodySetting setting(const ModelSetting& s, const fem::Material& material, const Action& action) const {
        fem::BodySetting result{static_cast<fem::MaterialLaw>(s.law), material, s.effects,
                                region_materials(s, material)};
        result.effects.pressure += action.pressure;
        rig.add(action, material.young, result.effects);
        return result;
    }
    fem::BodySetting setting(const ModelSetting& s, const Action& action) const {
        return setting(s, body_material(s, density), action);
    }
    /// Of the tendons that rub.
    fem::TendonSliding sliding(const Eigen::VectorXd& q, const fem::BodySetting& own) const {
        std::vector<fem::TendonSliding> each;
        for (const fem::TendonPull& pull : own.effects.tendons)
            if (pull.coefficient != 0)
                each.push_back(body.tendon_sliding(q, pull, own.law == fem::MaterialLaw::linear));
        return together(each, q.size());
    }
    /// Nodal shares of a contact (n), which add up to 1.
    Eigen::VectorXd shares_of(const mesh::Contact& contact) const;
    Eigen::VectorXd load(const Action& action) const;
};

struct ReferenceBody::Impl::Finer {
    Finer(const Impl& coarse, const fem::RefinedMesh& refined) : interpolation(refined.interpolation) {
        ReferenceBodyOptions own_options = coarse.options;
        own_options.finer.reset();
        own_options.finer_under_tools = {};
        own = std::make_unique<Impl>(refined.mesh, coarse.supports, coarse.markers, own_options);
    }

    std::unique_ptr<const Impl> own;
    Eigen::SparseMatrix<double, Eigen::RowMajor> interpolation;
};

struct ReferenceBody::Impl::FinerUnderTools {
    std::shared_ptr<const mesh::VolumeMesh> mesh;
    Finer body;
    std::mutex mutex;
    std::map<std::vector<double>, Eigen::VectorXd> last;  // equilibria, by the action's motions

    FinerUnderTools(const Impl& coarse, std::shared_ptr<const mesh::VolumeMesh> its_mesh)
        : mesh(std::move(its_mesh)), body(coarse, {*mesh, fem::interpolation(coarse.body.mesh(), mesh->nodes)}) {}

    /// What the coarse equilibrium comes to.
    Eigen::VectorXd interpolated(const Eigen::VectorXd& coarse) const {
        const Points u = body.interpolation * Eigen::Map<const Points>(coarse.data(), coarse.size() / 3, 3);
        return Eigen::Map<const Eigen::VectorXd>(u.data(), u.size());
    }
    std::optional<Eigen::VectorXd> last_equilibrium(const std::vector<double>& motions) {
        const std::scoped_lock lock(mutex);
        const auto found = last.find(motions);
        return found == last.end() ? std::nullopt : std::optional(found->second);
    }
    void keep(const std::vector<double>& motions, const Eigen::VectorXd& u) {
        const std::scoped_lock lock(mutex);
        last[motions] = u;
    }
};

}  // namespace palpate::identify
