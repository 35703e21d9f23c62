#include "skeleton/runtime/forces/point_effects.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <map>

#include "mesh/errors.h"
#include "skeleton/effects/point_sets.h"
#include "skeleton/loads/cavity_walls.h"
#include "skeleton/runtime/forces/link_tables.h"

namespace palpate::runtime {

PointEffects::PointEffects(const skeleton::Model& model, const fem::Effects& effects)
    : model_(model), supported_(model.spheres.size(), 0), surface_(effects.surface), of_effects_(effects.pressure) {
    for (const auto& potential : effects.points) {
        const skeleton::PointSet set = skeleton::point_set(model, potential->acts_on());
        Points stand(std::ssize(set.at), 3);
        for (std::size_t i = 0; i < set.at.size(); ++i) {
            stand.row(static_cast<Eigen::Index>(i)) = set.at[i].rest.transpose();
        }
        const Eigen::VectorXd weights = potential->weights(stand, set.weights);
        Placed& placed = effects_.emplace_back();
        placed.potential = potential;
        for (std::size_t i = 0; i < set.at.size(); ++i) {
            const double weight = weights[static_cast<Eigen::Index>(i)];
            if (potential->acts_on() == fem::ActsOn::support) supported_[set.at[i].shares.front().sphere] = 1;
            if (weight == 0) continue;
            placed.points.emplace_back().assign(set.at[i], model.spheres);
            placed.weights.push_back(weight);
        }
    }
    if (!surface_.empty()) {
        triangles_ = skeleton::skin_triangles(model);
        for (const skeleton::Attachment& point : model.skin) vertices_.emplace_back().assign(point, model.spheres);
        pulls_.resize(vertices_.size());
    }
    if (of_effects_ != 0) take_cavities();
}

void PointEffects::set_pressure(double pressure) {
    if (pressure != 0) take_cavities();
    for (Cavity& cavity : cavities_) cavity.pressure = pressure;
}

void PointEffects::set_cavity_pressure(int cavity, double pressure) {
    take_cavities();
    if (cavity < 0 || cavity >= static_cast<int>(cavities_.size()))
        throw InvalidInput(fmt::format("cavity {} does not exist; the model's skin encloses {}, numbered from 0",
                                       cavity, cavities_.size()));
    cavities_[cavity].pressure = pressure;
}

void PointEffects::take_cavities() {
    if (!cavities_.empty()) return;
    const SphereRows rest = rest_rows(model_);
    for (const skeleton::CavityWall& wall : skeleton::walls_by_cavity(model_)) {
        Cavity& cavity = cavities_.emplace_back();
        std::map<int, int> corner_of;
        for (std::array<int, 3> triangle : wall) {
            for (int& corner : triangle) {
                const auto [at, fresh] = corner_of.try_emplace(corner, static_cast<int>(cavity.corners.size()));
                if (fresh) cavity.corners.emplace_back().assign(model_.skin[corner], model_.spheres);
                corner = at->second;
            }
            cavity.wall.push_back(triangle);
        }
        cavity.growth.resize(cavity.corners.size());
        cavity.rest_volume = cavity.place(rest.data());
    }
    if (cavities_.empty())
        throw InvalidInput(
            "the model's skin encloses no cavity, in which a pressure could act: give it one, closed and turned "
            "inwards, or take the pressure away");
}

double PointEffects::add_forces(const double* pose, double* force) {
    double energy = 0;
    for (Placed& effect : effects_) {
        for (std::size_t p = 0; p < effect.points.size(); ++p) {
            RuntimePoint& point = effect.points[p];
            point.place(pose);
            const fem::PointTerms terms = effect.potential->terms(point.rest(), point.x());
            energy += effect.weights[p] * terms.energy;
            if (!terms.gradient.isZero(0)) point.add_force(-effect.weights[p] * terms.gradient, force);
        }
    }
    if (!surface_.empty()) energy += add_skin(pose, force);
    return cavities_.empty() ? energy : energy + add_pressure(pose, force);
}

double PointEffects::add_skin(const double* pose, double* force) {
    for (std::size_t v = 0; v < vertices_.size(); ++v) {
        vertices_[v].place(pose);
        pulls_[v].setZero();
    }
    double energy = 0;
    for (const skeleton::SkinTriangle& triangle : triangles_) {
        Mat3 x;
        for (int v = 0; v < 3; ++v) x.col(v) = vertices_[triangle.corners[v]].x();
        const fem::FacetEnergy<3> own(surface_, triangle.at_rest, x);
        energy += own.value();
        for (int v = 0; v < 3; ++v) pulls_[triangle.corners[v]] -= own.by_node(v);
    }
    for (std::size_t v = 0; v < vertices_.size(); ++v) vertices_[v].add_force(pulls_[v], force);
    return energy;
}

// A triangle's part in V is -1/6 x_0 . (x_1 x x_2), as its outward normal points into the cavity.
double PointEffects::Cavity::place(const double* pose) {
    for (std::size_t c = 0; c < corners.size(); ++c) {
        corners[c].place(pose);
        growth[c].setZero();
    }
    const Vec3 origin = corners.front().x();
    double volume = 0;
    for (const auto& triangle : wall) {
        const Vec3 x[3] = {corners[triangle[0]].x() - origin, corners[triangle[1]].x() - origin,
                           corners[triangle[2]].x() - origin};
        volume -= x[0].dot(x[1].cross(x[2])) / 6;
        for (int v = 0; v < 3; ++v) growth[triangle[v]] -= x[(v + 1) % 3].cross(x[(v + 2) % 3]) / 6;
    }
    return volume;
}

double PointEffects::add_pressure(const double* pose, double* force) {
    double energy = 0;
    for (Cavity& cavity : cavities_) {
        const double pressure = of_effects_ + cavity.pressure;
        if (pressure == 0) continue;
        energy -= pressure * (cavity.place(pose) - cavity.rest_volume);
        for (std::size_t c = 0; c < cavity.corners.size(); ++c)
            cavity.corners[c].add_force(pressure * cavity.growth[c], force);
    }
    return energy;
}

}  // namespace palpate::runtime
