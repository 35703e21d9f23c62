#include "skeleton/effects/point_sets.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <limits>
#include <numbers>

#include "mesh/errors.h"
#include "skeleton/model/attachment/attach.h"

namespace palpate::skeleton {

namespace {

PointSet material(const Model& model) {
    PointSet set;
    set.weights.resize(static_cast<Eigen::Index>(model.spheres.size()));
    for (int i = 0; i < static_cast<int>(model.spheres.size()); ++i) {
        set.at.push_back(on_sphere(model, i, model.spheres[i].center));
        set.weights[i] = model.spheres[i].mass;
    }
    return set;
}

Eigen::VectorXd vertex_areas(const mesh::Surface& surface) {
    Eigen::VectorXd areas = Eigen::VectorXd::Zero(surface.vertices.rows());
    const Eigen::VectorXd of_triangles = mesh::area_vectors(surface).rowwise().norm();
    for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t)
        for (const int vertex : surface.triangles.row(t)) areas[vertex] += of_triangles[t] / 3;
    return areas;
}

PointSet surface(const Model& model) {
    if (model.skin.empty() || model.surface.triangles.rows() == 0)
        throw InvalidInput("the model has no skin, on which an effect acts: give it one, or take the effect away");
    return {model.skin, vertex_areas(model.surface)};
}

// The held spheres that bear the support.
std::vector<int> bearing_spheres(const Model& model) {
    std::vector<char> linked(model.spheres.size(), 0);
    for (const Link& link : model.links) linked[link.a] = linked[link.b] = 1;
    std::vector<int> held, bearing;
    for (int i = 0; i < static_cast<int>(model.spheres.size()); ++i) {
        if (!model.spheres[i].held) continue;
        held.push_back(i);
        if (linked[i]) bearing.push_back(i);
    }
    if (held.empty())
        throw InvalidInput(
            fmt::format("none of the model's {} spheres is held, so an effect of the support has nothing to act on: "
                        "let a support hold one, or set its 'held' to true",
                        model.spheres.size()));
    return bearing.empty() ? held : bearing;
}

int nearest(const Model& model, const std::vector<int>& spheres, const Vec3& point) {
    int best = spheres.front();
    double least = std::numeric_limits<double>::infinity();
    for (const int i : spheres) {
        const double distance = (point - model.spheres[i].center).norm() - model.spheres[i].radius;
        if (distance >= least) continue;
        least = distance;
        best = i;
    }
    return best;
}

// Points of a support, on the held sphere that bears them, with areas.
class SupportPoints {
public:
    explicit SupportPoints(const Model& model) : model_(model), bearing_(bearing_spheres(model)) {
        add_skin();
        for (const int i : bearing_)
            if (!keeps_from_turning(i)) add_axes(i);
    }

    PointSet set() const {
        PointSet set;
        const auto n = static_cast<Eigen::Index>(points_.size());
        set.weights.resize(n);
        for (Eigen::Index i = 0; i < n; ++i) {
            const auto& [sphere, at, area] = points_[i];
            set.at.push_back(on_sphere(model_, sphere, at));
            set.weights[i] = area;
        }
        set.weights /= set.weights.sum();
        return set;
    }

private:
    struct Point {
        int sphere;
        Vec3 at;
        double area;  // [mm^2]
    };

    void add_skin() {
        const Eigen::VectorXd areas = vertex_areas(model_.surface);
        const std::vector<char> held = mesh::contains(model_.supports, model_.surface.vertices);
        for (Eigen::Index v = 0; v < areas.size(); ++v) {
            const Vec3 at = model_.surface.vertices.row(v).transpose();
            if (held[v] && areas[v] > 0) points_.push_back({nearest(model_, bearing_, at), at, areas[v]});
        }
    }

    void add_axes(int sphere) {
        const Vec3& center = model_.spheres[sphere].center;
        const double radius = model_.spheres[sphere].radius;
        for (int axis = 0; axis < 3; ++axis)
            for (const double sign : {1.0, -1.0})
                points_.push_back(
                    {sphere, center + sign * radius * Vec3::Unit(axis), std::numbers::pi * radius * radius / 6});
    }

    // Springs on points that spread in two directions at least hold a sphere against any turn.
    bool keeps_from_turning(int sphere) const {
        double area = 0;
        Vec3 first = Vec3::Zero();
        Mat3 second = Mat3::Zero();
        for (const Point& point : points_) {
            if (point.sphere != sphere) continue;
            const Vec3 arm = point.at - model_.spheres[sphere].center;
            area += point.area;
            first += point.area * arm;
            second += point.area * arm * arm.transpose();
        }
        if (area == 0) return false;
        constexpr double spread = 0.1;  // of the points, of the radius
        const Mat3 scatter = second / area - first * first.transpose() / (area * area);
        const Vec3 squares = Eigen::SelfAdjointEigenSolver<Mat3>(scatter, Eigen::EigenvaluesOnly).eigenvalues();
        const double radius = model_.spheres[sphere].radius;
        return squares[1] > spread * spread * radius * radius;
    }

    const Model& model_;
    std::vector<int> bearing_;
    std::vector<Point> points_;
};

}  // namespace

PointSet point_set(const Model& model, fem::ActsOn acts_on) {
    switch (acts_on) {
        case fem::ActsOn::surface:
            return surface(model);
        case fem::ActsOn::support:
            return SupportPoints(model).set();
        case fem::ActsOn::material:
            break;
    }
    return material(model);
}

}  // namespace palpate::skeleton
