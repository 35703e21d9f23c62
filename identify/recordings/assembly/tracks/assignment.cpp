#include "identify/recordings/assembly/tracks/assignment.h"

#include <limits>

namespace palpate::identify {

std::vector<int> least_assignment(const Eigen::MatrixXd& cost) {
    const auto n = cost.rows(), m = cost.cols();
    // row and column potentials; column 0 stands for "not given yet", rows count from 1
    Eigen::VectorXd u = Eigen::VectorXd::Zero(n + 1), v = Eigen::VectorXd::Zero(m + 1);
    std::vector<Eigen::Index> row_of(static_cast<std::size_t>(m + 1), 0), before(static_cast<std::size_t>(m + 1), 0);
    for (Eigen::Index row = 1; row <= n; ++row) {
        Eigen::VectorXd shortest = Eigen::VectorXd::Constant(m + 1, std::numeric_limits<double>::infinity());
        std::vector<char> is_reached(static_cast<std::size_t>(m + 1), 0);
        row_of[0] = row;
        Eigen::Index at = 0;
        do {
            is_reached[at] = 1;
            const Eigen::Index from = row_of[at];
            double step = std::numeric_limits<double>::infinity();
            Eigen::Index next = 0;
            for (Eigen::Index j = 1; j <= m; ++j) {
                if (is_reached[j] != 0) continue;
                const double way = cost(from - 1, j - 1) - u[from] - v[j];
                if (way < shortest[j]) {
                    shortest[j] = way;
                    before[j] = at;
                }
                if (shortest[j] < step) {
                    step = shortest[j];
                    next = j;
                }
            }
            for (Eigen::Index j = 0; j <= m; ++j) {
                if (is_reached[j] != 0) {
                    u[row_of[j]] += step;
                    v[j] -= step;
                } else {
                    shortest[j] -= step;
                }
            }
            at = next;
        } while (row_of[at] != 0);
        for (; at != 0; at = before[at]) row_of[at] = row_of[before[at]];
    }
    std::vector<int> column_of(static_cast<std::size_t>(n), -1);
    for (Eigen::Index j = 1; j <= m; ++j)
        if (row_of[j] != 0) column_of[row_of[j] - 1] = static_cast<int>(j - 1);
    return column_of;
}

}  // namespace palpate::identify
