#include "pipeline/exports/four_influences.h"

#include <Eigen/Dense>
#include <algorithm>

#include "mesh/errors.h"
#include "skeleton/model/attachment/carried_point.h"
#include "skeleton/statics/equilibrium.h"
#include "skeleton/statics/statics.h"

namespace palpate::pipeline {
namespace {

constexpr int pushed_places = 12;  // a choice; each is three solves, fewer leave parts of the skin unseen

/// Vertices far from one another: each the farthest from those before.
std::vector<int> spread_vertices(const Points& vertices, int count) {
    std::vector<int> chosen;
    Eigen::VectorXd distance = (vertices.rowwise() - vertices.colwise().mean()).rowwise().squaredNorm();
    while (static_cast<int>(chosen.size()) < count && chosen.size() < static_cast<std::size_t>(vertices.rows())) {
        Eigen::Index farthest = 0;
        distance.maxCoeff(&farthest);
        chosen.push_back(static_cast<int>(farthest));
        const Eigen::VectorXd from = (vertices.rowwise() - vertices.row(farthest)).rowwise().squaredNorm();
        distance = chosen.size() == 1 ? from : Eigen::VectorXd(distance.cwiseMin(from));
    }
    return chosen;
}

/// Small motions of the spheres (6N x p): linear answers to pushes along each axis, each of the same size; where there
/// are none, every sphere's own.
Eigen::MatrixXd fitted_motions(const skeleton::Model& model) {
    const auto freedoms = static_cast<Eigen::Index>(model.dofs());
    try {
        skeleton::StaticsSolver solver(model);
        const skeleton::State rest = skeleton::rest_state(model);
        const std::vector<int> places = spread_vertices(model.surface.vertices, pushed_places);
        Eigen::MatrixXd forces(freedoms, 3 * std::ssize(places));
        for (std::size_t p = 0; p < places.size(); ++p) {
            for (int axis = 0; axis < 3; ++axis) {
                skeleton::Load load;
                load.forces.push_back({model.skin[places[p]], Vec3::Unit(axis)});
                forces.col(static_cast<Eigen::Index>(3 * p + axis)) = skeleton::external_force(model, rest, load);
            }
        }
        Eigen::MatrixXd steps = solver.linear_steps(skeleton::stiffness_vector(model), forces);
        for (Eigen::Index c = 0; c < steps.cols(); ++c) steps.col(c).normalize();
        return steps;
    } catch (const InvalidInput&) {
        return Eigen::MatrixXd::Identity(freedoms, freedoms);
    } catch (const SolverFailure&) {
        return Eigen::MatrixXd::Identity(freedoms, freedoms);
    }
}

/// Weights that add up to 1 with the least |A w - b|^2, near `prior` where that does not tell.
Eigen::VectorXd weights_that_add_up(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, const Eigen::VectorXd& prior) {
    const Eigen::Index n = A.cols();
    Eigen::MatrixXd M = Eigen::MatrixXd::Zero(n + 1, n + 1);
    M.topLeftCorner(n, n) = A.transpose() * A;
    const double ridge = 1e-3 * M.topLeftCorner(n, n).trace() / static_cast<double>(n) + 1e-300;
    M.topLeftCorner(n, n).diagonal().array() += ridge;
    M.row(n).head(n).setOnes();
    M.col(n).head(n).setOnes();
    Eigen::VectorXd r(n + 1);
    r << A.transpose() * b + ridge * prior, 1;
    return M.fullPivLu().solve(r).head(n);
}

}  // namespace

FourInfluences four_influences(const skeleton::Model& model) {
    const Eigen::MatrixXd steps = fitted_motions(model);
    const skeleton::State rest = skeleton::rest_state(model);
    const Eigen::Index count = model.surface.vertices.rows(), p = steps.cols();
    FourInfluences result{Eigen::Matrix<int, Eigen::Dynamic, 4>::Zero(count, 4),
                          Eigen::Matrix<double, Eigen::Dynamic, 4>::Zero(count, 4), 0};
    double missed = 0, moved = 0;
    for (Eigen::Index v = 0; v < count; ++v) {
        const skeleton::Attachment& point = model.skin[v];
        // how the vertex moves in each motion, and how each of its spheres alone would carry it
        Eigen::VectorXd b = Eigen::VectorXd::Zero(3 * p);
        Eigen::MatrixXd A(3 * p, std::ssize(point.shares));
        const skeleton::CarriedPoint carried(point, rest, rest);
        Eigen::VectorXd prior(A.cols());
        std::vector<Eigen::Index> in_use;
        for (Eigen::Index s = 0; s < A.cols(); ++s) {
            const skeleton::SphereInfluence& share = point.shares[s];
            const auto own = steps.middleRows<6>(Eigen::Index{6} * share.sphere);
            b += (carried.jacobian(static_cast<int>(s)) * own).reshaped();
            Eigen::Matrix<double, 3, 6> rigid;
            rigid << Mat3::Identity(), -skeleton::skew(point.rest - model.spheres[share.sphere].center);
            A.col(s) = (rigid * own).reshaped();
            prior[s] = share.weight;
            in_use.push_back(s);
        }
        Eigen::VectorXd w;
        while (true) {
            w = weights_that_add_up(A(Eigen::all, in_use), b, prior(in_use));
            Eigen::Index least = 0;
            if (w.minCoeff(&least) >= 0 && in_use.size() <= 4) break;
            in_use.erase(in_use.begin() + least);
        }
        for (std::size_t i = 0; i < in_use.size(); ++i) {
            result.spheres(v, static_cast<Eigen::Index>(i)) = point.shares[in_use[i]].sphere;
            result.weights(v, static_cast<Eigen::Index>(i)) = w[static_cast<Eigen::Index>(i)];
        }
        missed += (A(Eigen::all, in_use) * w - b).squaredNorm();
        moved += b.squaredNorm();
    }
    result.relative_error = moved > 0 ? std::sqrt(missed / moved) : 0;
    return result;
}

}  // namespace palpate::pipeline
