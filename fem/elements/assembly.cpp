#include "fem/elements/assembly.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "fem/elements/element_gradients.h"
#include "mesh/errors.h"

namespace palpate::fem {

namespace {

void refuse_locking(const mesh::VolumeMesh& mesh, const Materials& materials) {
    if (mesh.is_quadratic() || materials.most_poisson() <= 0.4) return;
    throw InvalidInput(
        fmt::format("Poisson's ratio is {} on linear tetrahedra, which lock above 0.4 (26 % too stiff at 0.49). Use "
                    "quadratic tetrahedra, or a ratio of at most 0.4.",
                    materials.most_poisson()));
}

/// The elements of each node, as element * nodes + local index, ascending.
struct NodeElements {
    std::vector<int> start;  // (n + 1)
    std::vector<int> corners;

    explicit NodeElements(const mesh::VolumeMesh& mesh)
        : start(mesh.nodes.rows() + 1, 0), corners(mesh.tetrahedra.size()) {
        const int* node = mesh.tetrahedra.data();
        for (Eigen::Index k = 0; k < mesh.tetrahedra.size(); ++k) ++start[node[k] + 1];
        for (std::size_t i = 1; i < start.size(); ++i) start[i] += start[i - 1];
        std::vector<int> next(start.begin(), start.end() - 1);
        for (Eigen::Index k = 0; k < mesh.tetrahedra.size(); ++k) corners[next[node[k]]++] = static_cast<int>(k);
    }
};

/// The inverse of `number`: the node behind each index.
std::vector<int> numbered_nodes(const std::vector<int>& number) {
    std::vector<int> nodes(std::ranges::count_if(number, [](int k) { return k >= 0; }));
    for (std::size_t i = 0; i < number.size(); ++i) {
        if (number[i] >= 0) nodes[number[i]] = static_cast<int>(i);
    }
    return nodes;
}

std::vector<std::vector<int>> neighbours_of(const mesh::VolumeMesh& mesh, const NodeElements& elements,
                                            const std::vector<int>& number, const std::vector<int>& nodes, Half half) {
    const auto width = static_cast<int>(mesh.tetrahedra.cols());
    const auto count = static_cast<int>(nodes.size());
    std::vector<std::vector<int>> result(count);
    tbb::enumerable_thread_specific<std::vector<int>> seen_by([&] { return std::vector<int>(count, -1); });
    tbb::parallel_for(tbb::blocked_range<int>(0, count, 256), [&](const tbb::blocked_range<int>& range) {
        std::vector<int>& seen = seen_by.local();
        for (int c = range.begin(); c != range.end(); ++c) {
            for (int k = elements.start[nodes[c]]; k < elements.start[nodes[c] + 1]; ++k) {
                const auto element = mesh.tetrahedra.row(elements.corners[k] / width);
                for (int j = 0; j < width; ++j) {
                    const int other = number[element(j)];
                    if (other < (half == Half::lower ? c : 0) || seen[other] == c) continue;
                    seen[other] = c;
                    result[c].push_back(other);
                }
            }
            std::ranges::sort(result[c]);
        }
    });
    return result;
}

/// Adds an element's share to the three columns of its node i.
///
/// With S_ab = sum_q g_q(3i+a) g_q(3j+b) the block of nodes i, j is
///   K_ab = mu (tr S delta_ab + S_ba) + lambda S_ab,
/// where for P2/P0 the last term is lambda m(3i+a) m(3j+b) with the element's mean gradients m.
template <int nodes>
struct ColumnGather {
    const ElementGradients& gradients;
    const Materials& materials;
    Dilatation dilatation;

