#include "fem/large_deformation/solve/equilibrium.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <initializer_list>
#include <optional>

#include "fem/large_deformation/solve/newton.h"
#include "fem/rig/tool_approach.h"
#include "mesh/errors.h"

namespace palpate::fem {

namespace {

/// Mean pressure of the load over the surface that it acts on, or that in cavities, whichever is larger [MPa].
double pressure_of(const BodyShape& body, const BodySetting& setting, const Eigen::VectorXd& f) {
    double area = 0, force = 0;
    for (Eigen::Index node = 0; node < body.mesh.nodes.rows(); ++node) {
        const Vec3 own = f.segment<3>(3 * node);
        if (own.isZero(0)) continue;
        force += own.norm();
        area += body.integrals.area[node];
    }
    const Eigen::VectorXd within = body.pressures(setting.effects);
    return std::max(area > 0 ? force / area : 0, within.size() > 0 ? within.cwiseAbs().maxCoeff() : 0);
}

/// In how many parts tools move at least, so that none comes out at the other side of a thin body.
int steps_of_tools(const Effects& effects) {
    double most = 1;
    for (const auto& tool : effects.tools) most = std::max(most, tool->way() / tool->reach());
    constexpr double limit = 1000;  // one is long where a tool comes from afar, but most parts are away from the body
    return static_cast<int>(std::ceil(std::min(most, limit)));
}

/// Outward at the nodes of the surface, of any length; zero within (n x 3).
Points outward_at_nodes(const mesh::VolumeMesh& mesh) {
    const Points areas = mesh::area_vectors({mesh.nodes, mesh.faces.leftCols(3)});
    Points normals = Points::Zero(mesh.nodes.rows(), 3);
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
        for (const int node : mesh.faces.row(f)) normals.row(node) += areas.row(f);
    return normals;
}

struct Approach {
    BodySetting setting;
    bool likely = true;  // that all tools have come so
};

/// With tools that come from off the body, those that part from it; none where that is no other way.
std::optional<Approach> find_approach(const BodyShape& body, const BodySetting& setting) {
    std::optional<Approach> result;
    Points normals;  // made for the first tool that needs them
    std::vector<Eigen::Index> held;
    for (std::size_t node = 0; node < body.held.size(); ++node)
        if (body.held[node]) held.push_back(static_cast<Eigen::Index>(node));
    for (std::size_t t = 0; t < setting.effects.tools.size(); ++t) {
        const ToolPotential& tool = *setting.effects.tools[t];
        if (!(tool.way() > tool.reach())) continue;  // in one step from rest
        const NodeWeights at = body.points(tool.acts_on(), setting.material.density);
        if (normals.rows() == 0) normals = outward_at_nodes(body.mesh);
        const auto approach = from_off_the_body(tool, body.mesh.nodes(at.nodes, Eigen::all),
                                                normals(at.nodes, Eigen::all), body.mesh.nodes(held, Eigen::all));
        if (!approach) continue;
        if (!result) result = Approach{setting};
        result->setting.effects.tools[t] = approach->tool;
        result->likely &= approach->likely;
    }
    return result;
}

/// With a share of what the material has grown by.
BodySetting with_growth(BodySetting setting, double share) {
    Growth& growth = setting.effects.growth;
    growth.everywhere *= share;
    for (Growth::Part& part : growth.parts) part.growth *= share;
    return setting;
}

std::string where_tools_are(const Effects& effects) {
    std::string words;
    for (const auto& tool : effects.tools)
        words += fmt::format(", with the tool \"{}\" moved by {:.4g} mm", tool->tool().name,
                             tool->motion().translation.norm());
    return words;
}

/// What may keep a body from an equilibrium, and what to do.
std::string advice(const BodyShape& body, const BodySetting& setting, const Eigen::VectorXd& f) {
    const double pressure = pressure_of(body, setting, f), young = setting.material.young;
    constexpr double much = 0.1;  // of Young's modulus: strains of a tenth, from where on soft bodies may give way
    if (pressure > much * young) {
        return fmt::format(
            "The load applies about {:.3g} MPa to a body of E = {:.4g} MPa, possibly beyond its stability limit: check "
            "the "
            "force "
            "and its unit, or leave this state out.",
            pressure, young);
    }
    if (!setting.effects.tools.empty()) {
        return "A tool may be asked to go where the body cannot give way without elements turning inside out: check "
               "its "
               "motion and the unit, try shorter elements (--edge-length), or leave this state out.";
    }
    return fmt::format(
        "It is not that the load crushes the body: it presses with about {:.2g} of E = {:.4g} MPa. The body may "
        "buckle, "
        "or the mesh may be too coarse for how thin it is: try shorter elements (--edge-length), or leave this state "
        "out.",
        pressure / young, young);
}

}  // namespace

BodyEquilibrium find_equilibrium(const BodyShape& body, const EliminationOrder& order, const BodySetting& setting,
                                 const Eigen::VectorXd& f, const NewtonOptions& options, const Eigen::VectorXd* start,
                                 const MaterialState* before, const TangentSolver* guide) {
    const Unknowns& unknowns = order.unknowns;
    assert(f.size() == body.mesh.nodes.size());
    BodyEquilibrium result;
    result.u.setZero(f.size());

    const LoadedBody loaded(body, setting, f, before);
    // At rest nothing else pulls; tools that are moved at once hold with forces far beyond those that they will have.
    const Eigen::VectorXd grip = loaded.grip(result.u);
    const double load = unknowns.gather(loaded.net_force(result.u) - grip).norm();
    if (load == 0 && grip.isZero(0)) return result;

    Newton newton(order, options.iterations);
    Eigen::VectorXd& u = result.u;
    // Of the load: steps on the way need no more to be where the next sets out from, and a smaller share takes longer.
    constexpr double rough_share = 1e-3;
    // Of the load: a body that flows is near its answer where less is unbalanced, and steps from there are of its own
    // law.
    constexpr double near_share = 0.2;
    const double rough = std::max(options.tolerance, rough_share);
    // A body that flows sets out from where it would stand if it did not, unless it is near its answer.
    const auto within = [&](double share) { return NewtonTolerance{share * load, share}; };
    const auto elastically = [&](double share) {
        if (loaded.conservative()) return true;
        const BodySetting less = with_growth(setting, share);
        return newton.minimise(LoadedBody(body, less, f, before, share, false), within(rough), u);
    };
    const auto from_start = [&] {
        if (!start) return false;
        u = unknowns.scatter(unknowns.gather(*start));
        if (!loaded.admits(u)) return false;
        const bool near = loaded.conservative() || unknowns.gather(loaded.net_force(u)).norm() < near_share * load;
        return (near || elastically(1)) && newton.minimise(loaded, within(options.tolerance), u, guide);
    };
    // Each step starts where the last two point to; only the last has to be exact.
    const auto in_steps = [&](const BodySetting& way, int steps) {
        steps *= steps_of_tools(way.effects);
        Eigen::VectorXd last = Eigen::VectorXd::Zero(f.size());
        u = last;
        for (int k = 1; k <= steps; ++k) {
            const double share = static_cast<double>(k) / steps;
            const BodySetting less = with_growth(way, share);
            const LoadedBody part(body, less, f, before, share);
            const Eigen::VectorXd ahead = 2 * u - last;
            last = u;
            if (part.admits(ahead)) u = ahead;
            const double tolerance = k == steps ? options.tolerance : rough;
            if (k == 1 && !elastically(share)) return false;
            if (!newton.minimise(part, within(tolerance), u)) return false;
        }
        return true;
    };
    bool found = from_start();
    const auto try_in = [&](const BodySetting& way, std::initializer_list<int> parts) {
        for (const int steps : parts) found = found || (steps <= options.load_steps && in_steps(way, steps));
    };
    const auto approach = found ? std::nullopt : find_approach(body, setting);
    if (approach && approach->likely) try_in(approach->setting, {1, 4});
    try_in(setting, {1});
    if (approach && !approach->likely) try_in(approach->setting, {1, 4});
    try_in(setting, {4, 16});
    result.iterations = newton.iterations();
    result.factorisations = newton.factorisations();
    result.residual = newton.residual();
    if (!found) {
        throw SolverFailure(fmt::format(
            "No equilibrium was found under a load of {:.4g} N (root of the sum of squares over nodes){} in {} steps, "
            "with the load in up to {} parts: {:.4g} N stay unbalanced. {}",
            load, where_tools_are(setting.effects), result.iterations,
            options.load_steps * steps_of_tools(setting.effects), result.residual, advice(body, setting, f)));
    }
    return result;
}

}  // namespace palpate::fem
