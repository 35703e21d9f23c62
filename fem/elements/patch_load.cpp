#include "fem/elements/patch_load.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <map>
#include <optional>

#include "fem/elements/shape.h"
#include "fem/interpolation/nearest_face.h"
#include "mesh/errors.h"

namespace palpate::fem {

namespace {

/// Share of a contact that each node carries, ascending by node.
using NodeShares = std::map<int, double>;

/// A boundary face and a ball that holds it.
struct FaceBall {
    Vec3 center;
    double radius;
};

template <int nodes>
FaceBall ball_around(const Eigen::Matrix<double, nodes, 3>& X) {
    FaceBall ball{X.template topRows<3>().colwise().mean(), 0};
    for (int i = 0; i < nodes; ++i) {
        // A curved face lies in the hull of its corners and of Bezier points, a midside node doubled less the corners'
        // mean.
        Vec3 hull = X.row(i);
        if (i >= 3) hull = 2 * hull - (X.row(edge_corners[i - 3][0]) + X.row(edge_corners[i - 3][1])).transpose() / 2;
        ball.radius = std::max(ball.radius, (hull - ball.center).norm());
    }
    return ball;
}

/// Adds up the face's part of the disc: N dA over those small triangles whose centre lies in the ball around `point`.
template <int nodes>
class DiscSampler {
public:
    DiscSampler(const Eigen::Matrix<double, nodes, 3>& X, const Vec3& point, double radius)
        : X_(X), point_(point), radius_(radius) {}

    /// Columns of `corners` are barycentric coordinates in the face; `share`: of the face's reference area.
    void add(const Mat3& corners, double share) {
        const Eigen::Matrix<double, nodes, 1> N = shape<3, nodes>(corners.rowwise().mean());
        const Vec3 centre = X_.transpose() * N;
        double reach = 0, size = 0;
        Mat3 x;
        for (int k = 0; k < 3; ++k) x.col(k) = X_.transpose() * shape<3, nodes>(corners.col(k));
        for (int k = 0; k < 3; ++k) {
            reach = std::max(reach, (x.col(k) - centre).norm());
            size = std::max(size, (x.col(k) - x.col((k + 1) % 3)).norm());
        }
        const double distance = (centre - point_).norm();
        // The bow of a curved triangle is less than its reach.
        if (distance > radius_ + 2 * reach) return;
        if (size > radius_ / 12) return split(corners, share / 4);
        if (distance > radius_) return;
        const auto dN = shape_gradient<3, nodes>(corners.rowwise().mean());
        const Eigen::Matrix<double, 3, 2> tangents = X_.transpose() * dN;
        const double sub_area = share / 2 * tangents.col(0).cross(tangents.col(1)).norm();
        shares += sub_area * N;
        area += sub_area;
    }

    Eigen::Matrix<double, nodes, 1> shares = Eigen::Matrix<double, nodes, 1>::Zero();  // [mm^2]
    double area = 0;                                                                   // [mm^2]

private:
    void split(const Mat3& corners, double share) {
        Mat3 middles;  // of the sides opposite to each corner
        for (int k = 0; k < 3; ++k) middles.col(k) = (corners.col((k + 1) % 3) + corners.col((k + 2) % 3)) / 2;
        for (int k = 0; k < 3; ++k) {
            Mat3 part = middles;
            part.col(k) = corners.col(k);
            // In the corner's part, its own column stays and the other two middles are the sides next to it.
            add(part, share);
        }
        add(middles, share);
    }

