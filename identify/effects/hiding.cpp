#include "identify/effects/hiding.h"

#include <algorithm>

#include "skeleton/state.h"

namespace palpate::identify {

Points World::see(const std::vector<Marker>& rest, const Points& markers) const {
    if (shift.isZero(0) && turn.isZero(0)) return markers;
    Eigen::RowVector3d centre = Eigen::RowVector3d::Zero();
    for (const Marker& marker : rest) centre += marker.rest.transpose();
    centre /= static_cast<double>(rest.size());
    const Mat3 R = skeleton::rotation(turn);
    return ((markers.rowwise() - centre) * R.transpose()).rowwise() + (centre + shift.transpose());
}

double World::scatter(double noise) const {
    const double width = off_width * noise;
    return off_share * width * width;
}

double number_of(const skeleton::Effect& told, const std::string& name) {
    return std::ranges::find(told.parameters, name, &skeleton::EffectParameter::name)->value;
}

}  // namespace palpate::identify
