#include "identify/models/skeleton_body_impl.h"

#include <algorithm>

#include "mesh/core/surface.h"
#include "skeleton/model/state.h"
#include "skeleton/model/stiffness_order.h"
#include "skeleton/statics/equilibrium.h"

namespace palpate::identify {

Vec3 SkeletonBody::normal_near(const Vec3& point, double radius) const {
    const mesh::Surface& skin = impl_->by_law[0].surface;
    return skin.triangles.rows() > 0 ? mesh::mean_normal(skin, point, radius) : Vec3(Vec3::UnitZ());
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

const Points& SkeletonBody::pieces() const { return impl_->centres; }
const std::vector<char>& SkeletonBody::pieces_at_support() const { return impl_->at_support; }

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

const Points& SkeletonBody::skin() const { return impl_->by_law[0].surface.vertices; }
const Eigen::VectorXd& SkeletonBody::skin_areas() const { return impl_->skin_areas; }

Points SkeletonBody::skin_positions(const Eigen::VectorXd& q, const ModelSetting& setting) const {
    return skeleton::observe(impl_->model(setting), impl_->equilibrium_of(q, setting),
                             impl_->grown(impl_->by_law[0].skin, setting));
}

Eigen::SparseMatrix<double> SkeletonBody::skin_motion(const Eigen::VectorXd& q, const ModelSetting& setting) const {
    return skeleton::observation_jacobian(impl_->model(setting), impl_->equilibrium_of(q, setting),
                                          impl_->grown(impl_->by_law[0].skin, setting));
}

const Points& SkeletonBody::material_points() const { return impl_->spheres; }
const Eigen::VectorXd& SkeletonBody::material_shares() const { return impl_->mass_shares; }

Eigen::SparseMatrix<double> SkeletonBody::material_motion() const {
    std::vector<Eigen::Triplet<double>> ones;
    ones.reserve(static_cast<std::size_t>(impl_->spheres.size()));
    for (int s = 0; s < static_cast<int>(impl_->spheres.rows()); ++s) {
        for (int c = 0; c < 3; ++c) ones.emplace_back(3 * s + c, 6 * s + c, 1.0);
    }
    Eigen::SparseMatrix<double> result(impl_->spheres.size(), dofs());
    result.setFromTriplets(ones.begin(), ones.end());
    return result;
}

bool SkeletonBody::has_cavities() const { return impl_->has_cavities; }

const Points& SkeletonBody::support_points() const { return impl_->support_points; }
const Eigen::VectorXd& SkeletonBody::support_shares() const { return impl_->support_shares; }

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
