#include "identify/models/reference_body.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <mutex>
#include <tuple>

#include "fem/elements/patch_load.h"
#include "fem/interpolation/interpolation.h"
#include "fem/interpolation/refine.h"
#include "fem/large_deformation/lazy.h"
#include "fem/large_deformation/refined_equilibrium.h"
#include "identify/models/free_tools.h"
#include "identify/models/marker_frames.h"
#include "identify/models/tendon_friction.h"
#include "mesh/errors.h"
#include "mesh/regions/element_regions.h"
#include "skeleton/model/state.h"

namespace palpate::identify {
namespace {

constexpr int ln_young = 0, ln_compressibility = 1, first_region = 2;  // places in theta
constexpr const char* of_region = "young:";                            // begins the name of a region's parameter

/// ln(1 - 2 nu) may be tried where no material is.
void require_material(const fem::Material& material) {
    constexpr double least = -0.9, most = 0.49999;
    if (material.poisson > least && material.poisson < most && std::isfinite(material.young)) return;
    throw SolverFailure(
        fmt::format("the fit asks for a Poisson's ratio of {:.3g} and a Young's modulus of {:.3g} MPa; "
                    "allowed are ratios from {} to {}",
                    material.poisson, material.young, least, most));
}

fem::Material material_of(const ModelSetting& setting, double density) {
    // theta = (ln E, ln(1 - 2 nu))
    return {.young = std::exp(setting.theta[ln_young]),
            .poisson = 0.5 * (1 - std::exp(setting.theta[ln_compressibility])),
            .density = density};
}

/// What a region is made of.
fem::Material material_of(const mesh::MaterialRegion& region, double log_young, const fem::Material& body) {
    fem::Material material = body;
    material.young = std::exp(log_young);
    if (region.poisson) material.poisson = *region.poisson;
    if (region.density) material.density = *region.density;
    return material;
}

/// How the internal forces of a material grow with ln E and with ln(1 - 2 nu); `unit`: those at unit moduli (3n x 2).
/// f = mu a + K b with mu = E / (2 (1 + nu)), K = E / (3 (1 - 2 nu)); t = ln(1 - 2 nu): d nu/dt = -(1 - 2 nu)/2,
/// so d mu/dt = mu (1 - 2 nu) / (2 (1 + nu)) and dK/dt = -K.
Eigen::Matrix<double, Eigen::Dynamic, 2> slopes_of(const fem::Material& m, const Eigen::MatrixXd& unit) {
    const double mu = m.shear_modulus(), K = m.bulk_modulus();
    Eigen::Matrix<double, Eigen::Dynamic, 2> slopes(unit.rows(), 2);
    slopes.col(0) = mu * unit.col(0) + K * unit.col(1);
    slopes.col(1) = mu * (1 - 2 * m.poisson) / (2 * (1 + m.poisson)) * unit.col(0) - K * unit.col(1);
    return slopes;
}

/// The elements of each region. @throws InvalidInput where there are next to none.
fem::ElementRegions element_regions(const mesh::VolumeMesh& mesh, const ReferenceBodyOptions& options) {
    constexpr int least = 4;  // fewer do not show how a part bends
    fem::ElementRegions result;
    if (options.regions.empty()) return result;
    std::vector<mesh::Surface> surfaces;
    for (const mesh::MaterialRegion& region : options.regions) surfaces.push_back(region.surface);
    result.of_element = mesh::regions_of_elements(mesh, surfaces);
    for (std::size_t r = 0; r < surfaces.size(); ++r) {
        const mesh::MaterialRegion& region = options.regions[r];
        result.density.push_back(region.density && options.density > 0 ? *region.density / options.density : 1);
        const auto own = std::ranges::count(result.of_element, static_cast<int>(r));
        if (own < least)
            throw InvalidInput(fmt::format(
                "region '{}' has {} of the mesh's elements; at least {} are needed. Take the region out, or "
                "give a mesh that is finer there, or the surface alone, which is meshed along the region.",
                region.name, own, least));
    }
    return result;
}

class FemTangent : public Tangent {
public:
    explicit FemTangent(std::shared_ptr<const fem::BodyTangent> factor) : factor_(std::move(factor)) {}
    Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const override { return factor_->solve(B); }
    double gigabytes() const override { return factor_->gigabytes(); }
    const fem::BodyTangent& factor() const { return *factor_; }

private:
    std::shared_ptr<const fem::BodyTangent> factor_;
};

bool in_small_strain(const ModelSetting& setting) {
    return static_cast<fem::MaterialLaw>(setting.law) == fem::MaterialLaw::linear;
}

class FemMemory : public Memory {
public:
    explicit FemMemory(std::shared_ptr<const fem::MaterialState> the_state) : state(std::move(the_state)) {}
    std::shared_ptr<const fem::MaterialState> state;
};

const fem::MaterialState* memory_of(const Action& action) {
    const auto* own = dynamic_cast<const FemMemory*>(action.memory.get());
    return own ? own->state.get() : nullptr;
}

Points centres_of(const mesh::VolumeMesh& mesh) {
    Points centres(mesh.tetrahedra.rows(), 3);
    for (Eigen::Index e = 0; e < centres.rows(); ++e) {
        centres.row(e).setZero();
        for (int c = 0; c < 4; ++c) centres.row(e) += 0.25 * mesh.nodes.row(mesh.tetrahedra(e, c));
    }
    return centres;
}

/// The displacements of some nodes out of those of all (3 nodes x dofs).
Eigen::SparseMatrix<double> selection_of(const std::vector<int>& nodes, int dofs) {
    std::vector<Eigen::Triplet<double>> ones;
    ones.reserve(3 * nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        for (int c = 0; c < 3; ++c) ones.emplace_back(3 * static_cast<int>(i) + c, 3 * nodes[i] + c, 1.0);
    }
    Eigen::SparseMatrix<double> result(std::ssize(ones), dofs);
    result.setFromTriplets(ones.begin(), ones.end());
    return result;
}

/// Elements of which some nodes are held and some are not.
std::vector<char> cut_by_support(const mesh::VolumeMesh& mesh, const std::vector<char>& held) {
    std::vector<char> cut(mesh.tetrahedra.rows(), 0);
    for (std::size_t e = 0; e < cut.size(); ++e) {
        int count = 0;
        for (const int node : mesh.tetrahedra.row(static_cast<Eigen::Index>(e))) count += held[node] ? 1 : 0;
        cut[e] = count > 0 && count < mesh.tetrahedra.cols();
    }
    return cut;
}

}  // namespace

struct ReferenceBody::Impl {
    Impl(const mesh::VolumeMesh& mesh, const std::vector<mesh::Region>& the_supports,
         const std::vector<Marker>& the_markers, const ReferenceBodyOptions& the_options)
        : supports(the_supports),
          markers(the_markers),
          options(the_options),
          regions(element_regions(mesh, options)),
          body(mesh, mesh::contains(supports, mesh.nodes), options.dilatation, regions),
          frames(mesh, markers),
          rig(options.rig),
          density(options.density),
          size((mesh.nodes.colwise().maxCoeff() - mesh.nodes.colwise().minCoeff()).maxCoeff()) {}

