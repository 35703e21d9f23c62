#include "skeleton/effects/placed_tendon.h"

#include <Eigen/Geometry>

#include "skeleton/model/attachment/attach.h"

namespace palpate::skeleton {

PlacedTendon::PlacedTendon(const Model& model, fem::TendonPull pull)
    : rest_(rest_state(model)), pull_(std::move(pull)), small_strain_(model.law == EquilibriumLaw::linear) {
    const Points& path = pull_.actuator->path;
    for (Eigen::Index k = 1; k < path.rows(); ++k) points_.push_back(attach_to_links(model, path.row(k)));
}

std::vector<CarriedPoint> PlacedTendon::carried(const State& state) const {
    std::vector<CarriedPoint> at;
    at.reserve(points_.size());
    for (const Attachment& point : points_) at.emplace_back(point, rest_, state);
    return at;
}

/// How a sphere has moved, and turned (a rotation vector).
Eigen::Matrix<double, 6, 1> PlacedTendon::step_to(const State& state, int sphere) const {
    const auto s = static_cast<std::size_t>(sphere);
    const Eigen::AngleAxisd turn(Mat3(state.R[s] * rest_.R[s].transpose()));
    Eigen::Matrix<double, 6, 1> step;
    step << (state.x.row(sphere) - rest_.x.row(sphere)).transpose(), turn.angle() * turn.axis();
    return step;
}

Points PlacedTendon::path(const State& state) const {
    Points x = pull_.actuator->path;
    const std::vector<CarriedPoint> at = carried(small_strain_ ? rest_ : state);
    for (std::size_t k = 0; k < at.size(); ++k) {
        Vec3 place = at[k].x();
        for (int i = 0; small_strain_ && i < at[k].shares(); ++i)
            place += at[k].jacobian(i) * step_to(state, at[k].sphere(i));
        x.row(static_cast<Eigen::Index>(k + 1)) = place;
    }
    return x;
}

fem::TendonTerms PlacedTendon::terms(const State& state, double share) const {
    return fem::tendon_terms(pull_.part(share), path(state), small_strain_);
}

fem::TendonFriction PlacedTendon::friction(const State& state) const {
    return fem::tendon_friction(pull_, path(state), small_strain_);
}

fem::TendonSliding PlacedTendon::sliding(const State& state) const {
    const fem::TendonSliding own = fem::tendon_sliding(pull_, path(state), small_strain_);
    const auto by_spheres = [&](const Eigen::MatrixXd& columns) {
        Eigen::MatrixXd result = Eigen::MatrixXd::Zero(6 * state.x.rows(), columns.cols());
        for (Eigen::Index c = 0; c < columns.cols(); ++c) {
            const Eigen::VectorXd column = columns.col(c);
            add(state, Eigen::Map<const Points>(column.data(), column.size() / 3, 3), 1, result.col(c));
        }
        return result;
    };
    return {by_spheres(own.by_number), by_spheres(own.number_by_point.transpose()).transpose()};
}

void PlacedTendon::add(const State& state, const Points& at_points, double factor,
                       Eigen::Ref<Eigen::VectorXd> sum) const {
    const std::vector<CarriedPoint> at = carried(small_strain_ ? rest_ : state);
    for (std::size_t k = 0; k < at.size(); ++k) {
        const Vec3 own = factor * at_points.row(static_cast<Eigen::Index>(k + 1));
        for (int i = 0; i < at[k].shares(); ++i)
            sum.segment<6>(Eigen::Index{6} * at[k].sphere(i)) += at[k].jacobian(i).transpose() * own;
    }
}

}  // namespace palpate::skeleton
