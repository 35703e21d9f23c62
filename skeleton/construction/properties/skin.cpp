#include "skeleton/construction/properties/skin.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "fem/elastic_body.h"
#include "fem/interpolation/interpolation.h"
#include "mesh/numbers/median.h"
#include "skeleton/model/attachment/attach.h"
#include "skeleton/model/state.h"

namespace palpate::skeleton {
namespace {

constexpr int carriers = 6;            // spheres that carry a vertex
constexpr double reach = 0.45;         // sd of the weights, of the links' median length
constexpr double ridge = 1e-3;         // of the mean square of what spheres move
constexpr int most_corners = 8000;     // of a body whose elements are quadratic, or are made so
constexpr double most_poisson = 0.4;   // that linear ones bear without locking
constexpr int hops = 2;                // over links, to the spheres that may carry a vertex
constexpr double splinter = 0.2;       // of the median cell: smaller spheres carry no vertex
constexpr double past_last = 1.2;      // of the distance of the last sphere, where none is left out: it counts, too
constexpr double least_window = 1e-4;  // of a sphere at the edge: a softness stays a number

using Mat36 = Eigen::Matrix<double, 3, 6>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

// How a rigid motion (d, w) about X moves the point x: d + w x (x - X).
Mat36 rigid(const Vec3& x, const Vec3& X) {
    Mat36 A;
    A << Mat3::Identity(), -skew(x - X);
    return A;
}

// The spheres' answers to unit forces and torques on the free ones, as the body gives them.
struct Condensed {
    std::vector<int> place;  // of each sphere among the free ones, -1: held
    Eigen::MatrixXd PP;      // sum over the loads of the spheres' steps (6F x 6F), each load scaled alike
    Eigen::MatrixXd YP;      // the surface's displacements with the spheres' steps (3V x 6F)
};

// E: the mean motion of each free sphere's cell (6F x 3n), by least squares over its volume.
Eigen::SparseMatrix<double> mean_motions(const mesh::VolumeMesh& body, const TetGraph& graph,
                                         const std::vector<int>& owner, const Model& model,
                                         const std::vector<int>& place) {
    const Eigen::SparseMatrix<double, Eigen::RowMajor> shape = fem::interpolation(body, graph.centers);
    std::vector<Mat6> moments(model.spheres.size(), Mat6::Zero());
    for (int t = 0; t < graph.size(); ++t) {
        const Mat36 A = rigid(graph.centers.row(t), model.spheres[owner[t]].center);
        moments[owner[t]] += graph.volumes(t) * A.transpose() * A;
    }
    std::vector<Eigen::LDLT<Mat6>> inverse(moments.begin(), moments.end());
    std::vector<Eigen::Triplet<double>> entries;
    for (int t = 0; t < graph.size(); ++t) {
        const int sphere = owner[t];
        if (place[sphere] < 0) continue;
        const Mat36 A = rigid(graph.centers.row(t), model.spheres[sphere].center);
        const Eigen::Matrix<double, 6, 3> W = graph.volumes(t) * inverse[sphere].solve(A.transpose());
        for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator N(shape, t); N; ++N) {
            for (int i = 0; i < 6; ++i) {
                for (int c = 0; c < 3; ++c) {
                    entries.emplace_back(6 * place[sphere] + i, 3 * static_cast<int>(N.col()) + c, N.value() * W(i, c));
                }
            }
        }
    }
    const auto free = std::ranges::count_if(place, [](int p) { return p >= 0; });
    Eigen::SparseMatrix<double> E(6 * free, 3 * body.nodes.rows());
    E.setFromTriplets(entries.begin(), entries.end());
    return E;
}

mesh::VolumeMesh without_midsides(const mesh::VolumeMesh& body) {
    if (!body.is_quadratic()) return body;
    std::vector<int> row(body.nodes.rows(), -1), corners;
    for (const int node : body.tetrahedra.leftCols<4>().reshaped()) row[node] = 0;
    for (int node = 0; node < body.nodes.rows(); ++node) {
        if (row[node] < 0) continue;
        row[node] = static_cast<int>(corners.size());
        corners.push_back(node);
    }
    const auto renumbered = [&](int node) { return row[node]; };
    return {body.nodes(corners, Eigen::all), body.tetrahedra.leftCols<4>().unaryExpr(renumbered),
            body.faces.leftCols<3>().unaryExpr(renumbered)};
}

Condensed condense(const mesh::VolumeMesh& body, const fem::Material& material, const TetGraph& graph,
                   const std::vector<int>& owner, const Model& model) {
    Condensed result;
    int free = 0;
    for (const Sphere& sphere : model.spheres) result.place.push_back(sphere.held ? -1 : free++);
    // A skin from a wrong Poisson's ratio is somewhat worse, and one from hundreds of thousands of nodes too slow.
    const mesh::VolumeMesh corners_only = without_midsides(body);
    const bool is_large = corners_only.nodes.rows() > most_corners;
    const mesh::VolumeMesh elements = is_large ? corners_only : mesh::to_quadratic(body);
    fem::Material of_elements = material;
    if (is_large) of_elements.poisson = std::min(material.poisson, most_poisson);
    const Eigen::SparseMatrix<double> E = mean_motions(elements, graph, owner, model, result.place);
    const fem::ElasticBody elastic(elements, of_elements, mesh::contains(model.supports, elements.nodes));
    const Eigen::MatrixXd C = elastic.solve(Eigen::SparseMatrix<double>(E.transpose()));

    const Eigen::SparseMatrix<double, Eigen::RowMajor> shape = fem::interpolation(elements, model.surface.vertices);
    Eigen::MatrixXd Y(3 * shape.rows(), C.cols());
    Y.setZero();
    for (Eigen::Index v = 0; v < shape.rows(); ++v) {
        for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator N(shape, v); N; ++N) {
            Y.middleRows<3>(3 * v) += N.value() * C.middleRows<3>(Eigen::Index{3} * N.col());
        }
    }
    // Each load counts by what it moves, not by how many Newtons it has.
    const Eigen::VectorXd scale =
        (Y.colwise().squaredNorm() / static_cast<double>(Y.rows())).cwiseMax(1e-300).cwiseInverse();
    const Eigen::MatrixXd Q = E * C;
    result.PP = Q * scale.asDiagonal() * Q.transpose();
    result.YP = Y * (scale.asDiagonal() * Q.transpose());
    return result;
}

