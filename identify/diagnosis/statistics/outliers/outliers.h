#pragma once

#include "identify/diagnosis/fit/refit.h"
#include "identify/diagnosis/statistics/outliers/exchanged_markers.h"

namespace palpate::identify {

/// Errors of readings against those of their neighbours: what a missing effect does to a whole region drops out, what
/// befell one reading stays.
struct Roughness {
    // Of each reading's difference from the median of its neighbours, a vector's length; of a tool 0.
    std::vector<double> size;
    double scale = 1;  // robust: 1 sd of a coordinate of it, in the unit of the errors
};

/// `residual` (N): errors in any unit. Neighbours: the six nearest markers of the same state; where a state has fewer
/// than eight readings, its errors count as they are.
Roughness roughness(const Problem& problem, const Eigen::VectorXd& residual);

/// 1 sigma of the readings [mm] as their roughness tells: where the noise is not specified.
double noise_by_roughness(const Problem& problem, const Eigen::VectorXd& error_mm);

/// Readings that are off by themselves.
struct Outliers {
    std::vector<int> readings;                     // of the problem
    double log_bayes_factor = 0;                   // that some readings come from a wider distribution, against none
    double share = 0, width = 0;                   // the most probable: of the readings, over the noise
    std::vector<ExchangedMarkers> exchanged = {};  // whose readings are among them
};

/// Readings of markers whose labels are `exchanged`, and those rougher than 5 scales, or 5 times what noise of 1 sigma
/// makes, if they are no more than a tenth of all; more is no matter of single readings. The evidence is that of a
/// mixture, averaged over shares of .3 to 10 % and widths of 4 to 60. `residual` (N), in sigmas.
Outliers find_outliers(const Problem& problem, const Eigen::VectorXd& residual,
                       std::vector<ExchangedMarkers> exchanged = {});

/// Flags of the rows that belong to none of the readings (N).
std::vector<char> rows_without(const Problem& problem, const std::vector<int>& readings);

}  // namespace palpate::identify
