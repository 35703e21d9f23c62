#include "fem/linear_algebra/multigrid/prolongator.h"

#include <Eigen/QR>
#include <algorithm>
#include <numeric>

namespace palpate::fem {

namespace {

/// The nodes of each aggregate, ascending.
struct Members {
    std::vector<int> start;  // (aggregates + 1)
    std::vector<int> nodes;

    explicit Members(const Aggregates& aggregates) : start(aggregates.count + 1, 0), nodes(aggregates.of_node.size()) {
        for (const int a : aggregates.of_node) ++start[a + 1];
        std::partial_sum(start.begin(), start.end(), start.begin());
        std::vector<int> next(start.begin(), start.end() - 1);
        for (std::size_t i = 0; i < nodes.size(); ++i) nodes[next[aggregates.of_node[i]]++] = static_cast<int>(i);
    }
    std::span<const int> of(int aggregate) const {
        return std::span(nodes).subspan(start[aggregate], start[aggregate + 1] - start[aggregate]);
    }
};

}  // namespace

RigidModes rigid_modes(const Points& nodes) {
    const Vec3 centre = nodes.colwise().mean();
    const double size = (nodes.colwise().maxCoeff() - nodes.colwise().minCoeff()).maxCoeff();
    RigidModes modes(3 * nodes.rows(), 6);
    for (Eigen::Index i = 0; i < nodes.rows(); ++i) {
        const Vec3 x = (nodes.row(i).transpose() - centre) / size;
        auto mode = modes.middleRows<3>(3 * i);
        mode.leftCols<3>().setIdentity();
        mode.rightCols<3>() << 0, x.z(), -x.y(),  //
            -x.z(), 0, x.x(),                     //
            x.y(), -x.x(), 0;
    }
    return modes;
}

template <int b>
Prolongator<b> tentative_prolongator(const Aggregates& aggregates, const RigidModes& modes) {
    const auto nodes = static_cast<int>(aggregates.of_node.size());
    Prolongator<b> result;
    BlockMatrix<b, 6>& P = result.P;
    P.columns = aggregates.count;
    P.start.resize(nodes + 1);
    std::iota(P.start.begin(), P.start.end(), 0);
    P.column = aggregates.of_node;
    P.values.assign(static_cast<std::size_t>(b) * 6 * nodes, 0.0);
    result.modes.setZero(Eigen::Index{6} * aggregates.count, 6);

    constexpr double distinct = 1e-12;  // modes that differ by less do so by rounding
    const Members members(aggregates);
    for (int a = 0; a < aggregates.count; ++a) {
        const auto own = members.of(a);
        Eigen::MatrixXd local(b * static_cast<Eigen::Index>(own.size()), 6);
        for (std::size_t k = 0; k < own.size(); ++k) {
            local.middleRows<b>(b * k) = modes.middleRows<b>(Eigen::Index{b} * own[k]);
        }
        Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
        qr.setThreshold(distinct);
        qr.compute(local);
        const Eigen::Index rank = qr.rank();
        const Eigen::MatrixXd Q = qr.householderQ() * Eigen::MatrixXd::Identity(local.rows(), rank);
        const Eigen::MatrixXd R = qr.matrixR().topRows(rank).template triangularView<Eigen::Upper>();
        result.modes.middleRows(Eigen::Index{6} * a, rank) = R * qr.colsPermutation().transpose();
        for (std::size_t k = 0; k < own.size(); ++k) P.panel(own[k]).leftCols(rank) = Q.middleRows<b>(b * k);
    }
    return result;
}

template <int b>
void smooth(BlockMatrix<b, 6>& P, const BlockMatrix<b, b>& A, const BlockMatrix<b, b>& inverse_diagonal,
            double lambda) {
    BlockMatrix<b, 6> bent = product(A, P);
    const double omega = 4.0 / 3 / lambda;
    for (int i = 0; i < P.rows(); ++i) {
        auto panel = bent.panel(i);
        panel = (-omega * inverse_diagonal.block(i, 0) * panel).eval();
        for (int k = 0; k < P.count(i); ++k) {
            const auto columns = bent.columns_of(i);
            const auto at = std::ranges::lower_bound(columns, P.columns_of(i)[k]) - columns.begin();
            bent.block(i, static_cast<int>(at)) += P.block(i, k);
        }
    }
    P = std::move(bent);
}

template Prolongator<3> tentative_prolongator(const Aggregates&, const RigidModes&);
template Prolongator<6> tentative_prolongator(const Aggregates&, const RigidModes&);
template void smooth(BlockMatrix<3, 6>&, const BlockMatrix<3, 3>&, const BlockMatrix<3, 3>&, double);
template void smooth(BlockMatrix<6, 6>&, const BlockMatrix<6, 6>&, const BlockMatrix<6, 6>&, double);

}  // namespace palpate::fem
