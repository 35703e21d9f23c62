#include "skeleton/runtime/forces/point_effects.h"

#include <Eigen/Geometry>
#include <map>

#include "mesh/errors.h"
#include "skeleton/effects/point_sets.h"
#include "skeleton/loads/cavities.h"
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
    set_pressure(0);
}

void PointEffects::set_pressure(double pressure) {
    const double all = of_effects_ + pressure;
    if (all != 0 && walls_.empty()) take_walls();
    pressure_ = all;
}

void PointEffects::take_walls() {
    std::map<int, int> corner_of;
    for (std::array<int, 3> wall : skeleton::cavity_walls(model_)) {
        for (int& corner : wall) {
            const auto [at, fresh] = corner_of.try_emplace(corner, static_cast<int>(corners_.size()));
            if (fresh) corners_.emplace_back().assign(model_.skin[corner], model_.spheres);
            corner = at->second;
        }
        walls_.push_back(wall);
    }
    if (walls_.empty())
        throw InvalidInput(
            "the model's skin encloses no cavity, in which a pressure could act: give it one, closed and turned "
            "inwards, or take the pressure away");
    growth_.resize(corners_.size());
    const SphereRows rest = rest_rows(model_);
    SphereRows nothing(rest.size(), 0.0);
    pressure_ = 1;
    rest_volume_ = -add_pressure(rest.data(), nothing.data());
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
    return pressure_ == 0 ? energy : energy + add_pressure(pose, force);
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
double PointEffects::add_pressure(const double* pose, double* force) {
    for (std::size_t c = 0; c < corners_.size(); ++c) {
        corners_[c].place(pose);
        growth_[c].setZero();
    }
    const Vec3 origin = corners_.front().x();
    double volume = 0;
    for (const auto& wall : walls_) {
        const Vec3 x[3] = {corners_[wall[0]].x() - origin, corners_[wall[1]].x() - origin,
                           corners_[wall[2]].x() - origin};
        volume -= x[0].dot(x[1].cross(x[2])) / 6;
        for (int v = 0; v < 3; ++v) growth_[wall[v]] -= x[(v + 1) % 3].cross(x[(v + 2) % 3]) / 6;
    }
    for (std::size_t c = 0; c < corners_.size(); ++c) corners_[c].add_force(pressure_ * growth_[c], force);
    return -pressure_ * (volume - rest_volume_);
}

}  // namespace palpate::runtime