    std::vector<mesh::Region> supports;
    std::vector<Marker> markers;
    ReferenceBodyOptions options;

    fem::ElementRegions regions;
    fem::HyperelasticBody body;
    MarkerFrames frames;
    PreparedRig rig;
    double density, size;
    std::vector<std::string> laws{"linear", "svk", "neo-hooke"};
    std::vector<StiffnessParameter> parameters;
    mesh::Surface surface;  // by the faces' corners
    Points centres, support_points;
    std::vector<char> cut;
    Eigen::VectorXd support_shares;
    std::vector<int> skin_nodes;
    Points skin;
    Eigen::VectorXd skin_areas;
    std::vector<int> material_nodes;
    Points material_points;
    Eigen::VectorXd material_shares;

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
                material_of(options.regions[r], s.theta[first_region + static_cast<Eigen::Index>(r)], material));
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
        return setting(s, material_of(s, density), action);
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

    /// Where a known equilibrium of the same motions stands, else what the coarse one comes to.
    Eigen::VectorXd start(const std::vector<double>& motions, const Eigen::VectorXd& coarse) {
        const std::scoped_lock lock(mutex);
        if (const auto found = last.find(motions); found != last.end()) return found->second;
        const Points u = body.interpolation * Eigen::Map<const Points>(coarse.data(), coarse.size() / 3, 3);
        return Eigen::Map<const Eigen::VectorXd>(u.data(), u.size());
    }
    void keep(const std::vector<double>& motions, const Eigen::VectorXd& u) {
        const std::scoped_lock lock(mutex);
        last[motions] = u;
    }
};

