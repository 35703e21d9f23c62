#include "identify/models/skeleton/skeleton_body_impl.h"

#include <algorithm>

#include "skeleton/effects/point_sets.h"
#include "skeleton/loads/cavities.h"
#include "skeleton/model/state.h"
#include "skeleton/model/stiffness_order.h"
#include "skeleton/statics/equilibrium.h"

namespace palpate::identify {

BodyGeometry geometry_of(const skeleton::Model& model) {
    BodyGeometry result;
    result.surface = model.surface;
    result.has_cavities = !skeleton::Cavities(model).empty();

    result.material_points.resize(std::ssize(model.spheres), 3);
    result.material_shares.resize(std::ssize(model.spheres));
    for (std::size_t s = 0; s < model.spheres.size(); ++s) {
        result.material_points.row(static_cast<Eigen::Index>(s)) = model.spheres[s].center;
        result.material_shares[static_cast<Eigen::Index>(s)] = model.spheres[s].mass;
    }
    // A model without masses: all spheres alike.
    if (!(result.material_shares.sum() > 0)) result.material_shares.setOnes();
    result.material_shares /= result.material_shares.sum();

    result.skin = model.surface.vertices;
    if (!model.skin.empty()) result.skin_areas = skeleton::point_set(model, fem::ActsOn::surface).weights;
    const Points& extent = result.skin.rows() > 0 ? result.skin : result.material_points;
    result.size = (extent.colwise().maxCoeff() - extent.colwise().minCoeff()).maxCoeff();

    result.pieces.resize(std::ssize(model.links), 3);
    for (std::size_t l = 0; l < model.links.size(); ++l) {
        const skeleton::Link& link = model.links[l];
        result.pieces.row(static_cast<Eigen::Index>(l)) =
            0.5 * (model.spheres[link.a].center + model.spheres[link.b].center).transpose();
        result.pieces_at_support.push_back(model.spheres[link.a].held != model.spheres[link.b].held);
    }

    const skeleton::PointSet support = skeleton::point_set(model, fem::ActsOn::support);
    result.support_points.resize(std::ssize(support.at), 3);
    for (std::size_t p = 0; p < support.at.size(); ++p) {
        result.support_points.row(static_cast<Eigen::Index>(p)) = support.at[p].rest;
    }
    result.support_shares = support.weights;
    return result;
}

Eigen::RowVectorXd SkeletonBody::Impl::weight_of(const skeleton::StiffnessOrder& order, Eigen::Index place,
                                                 const Eigen::MatrixXd& W) const {
    const int owner = order.owner(place);
    if (order.kind(place) != skeleton::Stiffness::volume) return W.row(owner);
    Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(W.cols());
    int links = 0;
    for (Eigen::Index l = 0; l < std::ssize(by_law[0].links); ++l) {
        if (by_law[0].links[l].a != owner && by_law[0].links[l].b != owner) continue;
        sum += W.row(l);
        ++links;
    }
    return sum / std::max(links, 1);
}

Eigen::MatrixXd SkeletonBody::piece_force(const Eigen::VectorXd& q, const ModelSetting& setting, const Action& action,
                                          const Eigen::MatrixXd& W) const {
    Eigen::MatrixXd weighted(impl_->k0.size(), W.cols());
    const Eigen::VectorXd k = stiffness(setting);
    const skeleton::StiffnessOrder order(impl_->model(setting));
    for (Eigen::Index place = 0; place < weighted.rows(); ++place) {
        // a volume is as much harder as the links of its sphere are on average: the pieces are the links
        weighted.row(place) = k[place] * impl_->weight_of(order, place, W);
    }
    return skeleton::link_forces(impl_->model(setting), impl_->equilibrium_of(q, setting, action), setting.effects) *
           weighted;
}

Points SkeletonBody::skin_positions(const Eigen::VectorXd& q, const ModelSetting& setting) const {
    return skeleton::observe(impl_->model(setting), impl_->equilibrium_of(q, setting),
                             impl_->grown(impl_->by_law[0].skin, setting));
}

Eigen::SparseMatrix<double> SkeletonBody::skin_motion(const Eigen::VectorXd& q, const ModelSetting& setting) const {
    return skeleton::observation_jacobian(impl_->model(setting), impl_->equilibrium_of(q, setting),
                                          impl_->grown(impl_->by_law[0].skin, setting));
}

Eigen::SparseMatrix<double> SkeletonBody::material_motion() const {
    std::vector<Eigen::Triplet<double>> ones;
    const Points& spheres = impl_->geometry.material_points;
    ones.reserve(static_cast<std::size_t>(spheres.size()));
    for (int s = 0; s < static_cast<int>(spheres.rows()); ++s) {
        for (int c = 0; c < 3; ++c) ones.emplace_back(3 * s + c, 6 * s + c, 1.0);
    }
    Eigen::SparseMatrix<double> result(spheres.size(), dofs());
    result.setFromTriplets(ones.begin(), ones.end());
    return result;
}

Eigen::MatrixXd SkeletonBody::support_motion(const Vec3& centre) const {
    Eigen::MatrixXd S = Eigen::MatrixXd::Zero(dofs(), 6);
    for (std::size_t s = 0; s < impl_->by_law[0].spheres.size(); ++s) {
        const skeleton::Sphere& sphere = impl_->by_law[0].spheres[s];
        if (!sphere.held) continue;
        const auto row = 6 * static_cast<Eigen::Index>(s);
        S.block<6, 6>(row, 0).setIdentity();
        S.block<3, 3>(row, 3) = -skeleton::skew(sphere.center - centre);
    }
    return S;
}

}  // namespace palpate::identify
