#include "identify/inference/domains/force/node_configuration.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>

#include "fem/interpolation/interpolation.h"
#include "identify/loading/loads.h"
#include "mesh/errors.h"
#include "skeleton/model/attachment/attach.h"

namespace palpate::identify {
namespace {

NodeConfiguration rest_configuration(const skeleton::Model& model) {
    NodeConfiguration configuration{rest_state(model), std::vector<char>(model.spheres.size(), 0)};
    for (int i = 0; i < static_cast<int>(model.spheres.size()); ++i) configuration.known[i] = model.spheres[i].held;
    return configuration;
}

/// Puts a sphere where the points x of its material, at y now, carry it.
void place_sphere(const skeleton::Model& model, int sphere, const Points& x, const Points& y,
                  NodeConfiguration& configuration) {
    const RigidFit fit = fit_rigid(x, y);
    if (!fit.unique) return;
    configuration.state.x.row(sphere) = fit.R * (model.spheres[sphere].center - fit.c) + fit.d;
    configuration.state.R[sphere] = fit.R;
    configuration.known[sphere] = 1;
}

/// The sphere that a marker hangs on alone, or -1.
int only_sphere(const skeleton::Attachment& at) {
    constexpr double rounding = 1e-9;  // of weights that add up to 1
    const auto whole = std::ranges::find_if(at.shares, [](const auto& share) { return share.weight > 1 - rounding; });
    return whole != at.shares.end() ? whole->sphere : -1;
}

/// Points of a ball of radius 1: the 26 directions from a cube's middle to its corners, edges and sides, on two shells.
/// Their second moments are those of a ball, so that a strain looks neither like a displacement nor like a turn.
Points ball_points() {
    std::vector<Vec3> points;
    for (int x = -1; x <= 1; ++x) {
        for (int y = -1; y <= 1; ++y) {
            for (int z = -1; z <= 1; ++z) {
                if (x == 0 && y == 0 && z == 0) continue;
                for (const double r : {0.5, 0.9}) points.push_back(r * Vec3(x, y, z).normalized());
            }
        }
    }
    return Eigen::Map<const Points>(points.front().data(), static_cast<Eigen::Index>(points.size()), 3);
}

double reach(const skeleton::Model& model, int sphere) {
    double least = model.spheres[sphere].radius;
    for (int i = 0; i < static_cast<int>(model.spheres.size()); ++i) {
        if (i != sphere) least = std::min(least, (model.spheres[i].center - model.spheres[sphere].center).norm() / 2);
    }
    return least;
}

void require_fixed_supports(const skeleton::Model& model) {
    for (const skeleton::EffectRecord& effect : model.effects) {
        if (!skeleton::is_body_effect(effect.name) || !fem::release_supports(skeleton::make_physics(effect))) continue;
        throw InvalidInput(
            fmt::format("method burion2008 takes held spheres to stay where they are, but the model's effect '{}' lets "
                        "them move: take it out of the model, or use method tempered",
                        effect.name));
    }
}

bool is_loaded(const LoadState& state) {
    return std::ranges::any_of(state.contacts, [](const mesh::Contact& c) { return !c.force.isZero(0); });
}

}  // namespace

RigidFit fit_rigid(const Points& x, const Points& y) {
    RigidFit fit;
    if (x.rows() < 3) return fit;
    fit.c = x.colwise().mean();
    fit.d = y.colwise().mean();
    const Points dx = x.rowwise() - fit.c.transpose();
    const Eigen::JacobiSVD<Eigen::Matrix<double, Eigen::Dynamic, 3>> shape(dx);
    if (shape.singularValues()[1] < 1e-6 * shape.singularValues()[0]) return fit;

    // R maximises tr(R^T Y^T X): R = U diag(1, 1, det) V^T of Y^T X
    const Mat3 YX = (y.rowwise() - fit.d.transpose()).transpose() * dx;
    const Eigen::JacobiSVD<Mat3> svd(YX, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const double det = (svd.matrixU() * svd.matrixV().transpose()).determinant();
    fit.R = svd.matrixU() * Vec3(1, 1, det).asDiagonal() * svd.matrixV().transpose();
    fit.unique = true;
    return fit;
}

bool NodeConfiguration::complete() const {
    return std::ranges::all_of(known, [](char k) { return k != 0; });
}

NodeConfiguration configuration_of_markers(const skeleton::Model& model, const MeasurementSet& set,
                                           const LoadState& state) {
    // readings by the sphere that they hang on alone
    std::vector<std::vector<const Reading*>> on_sphere(model.spheres.size());
    const skeleton::Attacher attach(model);
    for (const Reading& reading : state.readings) {
        if (reading.marker < 0 || !reading.position.allFinite()) continue;
        const Marker& marker = set.markers[reading.marker];
        const int sphere = only_sphere(attach(marker.anchor.value_or(marker.rest), marker.rest));
        if (sphere >= 0) on_sphere[sphere].push_back(&reading);
    }

    NodeConfiguration configuration = rest_configuration(model);
    for (int i = 0; i < static_cast<int>(model.spheres.size()); ++i) {
        if (model.spheres[i].held) continue;
        const auto m = static_cast<Eigen::Index>(on_sphere[i].size());
        Points x(m, 3), y(m, 3);
        for (Eigen::Index j = 0; j < m; ++j) {
            x.row(j) = set.markers[on_sphere[i][j]->marker].rest;
            y.row(j) = on_sphere[i][j]->position;
        }
        place_sphere(model, i, x, y, configuration);
    }
    return configuration;
}

NodeConfiguration configuration_of_field(const skeleton::Model& model, const Field& field) {
    const Points ball = ball_points();
    const auto per_sphere = ball.rows();
    Points samples(per_sphere * static_cast<Eigen::Index>(model.spheres.size()), 3);
    for (int i = 0; i < static_cast<int>(model.spheres.size()); ++i) {
        samples.middleRows(i * per_sphere, per_sphere) =
            (reach(model, i) * ball).rowwise() + model.spheres[i].center.transpose();
    }
    const Points moved = samples + fem::interpolation(field.mesh, samples) * field.displacement;

    NodeConfiguration configuration = rest_configuration(model);
    for (int i = 0; i < static_cast<int>(model.spheres.size()); ++i) {
        if (model.spheres[i].held) continue;
        place_sphere(model, i, samples.middleRows(i * per_sphere, per_sphere),
                     moved.middleRows(i * per_sphere, per_sphere), configuration);
    }
    return configuration;
}

std::vector<MeasuredConfiguration> measured_configurations(const skeleton::Model& model, const MeasurementSet& set) {
    require_fixed_supports(model);
    const ContactLoads loads(model);
    const bool always_loaded = is_always_loaded(model);
    std::vector<MeasuredConfiguration> measured;
    for (const LoadState& state : set.states) {
        if (!always_loaded && !is_loaded(state)) continue;
        const NodeConfiguration configuration = state.field.empty() ? configuration_of_markers(model, set, state)
                                                                    : configuration_of_field(model, read_field(state));
        if (configuration.complete()) measured.push_back({configuration.state, loads(set, state)});
    }
    return measured;
}

}  // namespace palpate::identify
