#include "identify/inference/particles/hamiltonian/evidence.h"

#include <algorithm>
#include <cmath>

namespace palpate::identify {
namespace {

constexpr double left_by_the_rule = 1.0 / 3;  // of the correction that the trapezoidal rule got

}  // namespace

TemperatureNode temperature_node(double b, const Eigen::VectorXd& log_ratio, double independent) {
    const auto n = static_cast<double>(log_ratio.size());
    TemperatureNode node{b, log_ratio.mean(), 0, 0};
    if (n > 1) node.variance = (log_ratio.array() - node.mean).square().sum() / (n - 1);
    node.squared_error = node.variance / std::max(1.0, independent);
    return node;
}

Evidence integrated_evidence(const std::vector<TemperatureNode>& nodes) {
    Evidence evidence;
    double variance = 0;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        // a node weighs by the intervals on both sides
        const double before = i > 0 ? nodes[i].b - nodes[i - 1].b : 0;
        const double after = i + 1 < nodes.size() ? nodes[i + 1].b - nodes[i].b : 0;
        const double share = (before + after) / 2;
        evidence.log_value += share * nodes[i].mean;
        variance += share * share * nodes[i].squared_error;
        if (after == 0) continue;
        const double correction = after * after / 12 * (nodes[i].variance - nodes[i + 1].variance);
        evidence.log_value += correction;
        variance += std::pow(left_by_the_rule * correction, 2);
    }
    evidence.sd = std::sqrt(variance);
    return evidence;
}

Evidence together(const Evidence& a, const Evidence& b) {
    const double by_themselves = std::sqrt(a.sd * a.sd + b.sd * b.sd) / 2;
    return {(a.log_value + b.log_value) / 2, std::max(by_themselves, std::abs(a.log_value - b.log_value) / 2)};
}

}  // namespace palpate::identify