// The spheres that may carry a vertex that hangs at `home`.
std::vector<int> within_hops(const std::vector<std::vector<int>>& neighbours, const std::vector<int>& home) {
    std::vector<int> found = home;
    std::size_t begin = 0;
    for (int hop = 0; hop < hops; ++hop) {
        const std::size_t end = found.size();
        for (; begin < end; ++begin) {
            for (const int next : neighbours[found[begin]]) {
                if (std::ranges::find(found, next) == found.end()) found.push_back(next);
            }
        }
    }
    return found;
}

class SkinMaker {
public:
    SkinMaker(const Model& model, const Condensed& condensed)
        : model_(model), condensed_(condensed), neighbours_(model.spheres.size()) {
        for (const Link& link : model.links) {
            neighbours_[link.a].push_back(link.b);
            neighbours_[link.b].push_back(link.a);
        }
        std::vector<double> cells, lengths;
        for (const Sphere& sphere : model.spheres) cells.push_back(sphere.cell);
        for (const Link& link : model.links) lengths.push_back(link.length);
        splinter_ = splinter * mesh::upper_median(cells);
        spacing_ = mesh::upper_median(lengths);
    }

    Attachment operator()(Eigen::Index vertex) const {
        const Vec3 x = model_.surface.vertices.row(vertex);
        Attachment point{{}, x};
        const std::vector<std::pair<double, int>> near = nearest(x);
        give_weights(x, near, point);
        follow_the_body(vertex, near, point);
        return point;
    }

private:
    // The nearest spheres and their distances, one more than carry the vertex.
    std::vector<std::pair<double, int>> nearest(const Vec3& x) const {
        std::vector<int> home;
        for (const SphereInfluence& share : attach_to_links(model_, x).shares) home.push_back(share.sphere);
        std::vector<std::pair<double, int>> near;
        for (const int i : within_hops(neighbours_, home)) {
            const Sphere& sphere = model_.spheres[i];
            if (sphere.cell < splinter_) continue;  // what moves it is hardly more than the patch of skin above it
            near.emplace_back((x - sphere.center).norm(), i);
        }
        if (near.empty()) near.emplace_back((x - model_.spheres[home[0]].center).norm(), home[0]);
        std::ranges::sort(near);
        near.resize(std::min<std::size_t>(near.size(), carriers + 1));
        return near;
    }

    // Gaussian in the distance, and falling to nothing at that of the first sphere that is left out.
    void give_weights(const Vec3& x, const std::vector<std::pair<double, int>>& near, Attachment& point) const {
        const double h = reach * spacing_, first = near.front().first;
        const auto bell = [&](double d) { return std::exp((first * first - d * d) / (2 * h * h)); };
        const double least = near.size() > carriers ? bell(near.back().first) : 0;
        double sum = 0;
        for (std::size_t i = 0; i < std::min<std::size_t>(near.size(), carriers); ++i) {
            const SphereInfluence share{.sphere = near[i].second, .weight = bell(near[i].first) - least};
            sum += share.weight;
            point.shares.push_back(share);
        }
        if (!(sum > 0)) {
            point.shares.resize(1);
            sum = point.shares[0].weight = 1;
        }
        for (SphereInfluence& share : point.shares) {
            share.weight /= sum;
            share.follow = share.weight * rigid(x, model_.spheres[share.sphere].center);
        }
    }

