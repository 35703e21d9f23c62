#include "fem/elements/restraint.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <numeric>

#include "mesh/errors.h"

namespace palpate::fem {

namespace {

/// For each node the smallest node of its part, where elements that share a node are one part.
std::vector<int> parts(const Tetrahedra& tetrahedra, Eigen::Index nodes) {
    std::vector<int> parent(nodes);
    std::iota(parent.begin(), parent.end(), 0);
    const auto root = [&](int i) {
        while (parent[i] != i) i = parent[i] = parent[parent[i]];
        return i;
    };
    for (Eigen::Index e = 0; e < tetrahedra.rows(); ++e) {
        for (Eigen::Index k = 1; k < tetrahedra.cols(); ++k) {
            const int a = root(tetrahedra(e, 0)), b = root(tetrahedra(e, k));
            parent[std::max(a, b)] = std::min(a, b);
        }
    }
    for (int i = 0; i < nodes; ++i) parent[i] = root(i);
    return parent;
}

struct Part {
    int nodes = 0, held = 0;
    Vec3 sum = Vec3::Zero(), held_sum = Vec3::Zero();
    Mat3 held_squares = Mat3::Zero();

    /// Rms distance of the held nodes from the line that fits them best.
    double held_width() const {
        const Mat3 spread = held_squares / held - held_sum * held_sum.transpose() / (1.0 * held * held);
        const Vec3 squares = Eigen::SelfAdjointEigenSolver<Mat3>(spread).eigenvalues();
        return std::sqrt(std::max(0.0, squares(0) + squares(1)));
    }
};

}  // namespace

void check_restraint(const mesh::VolumeMesh& mesh, const std::vector<char>& held) {
    const mesh::Box box = mesh::bounding_box(mesh.nodes);
    const auto count = std::ranges::count_if(held, [](char flag) { return flag != 0; });
    if (count == 0) {
        throw InvalidInput(fmt::format(
            "Nothing is held: no node of the body, which spans ({:.4g}, {:.4g}, {:.4g}) to ({:.4g}, {:.4g}, "
            "{:.4g}) mm, lies in a support. Enlarge the supports or move them onto the body.",
            box.min.x(), box.min.y(), box.min.z(), box.max.x(), box.max.y(), box.max.z()));
    }
    if (count == mesh.nodes.rows()) {
        throw InvalidInput(fmt::format(
            "All {} nodes of the body lie in a support: nothing can move. Make the supports smaller.", count));
    }

    // Positions are taken from the box's centre, in units of its diagonal.
    const Vec3 centre = (box.min + box.max) / 2;
    const std::vector<int> part_of = parts(mesh.tetrahedra, mesh.nodes.rows());
    std::vector<Part> found(mesh.nodes.rows());
    for (Eigen::Index i = 0; i < mesh.nodes.rows(); ++i) {
        Part& part = found[part_of[i]];
        const Vec3 x = (mesh.nodes.row(i).transpose() - centre) / box.diagonal();
        ++part.nodes;
        part.sum += x;
        if (!held[i]) continue;
        ++part.held;
        part.held_sum += x;
        part.held_squares += x * x.transpose();
    }
    for (std::size_t i = 0; i < found.size(); ++i) {
        const Part& part = found[i];
        if (part.nodes == 0) continue;
        const Vec3 at = centre + box.diagonal() * part.sum / part.nodes;
        if (part.nodes == 1) {
            throw InvalidInput(fmt::format(
                "Node {} of the volume mesh, at ({:.4g}, {:.4g}, {:.4g}) mm, belongs to no element. Remove it.", i,
                at.x(), at.y(), at.z()));
        }
        // Single precision positions on one line have a width of about 1e-7.
        if (part.held < 3 || part.held_width() < 1e-6) {
            throw InvalidInput(fmt::format(
                "The part of the body around ({:.4g}, {:.4g}, {:.4g}) mm ({} nodes) can move as a rigid body: {} of "
                "its "
                "nodes are held; at least three are needed, not on one line. Enlarge the supports, or add one there.",
                at.x(), at.y(), at.z(), part.nodes, part.held));
        }
    }
}

}  // namespace palpate::fem
