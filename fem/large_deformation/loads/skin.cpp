#include "fem/large_deformation/loads/skin.h"

#include <numeric>

#include "fem/elements/shape.h"

namespace palpate::fem {

Skin::Skin(const mesh::VolumeMesh& mesh) : nodes_(mesh.nodes) {
    std::vector<int> all(static_cast<std::size_t>(mesh.faces.rows()));
    std::iota(all.begin(), all.end(), 0);
    faces_ = boundary_faces_with_elements(mesh, all);
    const auto rule = triangle_quadrature_5();
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(nodes_.size());
    for (const BoundaryFace& face : faces_) {
        const FaceNodes X = positions(face, nodes_, none);
        auto& points = points_.emplace_back();
        for (std::size_t q = 0; q < rule.size(); ++q) {
            points[q] = facet_point<6>(X, shape<3, 6>(rule[q].l), shape_gradient<3, 6>(rule[q].l), rule[q].weight);
        }
    }
}

Skin::FaceTerms Skin::terms(const SurfaceEnergies& effects, std::size_t face, const FaceNodes& x) const {
    FaceTerms sum;
    for (const FacetPoint<6>& point : points_[face]) {
        const FacetEnergy<6> energy(effects, point, x);
        sum.energy += energy.value();
        for (int i = 0; i < 6; ++i) sum.gradient.col(i) += energy.by_node(i);
    }
    return sum;
}

Skin::FaceHessian Skin::hessian(const SurfaceEnergies& effects, std::size_t face, const FaceNodes& x) const {
    FaceHessian sum = FaceHessian::Zero();
    for (const FacetPoint<6>& point : points_[face]) {
        const FacetEnergy<6> energy(effects, point, x);
        for (int i = 0; i < 6; ++i) {
            for (int j = 0; j < 6; ++j) sum.block<3, 3>(3 * i, 3 * j) += energy.by_nodes(i, j);
        }
    }
    return sum;
}

double Skin::add_gradient(const SurfaceEnergies& effects, bool linear, const Eigen::VectorXd& u, double factor,
                          Eigen::VectorXd& sum) const {
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(u.size());
    double energy = 0;
    for (std::size_t f = 0; f < faces_.size(); ++f) {
        const BoundaryFace& face = faces_[f];
        const FaceNodes x = positions(face, nodes_, u), X = positions(face, nodes_, none);
        FaceTerms own = terms(effects, f, linear ? X : x);
        if (linear) {
            const FaceNodes moved = x - X;
            FaceNodes change;
            change.reshaped() = hessian(effects, f, X) * moved.reshaped();
            own.energy += (own.gradient + change / 2).cwiseProduct(moved).sum();
            own.gradient += change;
        }
        energy += own.energy;
        for (int i = 0; i < 6; ++i) sum.segment<3>(std::int64_t(3) * face.node[i]) += factor * own.gradient.col(i);
    }
    return energy;
}

void Skin::add_hessian(const SurfaceEnergies& effects, bool linear, const Eigen::VectorXd& u, double factor,
                       const Unknowns& unknowns, LowerMatrix& K) const {
    const Eigen::VectorXd at = linear ? Eigen::VectorXd::Zero(u.size()) : u;
    for (std::size_t f = 0; f < faces_.size(); ++f) {
        const BoundaryFace& face = faces_[f];
        const FaceHessian H = factor * hessian(effects, f, positions(face, nodes_, at));
        ElementTangent tangent;
        for (auto& block : tangent.blocks) block.setZero();
        for (int i = 0; i < 6; ++i) {
            for (int j = 0; j < 6; ++j) {
                for (int c = 0; c < 3; ++c) {
                    for (int d = c; d < 3; ++d) {
                        tangent.blocks[ElementTangent::block_of(c, d)](face.local[i], face.local[j]) =
                            H(3 * i + c, 3 * j + d);
                    }
                }
            }
        }
        unknowns.add(face.element, tangent, K);
    }
}

}  // namespace palpate::fem
