#pragma once

#include <Eigen/Core>
#include <vector>

namespace palpate::identify {

/// What particles at a temperature b tell of ln(pi / q).
struct TemperatureNode {
    double b = 0;
    double mean = 0, variance = 0;  // of ln(pi / q) there
    double squared_error = 0;       // of the mean
};

/// Of independent draws, each counting as `independent` of their number.
TemperatureNode temperature_node(double b, const Eigen::VectorXd& log_ratio, double independent);

struct Evidence {
    double log_value = 0, sd = 0;
};

/// ln of pi's integral, that of the mean of ln(pi / q) over b from 0 to 1, whose slope is the variance: a trapezoidal
/// rule with its end correction. [Ogata 1989; Gelman & Meng 1998; Friel, Hurn, Wyse 2014] The sd holds chance, and a
/// third of that correction for what the rule leaves.
Evidence integrated_evidence(const std::vector<TemperatureNode>& nodes);

/// Of two independent clouds: the mean, and by how much it may be off, their difference included.
Evidence together(const Evidence& a, const Evidence& b);

}  // namespace palpate::identify
