#include "fem/distributed/petsc/body_part.h"

#include <fmt/format.h>
#include <metis.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "fem/elements/assembly.h"
#include "fem/linear_algebra/multigrid/morton.h"
#include "mesh/errors.h"

namespace palpate::fem {
namespace {

/// The part of each free node.
std::vector<idx_t> split(const mesh::VolumeMesh& mesh, const std::vector<int>& free_number, int free_nodes, int parts) {
    std::vector<idx_t> part(static_cast<std::size_t>(free_nodes), 0);
    if (parts == 1) return part;
    const auto lists = neighbours(mesh, free_number, Half::both);
    std::vector<idx_t> start{0}, adjacent;
    start.reserve(lists.size() + 1);
    std::size_t pairs = 0;
    for (const auto& list : lists) pairs += list.size() - 1;
    if (pairs > static_cast<std::size_t>(std::numeric_limits<idx_t>::max()))
        throw SolverFailure(fmt::format("METIS of this machine counts to {}; the mesh's graph has {} edges",
                                        std::numeric_limits<idx_t>::max(), pairs));
    adjacent.reserve(pairs);
    for (std::size_t i = 0; i < lists.size(); ++i) {
        std::ranges::copy_if(lists[i], std::back_inserter(adjacent), [&](int j) { return j != static_cast<int>(i); });
        start.push_back(static_cast<idx_t>(adjacent.size()));
    }
    idx_t count = free_nodes, constraints = 1, wanted = parts, cut = 0;
    const int answer = METIS_PartGraphKway(&count, &constraints, start.data(), adjacent.data(), nullptr, nullptr,
                                           nullptr, &wanted, nullptr, nullptr, nullptr, &cut, part.data());
    if (answer != METIS_OK)
        throw SolverFailure(fmt::format("METIS did not split a body of {} free nodes in {} parts", free_nodes, parts));
    return part;
}

/// A part of some elements; `own` nodes first, in this order.
BodyPart gathered(const mesh::VolumeMesh& mesh, const Materials& materials, const std::vector<int>& elements,
                  const std::vector<int>& own, std::vector<int>& local) {
    BodyPart part;
    part.own = static_cast<int>(own.size());
    std::vector<int> nodes = own;
    for (std::size_t i = 0; i < own.size(); ++i) local[static_cast<std::size_t>(own[i])] = static_cast<int>(i);
    part.mesh.tetrahedra.resize(std::ssize(elements), mesh.tetrahedra.cols());
    part.materials = {materials.body, materials.regions, {}};
    for (std::size_t e = 0; e < elements.size(); ++e) {
        for (Eigen::Index k = 0; k < mesh.tetrahedra.cols(); ++k) {
            const int node = mesh.tetrahedra(elements[e], k);
            int& place = local[static_cast<std::size_t>(node)];
            if (place < 0) {
                place = static_cast<int>(nodes.size());
                nodes.push_back(node);
            }
            part.mesh.tetrahedra(static_cast<Eigen::Index>(e), k) = place;
        }
        if (!materials.of_element.empty())
            part.materials.of_element.push_back(materials.of_element[static_cast<std::size_t>(elements[e])]);
    }
    part.mesh.nodes = mesh.nodes(nodes, Eigen::all);
    part.number = std::move(nodes);  // as numbered in `mesh`, for the moment
    for (const int node : part.number) local[static_cast<std::size_t>(node)] = -1;
    return part;
}

/// For each own node, the elements that it belongs to.
std::vector<std::vector<int>> elements_of_own(const BodyPart& part) {
    std::vector<std::vector<int>> of_node(static_cast<std::size_t>(part.own));
    for (Eigen::Index e = 0; e < part.mesh.tetrahedra.rows(); ++e) {
        for (Eigen::Index k = 0; k < part.mesh.tetrahedra.cols(); ++k) {
            const int node = part.mesh.tetrahedra(e, k);
            if (node < part.own) of_node[static_cast<std::size_t>(node)].push_back(static_cast<int>(e));
        }
    }
    return of_node;
}

}  // namespace

Partition partition_nodes(const mesh::VolumeMesh& mesh, const std::vector<char>& held, int parts) {
    std::vector<int> free_number(held.size(), -1), free;
    for (std::size_t i = 0; i < held.size(); ++i) {
        if (held[i]) continue;
        free_number[i] = static_cast<int>(free.size());
        free.push_back(static_cast<int>(i));
    }
    const std::vector<idx_t> part = split(mesh, free_number, static_cast<int>(free.size()), parts);
    // Along a curve within each part: what is near in space is near in memory.
    std::vector<int> order = morton_order(mesh.nodes(free, Eigen::all));
    std::ranges::stable_sort(order, {}, [&](int i) { return part[static_cast<std::size_t>(i)]; });
    Partition result{std::vector<int>(held.size(), -1), std::vector<int>(static_cast<std::size_t>(parts) + 1, 0)};
    for (std::size_t k = 0; k < order.size(); ++k) {
        const auto i = static_cast<std::size_t>(order[k]);
        result.number[static_cast<std::size_t>(free[i])] = static_cast<int>(k);
        ++result.first[static_cast<std::size_t>(part[i]) + 1];
    }
    std::partial_sum(result.first.begin(), result.first.end(), result.first.begin());
    return result;
}

BodyPart part_of(const mesh::VolumeMesh& mesh, const Materials& materials, Dilatation dilatation,
                 const Partition& partition, int part) {
    const int first = partition.first[static_cast<std::size_t>(part)];
    const int end = partition.first[static_cast<std::size_t>(part) + 1];
    std::vector<int> own(static_cast<std::size_t>(end - first)), elements;
    for (std::size_t i = 0; i < partition.number.size(); ++i) {
        const int k = partition.number[i];
        if (k >= first && k < end) own[static_cast<std::size_t>(k - first)] = static_cast<int>(i);
    }
    for (Eigen::Index e = 0; e < mesh.tetrahedra.rows(); ++e) {
        const auto is_own = [&](int node) {
            const int k = partition.number[static_cast<std::size_t>(node)];
            return k >= first && k < end;
        };
        const int* nodes = mesh.tetrahedra.row(e).data();
        if (std::any_of(nodes, nodes + mesh.tetrahedra.cols(), is_own)) elements.push_back(static_cast<int>(e));
    }
    std::vector<int> local(partition.number.size(), -1);
    BodyPart result = gathered(mesh, materials, elements, own, local);
    result.dilatation = dilatation;
    result.first = first;
    for (int& node : result.number) node = partition.number[static_cast<std::size_t>(node)];
    return result;
}

void for_pieces(const BodyPart& part, int size, const std::function<void(int, const BodyPart&)>& work) {
    const std::vector<std::vector<int>> of_node = elements_of_own(part);
    std::vector<int> local(part.number.size(), -1);
    for (int begin = 0; begin < part.own; begin += size) {
        const int end = std::min(begin + size, part.own);
        std::vector<int> own(static_cast<std::size_t>(end - begin)), elements;
        std::iota(own.begin(), own.end(), begin);
        for (int node = begin; node < end; ++node) {
            const std::vector<int>& some = of_node[static_cast<std::size_t>(node)];
            elements.insert(elements.end(), some.begin(), some.end());
        }
        std::ranges::sort(elements);
        elements.erase(std::unique(elements.begin(), elements.end()), elements.end());
        BodyPart piece = gathered(part.mesh, part.materials, elements, own, local);
        piece.dilatation = part.dilatation;
        piece.first = part.first + begin;
        for (int& node : piece.number) node = part.number[static_cast<std::size_t>(node)];
        work(begin, piece);
    }
}

}  // namespace palpate::fem