std::shared_ptr<ReferenceBody::Impl::FinerUnderTools> ReferenceBody::Impl::finer_for(const Action& action) const {
    if (!options.finer_under_tools) return nullptr;
    const std::shared_ptr<const mesh::VolumeMesh> mesh = options.finer_under_tools(action.motions).mesh;
    if (!mesh) return nullptr;
    const std::scoped_lock lock(mutex);
    std::shared_ptr<FinerUnderTools>& own = finer_under_tools[mesh.get()];
    if (!own) own = std::make_shared<FinerUnderTools>(*this, mesh);
    return own;
}

ReferenceBody::ReferenceBody(const mesh::VolumeMesh& mesh, const std::vector<mesh::Region>& supports,
                             const std::vector<Marker>& markers, const ReferenceBodyOptions& options) {
    impl_ = std::make_unique<Impl>(mesh, supports, markers, options);
    Impl& i = *impl_;
    i.surface = {mesh.nodes, mesh.faces.leftCols(3)};
    i.centres = centres_of(mesh);
    i.cut = cut_by_support(mesh, i.body.held());
    const fem::NodeWeights support = i.body.points(fem::ActsOn::support, i.density);
    i.support_points = mesh.nodes(support.nodes, Eigen::all);
    i.support_shares = support.weights;
    const fem::NodeWeights skin = i.body.points(fem::ActsOn::surface, i.density);
    i.skin_nodes = skin.nodes;
    i.skin = mesh.nodes(skin.nodes, Eigen::all);
    i.skin_areas = skin.weights;
    const fem::NodeWeights material = i.body.points(fem::ActsOn::material, 1);
    i.material_nodes = material.nodes;
    i.material_points = mesh.nodes(material.nodes, Eigen::all);
    i.material_shares = material.weights / material.weights.sum();
    const double start = std::log(options.young.value_or(0.1));
    // Young's modulus to a factor of twenty. A ratio that is told is taken at its word, so that a fit which explains
    // little does not bend it (the effect `volume` contradicts it); else nu = .45, from about .13 to .49.
    const double compressibility = std::log(1 - 2 * options.poisson.value_or(0.45));
    constexpr double least_ratio = -0.5, most_ratio = 0.4999;
    constexpr double of_unknown = 4;   // tissues differ by more than bodies do, by a factor of 50
    constexpr double of_known = 1e-6;  // leaves nothing to be fitted
    i.parameters = {{"young", start, start, 3},
                    {"compressibility", compressibility, compressibility, options.poisson ? of_known : 1, false,
                     std::log(1 - 2 * most_ratio), std::log(1 - 2 * least_ratio)}};
    for (StiffnessParameter& parameter : i.parameters) {
        const InformativePrior* from_specimens = prior_of(parameter.name, parameter.prior_sd, options.priors);
        if (!from_specimens) continue;
        parameter.start = parameter.prior_mean = from_specimens->mean;
        parameter.prior_sd = from_specimens->sd;
    }
    for (const mesh::MaterialRegion& region : options.regions) {
        const double own = region.young ? std::log(*region.young) : start;
        i.parameters.push_back(
            {region_parameter(region.name), own, own, region.young ? of_known : of_unknown, !region.young});
    }
}

