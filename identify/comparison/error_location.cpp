#include "identify/comparison/error_location.h"

#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <cassert>
#include <cmath>
#include <limits>

#include "mesh/geometry/sampling.h"

namespace palpate::identify {
namespace {

constexpr int most_regions = 12;          // a choice: a table that is read at a glance
constexpr int markers_per_region = 3;     // on average, or regions would tell no more than markers
constexpr double strange_p_value = 0.05;  // the customary level, corrected for the number of places

/// A place's error, its p-value not yet corrected.
PlaceError error_at(std::vector<int> markers, const Points& rest, const std::vector<Points>& residual_mm,
                    const std::vector<Points>& whitened) {
    PlaceError place;
    place.at = rest(markers, Eigen::all).colwise().mean().transpose();
    double squares = 0, chi_squared = 0;
    for (std::size_t s = 0; s < residual_mm.size(); ++s)
        for (const int marker : markers)
            for (int axis = 0; axis < 3; ++axis) {
                const double mm = residual_mm[s](marker, axis), sigmas = whitened[s](marker, axis);
                if (std::isnan(mm) || std::isnan(sigmas)) continue;
                squares += mm * mm;
                chi_squared += sigmas * sigmas;
                ++place.coordinates;
            }
    place.markers = std::move(markers);
    const double n = place.coordinates;
    place.rms_mm = std::sqrt(squares / n);
    place.whitened_rms = std::sqrt(chi_squared / n);
    place.p_value =
        place.coordinates > 0 ? boost::math::gamma_q(n / 2, chi_squared / 2) : std::numeric_limits<double>::quiet_NaN();
    return place;
}

void correct(std::vector<PlaceError>& places) {
    std::vector<double> p_values;
    p_values.reserve(places.size());
    for (const PlaceError& place : places) p_values.push_back(place.p_value);
    p_values = holm(p_values);
    for (std::size_t i = 0; i < places.size(); ++i) {
        places[i].p_value = p_values[i];
        places[i].strange = p_values[i] < strange_p_value;
    }
}

/// Markers by the nearest of the seeds, ties by the earlier one; none is empty.
std::vector<std::vector<int>> regions_of(const Points& rest) {
    const int count = std::clamp(static_cast<int>(rest.rows()) / markers_per_region, 1, most_regions);
    const Points seeds = rest(mesh::farthest_points(rest, count), Eigen::all);
    std::vector<std::vector<int>> regions(static_cast<std::size_t>(seeds.rows()));
    for (int marker = 0; marker < rest.rows(); ++marker) {
        Eigen::Index nearest = 0;
        (seeds.rowwise() - rest.row(marker)).rowwise().squaredNorm().minCoeff(&nearest);
        regions[nearest].push_back(marker);
    }
    std::erase_if(regions, [](const auto& region) { return region.empty(); });
    return regions;
}

}  // namespace

ErrorLocations locate_misfit(const Points& rest, const std::vector<Points>& residual_mm,
                             const std::vector<Points>& whitened) {
    assert(residual_mm.size() == whitened.size());
    for (std::size_t s = 0; s < residual_mm.size(); ++s)
        assert(residual_mm[s].rows() == rest.rows() && whitened[s].rows() == rest.rows());

    ErrorLocations where;
    for (int marker = 0; marker < rest.rows(); ++marker)
        where.markers.push_back(error_at({marker}, rest, residual_mm, whitened));
    for (std::vector<int>& region : regions_of(rest))
        where.regions.push_back(error_at(std::move(region), rest, residual_mm, whitened));
    correct(where.markers);
    correct(where.regions);
    return where;
}

std::vector<double> holm(const std::vector<double>& p_values) {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < p_values.size(); ++i)
        if (!std::isnan(p_values[i])) order.push_back(i);
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return p_values[i]; });

    // The smallest of n stands against n tests, the next against n - 1, ...; none falls below the one before.
    std::vector<double> corrected = p_values;
    double least = 0;
    for (std::size_t rank = 0; rank < order.size(); ++rank) {
        const double tests = static_cast<double>(order.size() - rank);
        least = std::max(least, std::min(1.0, tests * p_values[order[rank]]));
        corrected[order[rank]] = least;
    }
    return corrected;
}

}  // namespace palpate::identify
