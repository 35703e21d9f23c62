#include "fem/large_deformation/solve/equilibrium.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>

#include "fem/large_deformation/solve/newton.h"
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
    return std::max(area > 0 ? force / area : 0, std::abs(setting.effects.pressure));
}

/// What may keep a body from an equilibrium, and what to do.
std::string advice(double pressure, double young) {
    constexpr double much = 0.1;  // of Young's modulus: strains of a tenth, from where on soft bodies may give way
    if (pressure > much * young) {
        return fmt::format(
            "The load applies about {:.3g} MPa to a body of E = {:.4g} MPa, possibly beyond its stability limit: check "
            "the "
            "force "
            "and its unit, or leave this state out.",
            pressure, young);
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
                                 const PlasticState* before, const Cholesky* guide) {
    const Unknowns& unknowns = order.unknowns;
    assert(f.size() == body.mesh.nodes.size());
    BodyEquilibrium result;
    result.u.setZero(f.size());

    const LoadedBody loaded(body, setting, f, before);
    const double load = unknowns.gather(loaded.net_force(result.u)).norm();  // at rest nothing else pulls
    if (load == 0) return result;

    Newton newton(order, options.iterations);
    Eigen::VectorXd& u = result.u;
    const double rough = std::max(options.tolerance, 1e-3);
    // A body that flows sets out from where it would stand if it did not, unless it is near its answer.
    const auto elastically = [&](double share) {
        return loaded.conservative() ||
               newton.minimise(LoadedBody(body, setting, f, before, share, false), rough * load, u);
    };
    const auto from_start = [&] {
        if (!start) return false;
        u = unknowns.scatter(unknowns.gather(*start));
        if (!loaded.admits(u)) return false;
        const bool near = loaded.conservative() || unknowns.gather(loaded.net_force(u)).norm() < 0.2 * load;
        return (near || elastically(1)) && newton.minimise(loaded, options.tolerance * load, u, guide);
    };
    // Each step starts where the last two point to; only the last has to be exact.
    const auto in_steps = [&](int steps) {
        Eigen::VectorXd last = Eigen::VectorXd::Zero(f.size());
        u = last;
        for (int k = 1; k <= steps; ++k) {
            const LoadedBody part(body, setting, f, before, static_cast<double>(k) / steps);
            const Eigen::VectorXd ahead = 2 * u - last;
            last = u;
            if (part.admits(ahead)) u = ahead;
            const double share = k == steps ? options.tolerance : rough;
            if (k == 1 && !elastically(1.0 / steps)) return false;
            if (!newton.minimise(part, share * load, u)) return false;
        }
        return true;
    };
    bool found = from_start();
    for (const int steps : {1, 4, 16}) found = found || (steps <= options.load_steps && in_steps(steps));
    result.iterations = newton.iterations();
    result.factorisations = newton.factorisations();
    result.residual = newton.residual();
    if (!found) {
        throw SolverFailure(fmt::format(
            "No equilibrium was found under a load of {:.4g} N (root of the sum of squares over nodes) in {} steps, "
            "with the load in up to {} parts: {:.4g} N stay unbalanced. {}",
            load, result.iterations, options.load_steps, result.residual,
            advice(pressure_of(body, setting, f), setting.material.young)));
    }
    return result;
}

}  // namespace palpate::fem