ReferenceBody::~ReferenceBody() = default;

Eigen::VectorXd ReferenceBody::Impl::shares_of(const mesh::Contact& contact) const {
    const Place place{contact.point.x(), contact.point.y(), contact.point.z(), contact.radius};
    {
        const std::scoped_lock lock(mutex);
        if (const auto found = shares.find(place); found != shares.end()) return found->second;
    }
    const Eigen::SparseMatrix<double> F =
        fem::patch_loads(body.mesh(), {{contact.point, Vec3::UnitX(), contact.radius}}, size);
    Eigen::VectorXd result = Eigen::VectorXd::Zero(body.mesh().nodes.rows());
    for (Eigen::SparseMatrix<double>::InnerIterator it(F, 0); it; ++it) {
        if (it.row() % 3 == 0) result[it.row() / 3] = it.value();
    }
    const std::scoped_lock lock(mutex);
    shares.emplace(place, result);
    return result;
}

Eigen::VectorXd ReferenceBody::Impl::load(const Action& action) const {
    Eigen::VectorXd f = Eigen::VectorXd::Zero(body.mesh().nodes.size());
    for (const mesh::Contact& contact : action.contacts) {
        if (contact.force.isZero(0)) continue;
        const Eigen::VectorXd share = shares_of(contact);
        for (int a = 0; a < 3; ++a) f(Eigen::seq(a, Eigen::last, 3)) += contact.force[a] * share;
    }
    if (!action.gravity.isZero(0)) {
        const fem::NodeWeights mass = body.points(fem::ActsOn::material, density);
        for (std::size_t k = 0; k < mass.nodes.size(); ++k) {
            f.segment<3>(Eigen::Index{3} * mass.nodes[k]) +=
                mass.weights[static_cast<Eigen::Index>(k)] * action.gravity;
        }
    }
    return f;
}

std::string region_parameter(const std::string& region) { return of_region + region; }

std::optional<std::string> region_of_parameter(const std::string& parameter) {
    if (!parameter.starts_with(of_region)) return std::nullopt;
    return parameter.substr(std::string_view(of_region).size());
}

int ReferenceBody::dofs() const { return static_cast<int>(impl_->body.mesh().nodes.size()); }
const std::vector<std::string>& ReferenceBody::laws() const { return impl_->laws; }
const std::vector<StiffnessParameter>& ReferenceBody::parameters() const { return impl_->parameters; }
double ReferenceBody::size() const { return impl_->size; }
double ReferenceBody::young(const ModelSetting& setting) const { return std::exp(setting.theta[ln_young]); }
bool ReferenceBody::is_nonlinear(const ModelSetting& setting) const {
    const bool one_sided =
        std::ranges::any_of(setting.effects.points, [](const auto& potential) { return potential->is_one_sided(); });
    return static_cast<fem::MaterialLaw>(setting.law) != fem::MaterialLaw::linear || setting.effects.remember() ||
           one_sided || impl_->rig.is_nonlinear();
}
const fem::HyperelasticBody& ReferenceBody::body() const { return impl_->body; }

fem::Material ReferenceBody::material(const ModelSetting& setting) const {
    return material_of(setting, impl_->density);
}

std::vector<fem::Material> ReferenceBody::region_materials(const ModelSetting& setting) const {
    return impl_->region_materials(setting, material(setting));
}

const std::vector<int>& ReferenceBody::region_of_element() const { return impl_->regions.of_element; }

Eigen::VectorXd ReferenceBody::rest(const ModelSetting&) const { return Eigen::VectorXd::Zero(dofs()); }

