#include "fem/large_deformation/loads/placed_tendon.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "fem/interpolation/element_locator.h"
#include "fem/interpolation/interpolation.h"
#include "fem/interpolation/nearest_face.h"
#include "mesh/errors.h"

namespace palpate::fem {

namespace {

void require_within(const mesh::VolumeMesh& mesh, const Points& path) {
    const ElementLocator locator(mesh);
    for (Eigen::Index k = 1; k < path.rows(); ++k) {
        if (locator.find(path.row(k))) continue;
        const FacePoint nearest = NearestFace(mesh).closest(path.row(k));
        const auto face = mesh.faces.row(nearest.face);
        const double edge = (mesh.nodes.row(face(0)) - mesh.nodes.row(face(1))).norm();
        if (nearest.distance <= edge / 2) continue;
        throw InvalidInput(
            fmt::format("Point {} of a tendon's path, ({:g}, {:g}, {:g}) mm, lies {:.3g} mm outside of the body; "
                        "allowed: all but the first within it. Move it to ({:g}, {:g}, {:g}), or leave it out.",
                        k + 1, path(k, 0), path(k, 1), path(k, 2), nearest.distance, nearest.position.x(),
                        nearest.position.y(), nearest.position.z()));
    }
}

}  // namespace

TendonPath::TendonPath(const mesh::VolumeMesh& mesh, const mesh::TendonActuator& tendon) {
    require_within(mesh, tendon.path);
    const Eigen::SparseMatrix<double, Eigen::RowMajor> N = interpolation(mesh, tendon.path);
    std::set<int> all;
    carriers.resize(static_cast<std::size_t>(tendon.path.rows()));
    for (int k = 1; k < tendon.path.rows(); ++k) {
        for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator entry(N, k); entry; ++entry) {
            if (entry.value() == 0) continue;
            carriers[k].emplace_back(static_cast<int>(entry.col()), entry.value());
            all.insert(static_cast<int>(entry.col()));
        }
    }
    nodes.assign(all.begin(), all.end());
}

const TendonPath& TendonPaths::operator()(const mesh::VolumeMesh& mesh,
                                          const std::shared_ptr<const mesh::TendonActuator>& tendon) const {
    const std::scoped_lock lock(mutex_);
    auto& path = known_[tendon];
    if (!path) path = std::make_unique<const TendonPath>(mesh, *tendon);
    return *path;
}

Points PlacedTendon::place(const Eigen::VectorXd& u) const {
    Points x = pull_.actuator->path;
    for (Eigen::Index k = 1; k < x.rows(); ++k) {
        for (const auto& [node, weight] : path_.carriers[k])
            x.row(k) += weight * u.segment<3>(std::int64_t(3) * node).transpose();
    }
    return x;
}

TendonTerms PlacedTendon::terms(const Eigen::VectorXd& u) const { return tendon_terms(pull_, place(u), small_strain_); }

TendonFriction PlacedTendon::friction(const Eigen::VectorXd& u) const {
    return tendon_friction(pull_, place(u), small_strain_);
}

/// Adds what there is at each point to the nodes that carry it.
void PlacedTendon::add(const Points& at_points, Eigen::Ref<Eigen::VectorXd> sum) const {
    for (Eigen::Index k = 1; k < at_points.rows(); ++k) {
        for (const auto& [node, weight] : path_.carriers[k])
            sum.segment<3>(std::int64_t(3) * node) += weight * at_points.row(k).transpose();
    }
}

double PlacedTendon::add_gradient(const Eigen::VectorXd& u, double factor, Eigen::VectorXd& sum) const {
    const TendonTerms own = terms(u);
    add(factor * own.gradient, sum);
    return own.energy;
}

Eigen::MatrixXd PlacedTendon::derivative(const Eigen::VectorXd& u) const {
    const TendonTerms own = terms(u);
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(u.size(), 2);
    add(-own.lengthening, result.col(0));
    add(own.stiffness * own.lengthening, result.col(1));
    return result;
}

Eigen::VectorXd PlacedTendon::push(const Eigen::VectorXd& u) const {
    Eigen::VectorXd result = Eigen::VectorXd::Zero(u.size());
    add(-terms(u).by_value, result);
    return result;
}

TendonSliding PlacedTendon::sliding(const Eigen::VectorXd& u) const {
    const TendonSliding own = tendon_sliding(pull_, place(u), small_strain_);
    const auto by_nodes = [&](const Eigen::MatrixXd& columns) {
        Eigen::MatrixXd result = Eigen::MatrixXd::Zero(u.size(), columns.cols());
        for (Eigen::Index c = 0; c < columns.cols(); ++c) {
            const Eigen::VectorXd column = columns.col(c);
            add(Eigen::Map<const Points>(column.data(), column.size() / 3, 3), result.col(c));
        }
        return result;
    };
    return {by_nodes(own.by_number), by_nodes(own.number_by_point.transpose()).transpose()};
}

void PlacedTendon::add_hessian(const Eigen::VectorXd& u, const Unknowns& unknowns, LowerMatrix& K) const {
    // By the nodes, each once: S^T H S, S the shares of these in the points.
    const TendonTerms own = terms(u);
    const auto place = [&](int node) { return std::ranges::lower_bound(path_.nodes, node) - path_.nodes.begin(); };
    Eigen::MatrixXd S = Eigen::MatrixXd::Zero(own.hessian.rows(), 3 * std::ssize(path_.nodes));
    for (std::size_t k = 1; k < path_.carriers.size(); ++k) {
        for (const auto& [node, weight] : path_.carriers[k])
            S.block<3, 3>(3 * static_cast<Eigen::Index>(k), 3 * place(node)).diagonal().setConstant(weight);
    }
    const Eigen::MatrixXd H = S.transpose() * own.hessian * S;
    for (std::size_t i = 0; i < path_.nodes.size(); ++i) {
        for (std::size_t j = i; j < path_.nodes.size(); ++j) {
            unknowns.add(path_.nodes[i], path_.nodes[j],
                         H.block<3, 3>(3 * static_cast<Eigen::Index>(i), 3 * static_cast<Eigen::Index>(j)), K);
        }
    }
}

}  // namespace palpate::fem
