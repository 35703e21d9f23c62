#include "skeleton/effects/placed_tendon.h"

#include "skeleton/model/attach.h"

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

fem::TendonTerms PlacedTendon::terms(const State& state, double share) const {
    Points x = pull_.actuator->path;
    const std::vector<CarriedPoint> at = carried(state);
    for (std::size_t k = 0; k < at.size(); ++k) x.row(static_cast<Eigen::Index>(k + 1)) = at[k].x();
    return fem::tendon_terms({pull_.actuator, share * pull_.value, pull_.young}, x, small_strain_);
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
