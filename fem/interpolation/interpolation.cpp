#include "fem/interpolation/interpolation.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <map>

#include "fem/elements/shape.h"
#include "fem/interpolation/element_locator.h"
#include "fem/interpolation/nearest_face.h"

namespace palpate::fem {

namespace {

/// The element behind each boundary face, by the face's corners.
std::vector<int> elements_of_faces(const mesh::VolumeMesh& mesh) {
    using Corners = std::array<int, 3>;
    std::map<Corners, int> face_of;
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
        Corners corners{mesh.faces(f, 0), mesh.faces(f, 1), mesh.faces(f, 2)};
        std::ranges::sort(corners);
        face_of[corners] = static_cast<int>(f);
    }
    std::vector<int> result(mesh.faces.rows(), -1);
    for (Eigen::Index e = 0; e < mesh.tetrahedra.rows(); ++e) {
        for (int opposite = 0; opposite < 4; ++opposite) {
            Corners corners{};
            for (int k = 0; k < 3; ++k) corners[k] = mesh.tetrahedra(e, (opposite + 1 + k) % 4);
            std::ranges::sort(corners);
            const auto found = face_of.find(corners);
            if (found != face_of.end()) result[found->second] = static_cast<int>(e);
        }
    }
    return result;
}

double mean_edge(const mesh::VolumeMesh& mesh, int element) {
    double sum = 0;
    for (const auto& [a, b] : edge_corners) {
        sum += (mesh.nodes.row(mesh.tetrahedra(element, a)) - mesh.nodes.row(mesh.tetrahedra(element, b))).norm();
    }
    return sum / 6;
}

/// Coordinates in the nearest element of a point outside of the body.
class OutsideLocator {
public:
    explicit OutsideLocator(const mesh::VolumeMesh& mesh)
        : mesh_(mesh), surface_(mesh), elements_(elements_of_faces(mesh)) {}

    ElementPoint find(const Vec3& point) const {
        const FacePoint nearest = surface_.closest(point);
        ElementPoint result{.element = elements_[nearest.face]};
        if (nearest.distance <= mean_edge(mesh_, result.element) / 2) {
            if (const auto l = local_coordinates(mesh_, result.element, point)) {
                result.l = *l;
                return result;
            }
        }
        for (int k = 0; k < 4; ++k) {
            for (int c = 0; c < 3; ++c) {
                if (mesh_.tetrahedra(result.element, k) == mesh_.faces(nearest.face, c)) result.l(k) = nearest.l(c);
            }
        }
        return result;
    }

private:
    const mesh::VolumeMesh& mesh_;
    NearestFace surface_;
    std::vector<int> elements_;
};

}  // namespace

Eigen::SparseMatrix<double, Eigen::RowMajor> interpolation(const mesh::VolumeMesh& mesh, const Points& points) {
    const Eigen::Index count = points.rows(), width = mesh.tetrahedra.cols();
    std::vector<ElementPoint> found(count);
    const ElementLocator locator(mesh);
    tbb::parallel_for(Eigen::Index(0), count,
                      [&](Eigen::Index p) { found[p] = locator.find(points.row(p)).value_or(ElementPoint{}); });
    if (std::ranges::any_of(found, [](const ElementPoint& at) { return at.element < 0; })) {
        const OutsideLocator outside(mesh);
        tbb::parallel_for(Eigen::Index(0), count, [&](Eigen::Index p) {
            if (found[p].element < 0) found[p] = outside.find(points.row(p));
        });
    }

    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(count * width);
    for (Eigen::Index p = 0; p < count; ++p) {
        const Eigen::Vector4d& l = found[p].l;
        const Eigen::VectorXd N = mesh.is_quadratic() ? Eigen::VectorXd(shape<4, 10>(l)) : Eigen::VectorXd(l);
        for (Eigen::Index k = 0; k < width; ++k) {
            entries.emplace_back(static_cast<int>(p), mesh.tetrahedra(found[p].element, k), N(k));
        }
    }
    Eigen::SparseMatrix<double, Eigen::RowMajor> weights(count, mesh.nodes.rows());
    weights.setFromTriplets(entries.begin(), entries.end());
    return weights;
}

}  // namespace palpate::fem