    /// `place` (nodes): where node j's rows begin in each column, or -1; `stride`: entries of a column.
    void add(int element, int i, const int* place, double* columns, int stride) const {
        constexpr int width = 3 * nodes;
        double S[3][width] = {};
        for (std::size_t q = gradients.first_row[element]; q < gradients.first_row[element + 1]; ++q) {
            const double* g = &gradients.rows[q * width];
            for (int a = 0; a < 3; ++a) {
                for (int k = 0; k < width; ++k) S[a][k] += g[3 * i + a] * g[k];
            }
        }
        const Material& material = materials.of(static_cast<std::size_t>(element));
        const double mu = material.shear_modulus(), lambda = material.lame_lambda();
        const double* m = &gradients.means[static_cast<std::size_t>(element) * width];
        for (int j = 0; j < nodes; ++j) {
            if (place[j] < 0) continue;
            const double trace = S[0][3 * j] + S[1][3 * j + 1] + S[2][3 * j + 2];
            for (int a = 0; a < 3; ++a) {
                double* column = columns + static_cast<std::size_t>(a) * stride + place[j];
                for (int b = 0; b < 3; ++b) {
                    const double divergence = dilatation == Dilatation::mean ? m[3 * i + a] * m[3 * j + b]  //
                                                                             : S[a][3 * j + b];
                    column[b] += mu * ((a == b ? trace : 0) + S[b][3 * j + a]) + lambda * divergence;
                }
            }
        }
    }
};

/// `columns_of(c)`: where the three columns of numbered node c are stored, one after the other.
template <int nodes, class ColumnsOf>
void fill_values(const mesh::VolumeMesh& mesh, const Materials& materials, Dilatation dilatation,
                 const NodeElements& elements, const std::vector<int>& number, const std::vector<int>& numbered,
                 const std::vector<std::vector<int>>& rows, ColumnsOf&& columns_of) {
    const ElementGradients gradients = element_gradients(mesh);
    const ColumnGather<nodes> gather{gradients, materials, dilatation};
    const auto count = static_cast<int>(numbered.size());
    tbb::enumerable_thread_specific<std::vector<int>> place_by([&] { return std::vector<int>(count, -1); });
    tbb::parallel_for(tbb::blocked_range<int>(0, count, 256), [&](const tbb::blocked_range<int>& range) {
        std::vector<int>& place_of = place_by.local();
        for (int c = range.begin(); c != range.end(); ++c) {
            for (std::size_t k = 0; k < rows[c].size(); ++k) place_of[rows[c][k]] = static_cast<int>(3 * k);
            double* columns = columns_of(c);
            for (int k = elements.start[numbered[c]]; k < elements.start[numbered[c] + 1]; ++k) {
                const int element = elements.corners[k] / nodes;
                int place[nodes];
                for (int j = 0; j < nodes; ++j) {
                    const int other = number[mesh.tetrahedra(element, j)];
                    place[j] = other < 0 ? -1 : place_of[other];
                }
                gather.add(element, elements.corners[k] % nodes, place, columns, static_cast<int>(3 * rows[c].size()));
            }
            for (const int row : rows[c]) place_of[row] = -1;
        }
    });
}

}  // namespace

std::vector<std::vector<int>> neighbours(const mesh::VolumeMesh& mesh, const std::vector<int>& number, Half half) {
    return neighbours_of(mesh, NodeElements(mesh), number, numbered_nodes(number), half);
}

template <class Index>
Eigen::SparseMatrix<double, Eigen::ColMajor, Index> assemble(const mesh::VolumeMesh& mesh, const Materials& materials,
                                                             Dilatation dilatation, const std::vector<int>& number,
                                                             Half half) {
    materials.validate();
    refuse_locking(mesh, materials);
    const NodeElements elements(mesh);
    const std::vector<int> numbered = numbered_nodes(number);
    const auto rows = neighbours_of(mesh, elements, number, numbered, half);

    // Pattern: the three columns of a node hold three rows for each neighbour.
    const auto count = static_cast<Eigen::Index>(numbered.size());
    Eigen::SparseMatrix<double, Eigen::ColMajor, Index> K(3 * count, 3 * count);
    Index* start = K.outerIndexPtr();
    for (Eigen::Index c = 0; c < 3 * count; ++c) start[c + 1] = start[c] + static_cast<Index>(3 * rows[c / 3].size());
    K.resizeNonZeros(start[3 * count]);
    tbb::parallel_for(Eigen::Index(0), 3 * count, [&](Eigen::Index c) {
        Index* row = K.innerIndexPtr() + start[c];
        for (const int other : rows[c / 3]) {
            for (int b = 0; b < 3; ++b) *row++ = static_cast<Index>(3) * other + b;
        }
        std::fill(K.valuePtr() + start[c], K.valuePtr() + start[c + 1], 0.0);
    });

    const auto columns_of = [&](int c) { return K.valuePtr() + start[3 * static_cast<Eigen::Index>(c)]; };
    if (mesh.is_quadratic()) {
        fill_values<10>(mesh, materials, dilatation, elements, number, numbered, rows, columns_of);
    } else {
        fill_values<4>(mesh, materials, dilatation, elements, number, numbered, rows, columns_of);
    }
    return K;
}

BlockMatrix<3, 3> assemble_blocks(const mesh::VolumeMesh& mesh, const Materials& materials, Dilatation dilatation,
                                  const std::vector<int>& number) {
    materials.validate();
    refuse_locking(mesh, materials);
    const NodeElements elements(mesh);
    const std::vector<int> numbered = numbered_nodes(number);
    const auto rows = neighbours_of(mesh, elements, number, numbered, Half::both);
    auto K = with_pattern<3, 3>(rows, static_cast<int>(rows.size()));

    // K is symmetric: the three columns of a node are its three rows.
    const auto rows_of = [&](int c) { return K.panel(c).data(); };
    if (mesh.is_quadratic()) {
        fill_values<10>(mesh, materials, dilatation, elements, number, numbered, rows, rows_of);
    } else {
        fill_values<4>(mesh, materials, dilatation, elements, number, numbered, rows, rows_of);
    }
    return K;
}

template Eigen::SparseMatrix<double, Eigen::ColMajor, int> assemble<int>(  //
    const mesh::VolumeMesh&, const Materials&, Dilatation, const std::vector<int>&, Half);
template Eigen::SparseMatrix<double, Eigen::ColMajor, std::int64_t> assemble<std::int64_t>(const mesh::VolumeMesh&,
                                                                                           const Materials&, Dilatation,
                                                                                           const std::vector<int>&,
                                                                                           Half);

}  // namespace palpate::fem
