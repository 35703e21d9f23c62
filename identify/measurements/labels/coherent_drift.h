#pragma once

#include <vector>

#include "mesh/types.h"

namespace palpate::identify {

struct DriftOptions {
    double smoothness = 0;        // beta: points so far apart hardly move together [mm], > 0
    double reach = 0;             // tau: prior sd of a displacement [mm], > 0
    double first_sigma = 0;       // how far off points are taken to be at first [mm], > 0
    double least_sigma = 0;       // and how near at last [mm], > 0
    double outlier_share = 0.05;  // of readings that belong to no point, [0, 1)
};

struct Drift {
    Points moved;       // where the points have gone (m x 3) [mm]
    Eigen::MatrixXd P;  // probability that a reading is of a point (m x n); a column's rest: of none
    double sigma = 0;   // between readings and moved points, what is left, rms a coordinate [mm]
    int iterations = 0;
};

/// Points follow a cloud of readings that do not tell whose they are, all moving as one smooth field: coherent point
/// drift [Myronenko, Song, IEEE PAMI 32 (2010)]. Readings are a mixture of Gaussians round the moved points y + v(y)
/// and of strays, evenly over the points' box; v is a Gaussian process with the covariance
///   tau^2 exp(-|y - y'|^2 / (2 beta^2)),
/// carried by at most a hundred of the points. By expectation and maximisation: P from the distances at sigma, then v
/// from P, a ridge regression, then sigma from what v leaves; sigma falls from its first value to what is left.
///
/// `known`: the point that a reading is of, or -1 (n). Readings are complete: no NaN.
Drift coherent_drift(const Points& points, const Points& readings, const std::vector<int>& known,
                     const DriftOptions& options);

}  // namespace palpate::identify
