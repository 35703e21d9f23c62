#include "fem/rig/surface_distance.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <map>

#include "mesh/errors.h"

namespace palpate::fem {

namespace {

std::vector<std::array<int, 3>> triangles_beyond(const std::string& name, const Triangles& triangles) {
    std::map<std::array<int, 2>, int> with_edge;  // directed; the neighbour runs along it the other way
    for (int t = 0; t < triangles.rows(); ++t) {
        for (int k = 0; k < 3; ++k) with_edge[{triangles(t, (k + 1) % 3), triangles(t, (k + 2) % 3)}] = t;
    }
    std::vector<std::array<int, 3>> beyond(static_cast<std::size_t>(triangles.rows()));
    for (int t = 0; t < triangles.rows(); ++t) {
        for (int k = 0; k < 3; ++k) {
            const int from = triangles(t, (k + 1) % 3), to = triangles(t, (k + 2) % 3);
            const auto other = with_edge.find({to, from});
            if (other == with_edge.end())
                throw InvalidInput(fmt::format(
                    "The surface of the tool \"{}\" is open at triangle {}, between its vertices {} and {}: "
                    "a tool is a closed surface, its faces turned outwards. Close the holes.",
                    name, t, from, to));
            beyond[t][k] = other->second;
        }
    }
    return beyond;
}

const mesh::Surface& checked(const std::string& name, const mesh::Surface& surface) {
    if (surface.triangles.rows() > 0 && mesh::signed_volume(surface) > 0) return surface;
    throw InvalidInput(
        fmt::format("The surface of the tool \"{}\" encloses {:g} mm^3; allowed: more than 0, with faces that look "
                    "outwards. Turn them round, or give another file.",
                    name, surface.triangles.rows() > 0 ? mesh::signed_volume(surface) : 0.0));
}

}  // namespace

SurfaceDistance::SurfaceDistance(const std::string& name, const mesh::Surface& surface)
    : surface_(checked(name, surface)),
      tree_(surface),
      face_normals_(mesh::area_vectors(surface).rowwise().normalized()),
      corner_normals_(mesh::vertex_normals(surface)),
      beyond_(triangles_beyond(name, surface.triangles)),
      radius_(mesh::bounding_box(surface.vertices).extent().minCoeff() / 2) {}

Gap SurfaceDistance::gap(const Vec3& y) const {
    constexpr double on_border = 1e-9;  // a barycentric coordinate that is none
    const mesh::SurfacePoint nearest = tree_.closest(y);
    const int t = nearest.triangle;
    std::array<int, 3> inner{};  // corners with a share
    int count = 0, outer = 0;
    for (int k = 0; k < 3; ++k) {
        if (nearest.barycentric[k] > on_border)
            inner[count++] = k;
        else
            outer = k;
    }
    const Vec3 face = face_normals_.row(t), arm = y - nearest.position;
    if (count == 3) return {face.dot(arm), face, Mat3::Zero()};

    // Of an edge or a corner: round it the distance curves.
    Vec3 towards;
    Mat3 across = Mat3::Identity();
    if (count == 2) {
        towards = face + face_normals_.row(beyond_[t][outer]).transpose();
        const Vec3 edge = (surface_.vertices.row(surface_.triangles(t, inner[1])) -
                           surface_.vertices.row(surface_.triangles(t, inner[0])))
                              .normalized();
        across -= edge * edge.transpose();
    } else {
        towards = corner_normals_.row(surface_.triangles(t, inner[0]));
    }
    const double distance = arm.norm();
    if (distance <= 1e-12 * radius_) return {0, towards.normalized(), Mat3::Zero()};
    const double side = towards.dot(arm) < 0 ? -1 : 1;
    const Vec3 n = side * arm / distance;
    return {side * distance, n, side * (across - n * n.transpose()) / distance};
}

}  // namespace palpate::fem