Eigen::VectorXd ReferenceBody::equilibrium(const ModelSetting& setting, const Action& action,
                                           const Eigen::VectorXd* start, const Tangent* guide) const {
    if (has_free_coordinates(action)) return equilibrium_with_free_tools(*this, setting, action, start, guide);
    // What is not found soon next to a known state is no answer for a trial.
    require_material(material(setting));
    const fem::NewtonOptions options{.tolerance = 1e-7, .iterations = start ? 40 : 60, .load_steps = start ? 0 : 16};
    const auto* nearby = guide ? dynamic_cast<const FemTangent*>(&with_friction_held(*guide)) : nullptr;
    fem::BodySetting own = impl_->setting(setting, action);
    const Eigen::VectorXd f = impl_->load(action);
    const auto settle = [&](const Eigen::VectorXd* from) {
        return impl_->body.equilibrium(own, f, options, from, memory_of(action), nearby ? &nearby->factor() : nullptr)
            .u;
    };
    if (!rub(own.effects.tendons)) return settle(start);
    const auto with_held = [&](const std::vector<fem::TendonPull>& tendons, const Eigen::VectorXd* from) {
        own.effects.tendons = tendons;
        return settle(from);
    };
    const auto friction = [&](const fem::TendonPull& pull, const Eigen::VectorXd& q) {
        return impl_->body.tendon_friction(q, pull, in_small_strain(setting));
    };
    return FrictionIteration(own.effects.tendons, with_held, friction).equilibrium(rest(setting), start);
}

Eigen::VectorXd ReferenceBody::residual(const Eigen::VectorXd& q, const ModelSetting& setting,
                                        const Action& action) const {
    if (has_free_coordinates(action)) return residual(q, setting, posed(*this, q, setting, action));
    return impl_->body.residual(q, impl_->setting(setting, action), impl_->load(action), memory_of(action));
}

std::shared_ptr<const Tangent> ReferenceBody::tangent(const Eigen::VectorXd& q, const ModelSetting& setting,
                                                      const Action& action) const {
    require_material(material(setting));
    if (has_free_coordinates(action)) return tangent_with_free_tools(*this, q, setting, action);
    const fem::BodySetting own = impl_->setting(setting, action);
    auto held = std::make_shared<FemTangent>(impl_->body.factor(q, own, memory_of(action)));
    return tangent_with_friction(std::move(held), impl_->sliding(q, own));
}

Eigen::MatrixXd ReferenceBody::parameter_force(const Eigen::VectorXd& q, const ModelSetting& setting,
                                               const Action& action) const {
    if (has_free_coordinates(action)) return parameter_force(q, setting, posed(*this, q, setting, action));
    const fem::BodySetting own = impl_->setting(setting, action);
    const Eigen::MatrixXd unit = impl_->body.modulus_forces(q, own, memory_of(action));
    const auto of_body = slopes_of(own.material, unit.leftCols<2>());
    // The residual is minus the internal force. What tools press through is as many times as stiff as the body.
    Eigen::MatrixXd G(q.size(), std::ssize(impl_->parameters));
    G.col(ln_young) = impl_->body.grip_forces(q, own) - of_body.col(0);
    G.col(ln_compressibility) = -of_body.col(1);
    for (std::size_t r = 0; r < own.regions.size(); ++r) {
        const auto place = static_cast<Eigen::Index>(r);
        const auto of_region = slopes_of(own.regions[r], unit.middleCols<2>(2 * (place + 1)));
        G.col(first_region + place) = -of_region.col(0);
        if (!impl_->options.regions[r].poisson) G.col(ln_compressibility) -= of_region.col(1);
    }
    return G;
}

Points ReferenceBody::observe(const Eigen::VectorXd& q, const ModelSetting& setting) const {
    return impl_->frames.positions(q, in_small_strain(setting));
}

