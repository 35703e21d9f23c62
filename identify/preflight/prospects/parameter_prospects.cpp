#include "identify/preflight/prospects/parameter_prospects.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mesh/geometry/sampling.h"

namespace palpate::identify {
namespace {

/// sd of each column's number given the readings, all unknown together.
Eigen::VectorXd posterior_sd(const Whitening& V, const Eigen::MatrixXd& columns, const Eigen::VectorXd& prior_sd) {
    const Eigen::MatrixXd scaled = columns * prior_sd.asDiagonal();
    Eigen::MatrixXd H = scaled.transpose() * V.apply(scaled);
    H.diagonal().array() += 1;
    const Eigen::MatrixXd covariance = H.llt().solve(Eigen::MatrixXd::Identity(H.rows(), H.cols()));
    return covariance.diagonal().cwiseSqrt().cwiseProduct(prior_sd);
}

/// Pieces go with the nearest of some that lie far from each other.
struct Parts {
    std::vector<int> middle, of_piece;
    Eigen::MatrixXd weights;  // (pieces x parts)

    explicit Parts(const Points& pieces) {
        constexpr int most = 16;  // as many as a picture shows apart
        middle = mesh::farthest_points(pieces, most);
        of_piece.resize(static_cast<std::size_t>(pieces.rows()));
        weights = Eigen::MatrixXd::Zero(pieces.rows(), std::ssize(middle));
        for (Eigen::Index p = 0; p < pieces.rows(); ++p) {
            Eigen::Index nearest = 0;
            (pieces(middle, Eigen::all).rowwise() - pieces.row(p)).rowwise().squaredNorm().minCoeff(&nearest);
            of_piece[static_cast<std::size_t>(p)] = static_cast<int>(nearest);
            weights(p, nearest) = 1;
        }
    }
};

}  // namespace

ParameterProspects parameter_prospects(const BodyModel& model, const Problem& problem, const LinearPoint& point,
                                       int threads) {
    ParameterProspects result;
    const Eigen::VectorXd sd = posterior_sd(point.rig, point.columns, point.prior_sd);
    for (Eigen::Index p = 0; p < sd.size(); ++p) {
        result.material.push_back({model.parameters()[static_cast<std::size_t>(p)].name, point.explanation.theta[p],
                                   sd[p], point.prior_sd[p]});
    }
    const Parts parts(model.pieces());
    result.part_of_piece = parts.of_piece;
    const ModelSetting setting = point.explanation.setting();
    const auto count = std::ssize(parts.middle);
    const Signatures softer{count, [&](int k, const Eigen::VectorXd& q) {
                                Signatures::InAction all;
                                all.forces = model.piece_force(q, setting, point.forward.actions[k], parts.weights);
                                for (int c = 0; c < count; ++c) all.columns.push_back(c);
                                return all;
                            }};
    const Eigen::MatrixXd columns =
        sensitivities(model, problem, point.explanation, point.forward, {softer}, threads).front();
    const double factor_of_two = std::numbers::ln2;
    const Eigen::VectorXd prior_sd = Eigen::VectorXd::Constant(count, factor_of_two);
    const Eigen::VectorXd part_sd = posterior_sd(point.all, columns, prior_sd);
    for (Eigen::Index c = 0; c < count; ++c) {
        result.parts.push_back({model.pieces().row(parts.middle[static_cast<std::size_t>(c)]),
                                {.name = "part " + std::to_string(c + 1), .sd = part_sd[c], .prior_sd = prior_sd[c]}});
    }
    return result;
}

}  // namespace palpate::identify
