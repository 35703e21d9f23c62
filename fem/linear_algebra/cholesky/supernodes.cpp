#include "fem/linear_algebra/cholesky/supernodes.h"

#include <cholmod.h>
#include <fmt/format.h>

#include <memory>
#include <mutex>

#include "mesh/errors.h"

namespace palpate::fem {

namespace {

static_assert(sizeof(SuiteSparse_long) == sizeof(std::int64_t));

/// CHOLMOD's settings and workspace: 64-bit indices, silent.
struct Common {
    cholmod_common settings;
    Common() {
        cholmod_l_start(&settings);
        settings.print = 0;
    }
    ~Common() { cholmod_l_finish(&settings); }
    Common(const Common&) = delete;
    Common& operator=(const Common&) = delete;
};

/// CHOLMOD's supernodes of nodes as supernodes of unknowns.
Supernodes expand(const cholmod_factor& L, int unknowns_per_node) {
    const auto* super = static_cast<const std::int64_t*>(L.super);
    const auto* first = static_cast<const std::int64_t*>(L.pi);
    const auto* rows = static_cast<const std::int64_t*>(L.s);
    const auto count = static_cast<int>(L.nsuper);

    Supernodes result{{0}, {0}, {0}, {}, std::vector<int>(count, -1)};
    std::vector<int> supernode_of(L.n);
    for (int s = 0; s < count; ++s) {
        for (std::int64_t c = super[s]; c < super[s + 1]; ++c) supernode_of[c] = s;
        for (std::int64_t k = first[s]; k < first[s + 1]; ++k) {
            for (int a = 0; a < unknowns_per_node; ++a) {
                result.rows.push_back(unknowns_per_node * static_cast<int>(rows[k]) + a);
            }
        }
        const std::int64_t columns = (super[s + 1] - super[s]) * unknowns_per_node;
        result.first_column.push_back(static_cast<int>(super[s + 1]) * unknowns_per_node);
        result.first_row.push_back(static_cast<std::int64_t>(result.rows.size()));
        result.first_value.push_back(result.first_value.back() + columns * result.height(s));
    }
    for (int s = 0; s < count; ++s) {
        const std::int64_t below = first[s] + super[s + 1] - super[s];
        if (below < first[s + 1]) result.parent[s] = supernode_of[rows[below]];
    }
    return result;
}

}  // namespace

Elimination analyse(const std::vector<std::vector<int>>& lower, int unknowns_per_node) {
    // The graph as CHOLMOD reads it: the pattern of a lower half.
    const std::size_t n = lower.size();
    std::vector<std::int64_t> start(n + 1, 0), rows;
    for (std::size_t i = 0; i < n; ++i) {
        rows.insert(rows.end(), lower[i].begin(), lower[i].end());
        start[i + 1] = static_cast<std::int64_t>(rows.size());
    }
    cholmod_sparse graph{};
    graph.nrow = graph.ncol = n;
    graph.nzmax = rows.size();
    graph.p = start.data();
    graph.i = rows.data();
    graph.stype = -1;
    graph.itype = CHOLMOD_LONG;
    graph.xtype = CHOLMOD_PATTERN;
    graph.dtype = CHOLMOD_DOUBLE;
    graph.sorted = graph.packed = 1;

    // METIS draws from the process's one random number generator: one order at a time keeps it reproducible.
    static std::mutex metis_mutex;
    const std::lock_guard lock(metis_mutex);
    Common common;
    common.settings.nmethods = 2;
    common.settings.method[0].ordering = CHOLMOD_METIS;
    common.settings.method[1].ordering = CHOLMOD_AMD;
    common.settings.supernodal = CHOLMOD_SUPERNODAL;
    const auto free_factor = [&](cholmod_factor* L) { cholmod_l_free_factor(&L, &common.settings); };
    const std::unique_ptr<cholmod_factor, decltype(free_factor)> L(cholmod_l_analyze(&graph, &common.settings),
                                                                   free_factor);
    if (!L) {
        throw SolverFailure(
            fmt::format("No elimination order of {} nodes was found: out of memory. Take a coarser mesh.", n));
    }
    const auto* order = static_cast<const std::int64_t*>(L->Perm);
    Elimination result{std::vector<int>(n), expand(*L, unknowns_per_node)};
    for (std::size_t k = 0; k < n; ++k) result.position[order[k]] = static_cast<int>(k);
    return result;
}

}  // namespace palpate::fem
