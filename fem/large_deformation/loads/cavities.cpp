#include "fem/large_deformation/loads/cavities.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "fem/elements/shape.h"
#include "mesh/errors.h"

namespace palpate::fem {

namespace {

/// A triple i < j < k of a face's nodes, and its part in the volume behind the face.
struct Triple {
    int i, j, k;
    double weight;  // V = sum weight det(x_i, x_j, x_k)
};

/// V = 1/3 int x . (x,1 cross x,2) is trilinear in the nodes' positions; the determinant takes the antisymmetric part
/// of int N_i N_j,1 N_k,2.
std::array<Triple, 20> triples() {
    const auto rule = triangle_quadrature_5();  // of degree 4 in the barycentric coordinates
    std::array<Triple, 20> result{};
    int count = 0;
    for (int i = 0; i < 6; ++i) {
        for (int j = i + 1; j < 6; ++j) {
            for (int k = j + 1; k < 6; ++k) {
                double sum = 0;
                for (const auto& [l, part] : rule) {
                    Eigen::Matrix<double, 6, 3> all;
                    all << shape<3, 6>(l), shape_gradient<3, 6>(l);
                    const Mat3 chosen = all(std::array{i, j, k}, Eigen::all);
                    sum += part / 2 * chosen.determinant();
                }
                result[count++] = {i, j, k, sum / 3};
            }
        }
    }
    return result;
}

const std::array<Triple, 20>& face_triples() {
    static const auto result = triples();
    return result;
}

double volume_of(const Eigen::Matrix<double, 3, 6>& x) {
    double sum = 0;
    for (const auto& [i, j, k, weight] : face_triples()) sum += weight * x.col(i).dot(x.col(j).cross(x.col(k)));
    return sum;
}

/// The boundary's parts: for each face the number of the first face that it is joined to by edges.
std::vector<int> parts(const Faces& faces) {
    std::vector<int> leader(faces.rows());
    std::iota(leader.begin(), leader.end(), 0);
    const auto find = [&](int f) {
        while (leader[f] != f) f = leader[f] = leader[leader[f]];
        return f;
    };
    // An edge is known by its midside.
    std::map<int, int> face_of;
    for (int f = 0; f < faces.rows(); ++f) {
        for (int m = 3; m < 6; ++m) {
            const auto [at, fresh] = face_of.try_emplace(faces(f, m), f);
            if (fresh) continue;
            const int one = find(at->second), other = find(f);
            leader[std::max(one, other)] = std::min(one, other);
        }
    }
    for (int f = 0; f < faces.rows(); ++f) leader[f] = find(f);
    return leader;
}

}  // namespace

Cavities::Cavities(const mesh::VolumeMesh& mesh) : nodes_(mesh.nodes) {
    // Volumes by outward orientation.
    const std::vector<int> part = parts(mesh.faces);
    std::map<int, double> enclosed;
    const Vec3 centre = mesh.nodes.colwise().mean();
    for (int f = 0; f < mesh.faces.rows(); ++f) {
        const auto x = node_positions<6>(mesh.nodes, mesh.faces.row(f));
        enclosed[part[f]] += volume_of(x.transpose().colwise() - centre);
    }
    std::map<int, std::vector<int>> walls;
    Vec3 sum = Vec3::Zero();
    int count = 0;
    for (int f = 0; f < mesh.faces.rows(); ++f) {
        if (enclosed[part[f]] >= 0) continue;
        sum += mesh.nodes.row(mesh.faces(f, 0)).transpose();
        walls[part[f]].push_back(f);
        ++count;
    }
    if (walls.empty()) return;
    origin_ = sum / count;
    nodes_.rowwise() -= origin_.transpose();
    for (const auto& [first, faces] : walls) walls_.push_back(boundary_faces_with_elements(mesh, faces));
}

double Cavities::distance(int cavity, const Vec3& point) const {
    double least = INFINITY;
    for (const BoundaryFace& face : walls_[cavity]) {
        for (const int node : face.node)
            least = std::min(least, (nodes_.row(node).transpose() + origin_ - point).norm());
    }
    return least;
}

int Cavities::find(const mesh::PressureActuator& actuator) const {
    if (empty())
        throw InvalidInput(
            "There is pressure in a cavity of a body that encloses none: its mesh must have a closed inner surface. "
            "Close "
            "the cavity, or take the pressure away.");
    constexpr Eigen::Index most = 50;  // vertices of a surface that are asked
    int best = 0;
    double nearest = INFINITY;
    for (int c = 0; c < count(); ++c) {
        double sum = 0;
        if (const auto* point = std::get_if<Vec3>(&actuator.cavity)) {
            sum = distance(c, *point);
        } else {
            const Points& vertices = std::get<mesh::Surface>(actuator.cavity).vertices;
            const Eigen::Index stride = std::max<Eigen::Index>(1, vertices.rows() / most);
            for (Eigen::Index v = 0; v < vertices.rows(); v += stride) sum += distance(c, vertices.row(v));
        }
        if (sum < nearest) best = c;
        nearest = std::min(nearest, sum);
    }
    return best;
}

Eigen::VectorXd Cavities::volumes(const Eigen::VectorXd& u) const {
    Eigen::VectorXd sums = Eigen::VectorXd::Zero(count());
    for (int c = 0; c < count(); ++c)
        for (const BoundaryFace& face : walls_[c]) sums[c] -= volume_of(positions(face, nodes_, u));
    return sums;
}

/// Calls visit(face, factor) for the walls of cavities whose factor is not zero.
template <class Visit>
void Cavities::for_each_wall(const Eigen::VectorXd& factors, const Visit& visit) const {
    for (int c = 0; c < count(); ++c) {
        if (factors[c] == 0) continue;
        for (const BoundaryFace& face : walls_[c]) visit(face, factors[c]);
    }
}

void Cavities::add_gradient(const Eigen::VectorXd& u, const Eigen::VectorXd& factors, Eigen::VectorXd& sum) const {
    for_each_wall(factors, [&](const BoundaryFace& face, double factor) {
        const FaceNodes x = positions(face, nodes_, u);
        FaceNodes by_node = FaceNodes::Zero();
        for (const auto& [i, j, k, weight] : face_triples()) {
            by_node.col(i) += weight * x.col(j).cross(x.col(k));
            by_node.col(j) += weight * x.col(k).cross(x.col(i));
            by_node.col(k) += weight * x.col(i).cross(x.col(j));
        }
        for (int i = 0; i < 6; ++i) sum.segment<3>(std::int64_t(3) * face.node[i]) -= factor * by_node.col(i);
    });
}

void Cavities::add_hessian(const Eigen::VectorXd& u, const Eigen::VectorXd& factors, const Unknowns& unknowns,
                           LowerMatrix& K) const {
    for_each_wall(factors, [&](const BoundaryFace& face, double factor) {
        const FaceNodes x = positions(face, nodes_, u);
        ElementTangent tangent;
        for (auto& block : tangent.blocks) block.setZero();
        // d^2 det(a, b, c) / da_c db_d = epsilon_cde c_e; the volume is the cavity's, behind the face.
        const auto add = [&](int a, int b, const Vec3& third) {
            const int i = face.local[a], j = face.local[b];
            for (int c = 0; c < 3; ++c) {
                for (int d = c + 1; d < 3; ++d) {
                    const double value = -factor * (d == c + 1 ? third(3 - c - d) : -third(3 - c - d));
                    auto& block = tangent.blocks[ElementTangent::block_of(c, d)];
                    block(i, j) += value;
                    block(j, i) -= value;
                }
            }
        };
        for (const auto& [i, j, k, weight] : face_triples()) {
            add(i, j, weight * x.col(k));
            add(j, k, weight * x.col(i));
            add(k, i, weight * x.col(j));
        }
        unknowns.add(face.element, tangent, K);
    });
}

}  // namespace palpate::fem
