#include "identify/diagnosis/statistics/outliers/set_aside.h"

#include <algorithm>
#include <cmath>

namespace palpate::identify {
namespace {

/// What a fit to some of the readings alone would leave of their errors d, rms in sigmas, by its linearisation.
double rms_without(const Whitening& V, const Eigen::VectorXd& d, const std::vector<char>& keep) {
    std::vector<Eigen::Index> dropped;
    for (std::size_t n = 0; n < keep.size(); ++n) {
        if (!keep[n]) dropped.push_back(static_cast<Eigen::Index>(n));
    }
    const Eigen::VectorXd y = V.apply(d), own = y(dropped);
    const double chi_square = d.dot(y) - own.dot(V.solve_within(dropped, own).col(0));
    return std::sqrt(chi_square / static_cast<double>(std::ranges::count(keep, 1)));
}

}  // namespace

std::optional<SetAside> single_readings_off(const Problem& problem, const Refit& fit, double least) {
    const Whitening V = with_numbers_unknown(fit);
    SetAside found{.outliers = find_outliers(problem, fit.residual, find_exchanged_markers(problem, V, fit.error)),
                   .others = {}};
    if (found.outliers.log_bayes_factor < least) return std::nullopt;
    found.others = rows_without(problem, found.outliers.readings);
    constexpr double little = 3;  // rms, whitened: where more is left without them, they are not what is wrong
    if (rms_without(V, fit.error, found.others) > little) return std::nullopt;
    std::vector<int>& numbers = found.outliers.readings;
    numbers.clear();
    for (std::size_t n = 0; n < found.others.size(); ++n) {
        const int number = problem.set_reading[n];
        if (!found.others[n] && (numbers.empty() || numbers.back() != number)) numbers.push_back(number);
    }
    return found;
}

}  // namespace palpate::identify
