#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <random>
#include <string>

#include "mesh/core/volume_mesh.h"

namespace palpate::fem {

enum class Kind { linear, quadratic, curved };

inline std::vector<char> nodes_where(const mesh::VolumeMesh& mesh, const std::function<bool(const Vec3&)>& condition) {
    std::vector<char> flags(mesh.nodes.rows());
    for (Eigen::Index i = 0; i < mesh.nodes.rows(); ++i) flags[i] = condition(mesh.nodes.row(i));
    return flags;
}

inline std::vector<char> boundary_nodes(const mesh::VolumeMesh& mesh) {
    std::vector<char> flags(mesh.nodes.rows(), 0);
    for (Eigen::Index k = 0; k < mesh.faces.size(); ++k) flags[mesh.faces.data()[k]] = 1;
    return flags;
}

/// A bar [0, size] whose inner nodes are jittered by a tenth of a cell; `curved`: all midside nodes bow besides.
inline mesh::VolumeMesh jittered_bar(Kind kind, const Vec3& size, const Eigen::Vector3i& cells) {
    std::mt19937 engine(7);
    const double cell = size.x() / cells.x();
    std::uniform_real_distribution<double> jitter(-0.1 * cell, 0.1 * cell), bow(-0.03 * cell, 0.03 * cell);
    mesh::VolumeMesh mesh = mesh::make_bar(Vec3::Zero(), size, cells);
    const std::vector<char> outside = boundary_nodes(mesh);
    const Eigen::Index corners = mesh.nodes.rows();
    for (Eigen::Index i = 0; i < corners; ++i) {
        for (int a = 0; a < 3 && !outside[i]; ++a) mesh.nodes(i, a) += jitter(engine);
    }
    if (kind == Kind::linear) return mesh;
    mesh = mesh::to_quadratic(mesh);
    for (Eigen::Index i = corners; i < mesh.nodes.rows() && kind == Kind::curved; ++i) {
        for (int a = 0; a < 3; ++a) mesh.nodes(i, a) += bow(engine);
    }
    return mesh;
}

/// A field at the nodes, as a vector of degrees of freedom (3n).
inline Eigen::VectorXd nodal(const mesh::VolumeMesh& mesh, const std::function<Vec3(const Vec3&)>& field) {
    Eigen::VectorXd u(mesh.nodes.size());
    for (Eigen::Index i = 0; i < mesh.nodes.rows(); ++i) u.segment<3>(3 * i) = field(mesh.nodes.row(i));
    return u;
}

}  // namespace palpate::fem