Eigen::SparseMatrix<double> ReferenceBody::observation(const Eigen::VectorXd& q, const ModelSetting& setting) const {
    return impl_->frames.derivative(q, in_small_strain(setting));
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
    const Eigen::VectorXd start = finer->start(motions, q);
    const Eigen::VectorXd u =
        own.body.equilibrium(own.setting(setting, action), own.load(action), {.tolerance = 1e-6}, &start).u;
    finer->keep(motions, u);
    return difference(q, own.frames.positions(u, in_small_strain(setting)), own.body, u, setting, action);
}

std::optional<double> ReferenceBody::left_of_mesh_error(const Action& action) const {
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

Eigen::VectorXd ReferenceBody::advance(const Eigen::VectorXd& q, const Eigen::VectorXd& step,
                                       const ModelSetting&) const {
    return q + step;
}

std::shared_ptr<const Memory> ReferenceBody::remember(const Eigen::VectorXd& q, const ModelSetting& setting,
                                                      const Action& action) const {
    if (!setting.effects.remember()) return nullptr;
    if (has_free_coordinates(action)) return remember(q, setting, posed(*this, q, setting, action));
    return std::make_shared<FemMemory>(impl_->body.state_after(q, impl_->setting(setting, action), memory_of(action)));
}

Eigen::VectorXd ReferenceBody::contact_force(const Eigen::VectorXd&, const ModelSetting&,
                                             const mesh::Contact& contact) const {
    return impl_->load({.contacts = {contact}});
}

Vec3 ReferenceBody::normal_near(const Vec3& point, double radius) const {
    return mesh::mean_normal(impl_->surface, point, radius);
}

const Points& ReferenceBody::pieces() const { return impl_->centres; }
const std::vector<char>& ReferenceBody::pieces_at_support() const { return impl_->cut; }

Eigen::MatrixXd ReferenceBody::piece_force(const Eigen::VectorXd& q, const ModelSetting& setting, const Action& action,
                                           const Eigen::MatrixXd& W) const {
    if (has_free_coordinates(action)) return piece_force(q, setting, posed(*this, q, setting, action), W);
    return -impl_->body.element_forces(q, impl_->setting(setting, action), W, memory_of(action));
}

const Points& ReferenceBody::skin() const { return impl_->skin; }
const Eigen::VectorXd& ReferenceBody::skin_areas() const { return impl_->skin_areas; }

Points ReferenceBody::skin_positions(const Eigen::VectorXd& q, const ModelSetting&) const {
    const Eigen::Map<const Points> u(q.data(), q.size() / 3, 3);
    return impl_->skin + Points(u(impl_->skin_nodes, Eigen::all));
}

Eigen::SparseMatrix<double> ReferenceBody::skin_motion(const Eigen::VectorXd&, const ModelSetting&) const {
    return selection_of(impl_->skin_nodes, dofs());
}

const Points& ReferenceBody::material_points() const { return impl_->material_points; }
const Eigen::VectorXd& ReferenceBody::material_shares() const { return impl_->material_shares; }
Eigen::SparseMatrix<double> ReferenceBody::material_motion() const {
    return selection_of(impl_->material_nodes, dofs());
}

bool ReferenceBody::has_cavities() const { return impl_->body.has_cavities(); }

const Points& ReferenceBody::support_points() const { return impl_->support_points; }
const Eigen::VectorXd& ReferenceBody::support_shares() const { return impl_->support_shares; }

Eigen::MatrixXd ReferenceBody::support_motion(const Vec3& centre) const {
    Eigen::MatrixXd S = Eigen::MatrixXd::Zero(dofs(), 6);
    for (std::size_t node = 0; node < impl_->body.held().size(); ++node) {
        if (!impl_->body.held()[node]) continue;
        const auto row = 3 * static_cast<Eigen::Index>(node);
        const Vec3 arm = impl_->body.mesh().nodes.row(static_cast<Eigen::Index>(node)).transpose() - centre;
        S.block<3, 3>(row, 0).setIdentity();
        S.block<3, 3>(row, 3) = -skeleton::skew(arm);
    }
    return S;
}

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