    void follow_the_body(Eigen::Index vertex, const std::vector<std::pair<double, int>>& near,
                         Attachment& point) const {
        // what the free spheres move beside their mean: features F of the steps of all that carry the vertex
        const int k = static_cast<int>(point.shares.size());
        Vec3 X = Vec3::Zero();
        for (const SphereInfluence& share : point.shares) X += share.weight * model_.spheres[share.sphere].center;
        std::vector<int> moving;
        for (int i = 0; i < k; ++i) {
            if (condensed_.place[point.shares[i].sphere] >= 0) moving.push_back(i);
        }
        if (moving.empty()) return;
        const auto rows = 6 * static_cast<Eigen::Index>(moving.size());
        Eigen::MatrixXd F = Eigen::MatrixXd::Zero(rows, 6 * k);
        Eigen::VectorXd softness(rows);
        const double furthest = near.size() > carriers ? near.back().first : past_last * near.back().first;
        for (std::size_t m = 0; m < moving.size(); ++m) {
            const auto row = 6 * static_cast<Eigen::Index>(m);
            F.block<6, 6>(row, 6 * moving[m]).setIdentity();
            const Vec3 arm = model_.spheres[point.shares[moving[m]].sphere].center - X;
            for (int j = 0; j < k; ++j) {
                const double w = point.shares[j].weight;
                F.block<3, 3>(row, 6 * j) -= w * Mat3::Identity();
                F.block<3, 3>(row, 6 * j + 3) += w * skew(arm);
                F.block<3, 3>(row + 3, 6 * j + 3) -= w * Mat3::Identity();
            }
            F.middleRows<3>(row + 3) *= spacing_;
            // those that are about to be left out count little, so that the skin has no seams
            const double window = 1 - std::pow(near[moving[m]].first / furthest, 2);
            softness.segment<6>(row).setConstant(1 / std::pow(std::max(window, least_window), 2));
        }

        // ridge regression of what the vertex moves beyond the mean
        Eigen::MatrixXd PP = Eigen::MatrixXd::Zero(6 * k, 6 * k), YP = Eigen::MatrixXd::Zero(3, 6 * k), base(3, 6 * k);
        for (int i = 0; i < k; ++i) {
            const int p = condensed_.place[point.shares[i].sphere];
            base.middleCols<6>(6 * i) = point.shares[i].follow;
            if (p < 0) continue;
            YP.middleCols<6>(6 * i) = condensed_.YP.block<3, 6>(3 * vertex, 6 * p);
            for (int j = 0; j < k; ++j) {
                const int q = condensed_.place[point.shares[j].sphere];
                if (q >= 0) PP.block<6, 6>(6 * i, 6 * j) = condensed_.PP.block<6, 6>(6 * p, 6 * q);
            }
        }
        Eigen::MatrixXd H = F * PP * F.transpose();
        H.diagonal() += ridge * H.trace() / static_cast<double>(rows) * softness;
        const Eigen::MatrixXd beyond = (YP - base * PP) * F.transpose();
        const Eigen::MatrixXd C = H.ldlt().solve(beyond.transpose()).transpose();
        const Eigen::MatrixXd more = C * F;
        for (int i = 0; i < k; ++i) point.shares[i].follow += more.middleCols<6>(6 * i);
    }

    const Model& model_;
    const Condensed& condensed_;
    std::vector<std::vector<int>> neighbours_;
    double spacing_ = 0;   // median length of the links [mm]
    double splinter_ = 0;  // cells below it are left over from others [mm^3]
};

// What a support holds stays on the nearest held sphere.
Attachment on_held(const Model& model, const Vec3& x) {
    int best = -1;
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < static_cast<int>(model.spheres.size()); ++i) {
        const double distance = (x - model.spheres[i].center).norm();
        if (!model.spheres[i].held || distance >= least) continue;
        best = i;
        least = distance;
    }
    return best < 0 ? attach_to_links(model, x) : on_sphere(model, best, x);
}

}  // namespace

std::vector<Attachment> make_skin(const mesh::VolumeMesh& body, const fem::Material& material, const TetGraph& graph,
                                  const std::vector<int>& owner, const Model& model) {
    const Condensed condensed = condense(body, material, graph, owner, model);
    const SkinMaker maker(model, condensed);
    const std::vector<char> held = mesh::contains(model.supports, model.surface.vertices);
    std::vector<Attachment> skin;
    skin.reserve(held.size());
    for (Eigen::Index v = 0; v < model.surface.vertices.rows(); ++v) {
        skin.push_back(held[v] ? on_held(model, model.surface.vertices.row(v)) : maker(v));
    }
    return skin;
}

double nodes_for_skin(double corners, double quadratic_nodes) {
    return corners > most_corners ? corners : quadratic_nodes;
}

}  // namespace palpate::skeleton