    const Eigen::Matrix<double, nodes, 3>& X_;
    Vec3 point_;
    double radius_;
};

template <int nodes>
NodeShares disc_shares(const mesh::VolumeMesh& mesh, const std::vector<FaceBall>& balls, const mesh::Contact& contact) {
    NodeShares result;
    if (contact.radius <= 0) return result;
    double area = 0;
    for (std::size_t f = 0; f < balls.size(); ++f) {
        const double near = contact.radius + balls[f].radius;
        if ((balls[f].center - contact.point).squaredNorm() > near * near) continue;
        const auto face = mesh.faces.row(static_cast<Eigen::Index>(f));
        const auto X = node_positions<nodes>(mesh.nodes, face);
        DiscSampler<nodes> sampler(X, contact.point, contact.radius);
        sampler.add(Mat3::Identity(), 1.0);
        if (sampler.area == 0) continue;
        area += sampler.area;
        for (int i = 0; i < nodes; ++i) result[face(i)] += sampler.shares(i);
    }
    for (auto& [node, share] : result) share /= area;
    return result;
}

template <int nodes>
NodeShares point_shares(const mesh::VolumeMesh& mesh, const FacePoint& at) {
    NodeShares result;
    const Eigen::Matrix<double, nodes, 1> N = shape<3, nodes>(at.l);
    for (int i = 0; i < nodes; ++i) result[mesh.faces(at.face, i)] += N(i);
    return result;
}

void validate(const mesh::Contact& contact) {
    if (!(contact.radius >= 0) || !contact.point.allFinite() || !contact.force.allFinite()) {
        throw InvalidInput(
            fmt::format("A contact at ({:.6g}, {:.6g}, {:.6g}) mm has force ({:.6g}, {:.6g}, {:.6g}) N and radius "
                        "{:.6g} mm; place and "
                        "force have to be finite, the radius 0 or more.",
                        contact.point.x(), contact.point.y(), contact.point.z(), contact.force.x(), contact.force.y(),
                        contact.force.z(), contact.radius));
    }
}

template <int nodes>
Eigen::SparseMatrix<double> loads_of(const mesh::VolumeMesh& mesh, const std::vector<mesh::Contact>& contacts,
                                     double reach) {
    std::vector<FaceBall> balls(mesh.faces.rows());
    for (std::size_t f = 0; f < balls.size(); ++f) {
        balls[f] = ball_around<nodes>(node_positions<nodes>(mesh.nodes, mesh.faces.row(static_cast<Eigen::Index>(f))));
    }
    std::vector<NodeShares> shares(contacts.size());
    tbb::parallel_for(std::size_t(0), contacts.size(),
                      [&](std::size_t c) { shares[c] = disc_shares<nodes>(mesh, balls, contacts[c]); });

    // No surface in the disc, or no disc: the nearest point of the surface.
    std::optional<NearestFace> surface;
    for (std::size_t c = 0; c < contacts.size(); ++c) {
        if (!shares[c].empty()) continue;
        if (!surface) surface.emplace(mesh);
        const Vec3& point = contacts[c].point;
        const FacePoint nearest = surface->closest(point);
        if (nearest.distance > contacts[c].radius + reach) {
            throw InvalidInput(fmt::format(
                "The contact at ({:.6g}, {:.6g}, {:.6g}) mm lies {:.4g} mm off the surface; allowed: its radius of "
                "{:.4g} "
                "mm and {:.4g} mm more. The nearest surface point is ({:.6g}, {:.6g}, {:.6g}) mm: check the place, its "
                "unit, and that probes and body share one frame.",
                point.x(), point.y(), point.z(), nearest.distance, contacts[c].radius, reach, nearest.position.x(),
                nearest.position.y(), nearest.position.z()));
        }
        shares[c] = point_shares<nodes>(mesh, nearest);
    }

    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t c = 0; c < contacts.size(); ++c) {
        for (const auto& [node, share] : shares[c]) {
            for (int a = 0; a < 3; ++a) {
                entries.emplace_back(3 * node + a, static_cast<int>(c), share * contacts[c].force(a));
            }
        }
    }
    Eigen::SparseMatrix<double> loads(mesh.nodes.size(), static_cast<Eigen::Index>(contacts.size()));
    loads.setFromTriplets(entries.begin(), entries.end());
    return loads;
}

}  // namespace

Eigen::SparseMatrix<double> patch_loads(const mesh::VolumeMesh& mesh, const std::vector<mesh::Contact>& contacts,
                                        double reach) {
    for (const auto& contact : contacts) validate(contact);
    return mesh.is_quadratic() ? loads_of<6>(mesh, contacts, reach) : loads_of<3>(mesh, contacts, reach);
}

}  // namespace palpate::fem
