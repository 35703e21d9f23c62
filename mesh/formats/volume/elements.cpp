#include "mesh/formats/volume/elements.h"

#include <fmt/format.h>

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <unordered_map>

#include "mesh/errors.h"
#include "mesh/formats/surface/surface_formats.h"
#include "mesh/topology/weld.h"

namespace palpate::mesh {
namespace {

constexpr double equal_nodes = 1e-9;  // share of the diagonal: what writers of each element's own nodes round off
constexpr double flat = 1e-9;         // volume of an element, as a share of the cube of its longest edge
/// How far a midside node may lie from the middle of its edge, as a share of the edge: curved elements bend less, and
/// a midside of another edge lies further away.
constexpr double bent = 0.45;

/// Edges behind the midside nodes 4 to 9, in VTK's order.
constexpr std::array<std::array<int, 2>, 6> midside_edges{{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};

Points rows_of(const std::vector<Vec3>& nodes) {
    Points points(static_cast<Eigen::Index>(nodes.size()), 3);
    for (std::size_t i = 0; i < nodes.size(); ++i) points.row(static_cast<Eigen::Index>(i)) = nodes[i];
    return points;
}

/// Rows of the nodes in place of the file's numbers.
Tetrahedra resolved(const Elements& elements, const std::filesystem::path& file) {
    std::unordered_map<std::int64_t, int> row;
    row.reserve(elements.node_numbers.size());
    for (std::size_t i = 0; i < elements.node_numbers.size(); ++i)
        if (!row.try_emplace(elements.node_numbers[i], static_cast<int>(i)).second)
            throw InvalidInput(fmt::format("{}: node {} stands there twice. Export the mesh again.", file.string(),
                                           elements.node_numbers[i]));
    const auto n = static_cast<std::size_t>(elements.nodes_per_element);
    Tetrahedra tetrahedra(static_cast<Eigen::Index>(elements.corners.size() / n), elements.nodes_per_element);
    for (std::size_t i = 0; i < elements.corners.size(); ++i) {
        const auto found = row.find(elements.corners[i]);
        if (found == row.end())
            throw InvalidInput(fmt::format("{}: element {} names node {}, which the file does not hold.", file.string(),
                                           elements.element_numbers[i / n], elements.corners[i]));
        tetrahedra.data()[i] = found->second;
    }
    return tetrahedra;
}

/// Mirrors an element's numbering: corners 0 and 1 change places, and with them the midsides.
void turn(Tetrahedra& tetrahedra, Eigen::Index e) {
    std::swap(tetrahedra(e, 0), tetrahedra(e, 1));
    if (tetrahedra.cols() < 10) return;
    std::swap(tetrahedra(e, 5), tetrahedra(e, 6));
    std::swap(tetrahedra(e, 7), tetrahedra(e, 8));
}

double longest_edge(const VolumeMesh& mesh, Eigen::Index e) {
    double longest = 0;
    for (const auto& [a, b] : midside_edges)
        longest =
            std::max(longest, (mesh.nodes.row(mesh.tetrahedra(e, a)) - mesh.nodes.row(mesh.tetrahedra(e, b))).norm());
    return longest;
}

/// All elements outward; how many were turned. @throws InvalidInput for one without volume.
Eigen::Index turn_inverted(VolumeMesh& mesh, const Elements& elements, const std::filesystem::path& file) {
    const Eigen::VectorXd volumes = element_volumes(mesh);
    Eigen::Index turned = 0;
    for (Eigen::Index e = 0; e < volumes.size(); ++e) {
        if (!(std::abs(volumes[e]) > flat * std::pow(longest_edge(mesh, e), 3)))
            throw InvalidInput(fmt::format(
                "{}: element {} is flat (volume {:.3g} at edges of {:.3g}). Improve the mesh, or give its surface, "
                "which is meshed anew.",
                file.string(), elements.element_numbers[static_cast<std::size_t>(e)], volumes[e],
                longest_edge(mesh, e)));
        if (volumes[e] > 0) continue;
        turn(mesh.tetrahedra, e);
        ++turned;
    }
    return turned;
}

void check_midsides(const VolumeMesh& mesh, const Elements& elements, const std::filesystem::path& file) {
    if (!mesh.is_quadratic()) return;
    for (Eigen::Index e = 0; e < mesh.tetrahedra.rows(); ++e)
        for (int s = 0; s < 6; ++s) {
            const Vec3 a = mesh.nodes.row(mesh.tetrahedra(e, midside_edges[s][0]));
            const Vec3 b = mesh.nodes.row(mesh.tetrahedra(e, midside_edges[s][1]));
            const Vec3 middle = mesh.nodes.row(mesh.tetrahedra(e, 4 + s));
            if ((middle - (a + b) / 2).norm() > bent * (b - a).norm())
                throw InvalidInput(fmt::format(
                    "{}: element {}: node {} should be the midside between nodes {} and {}, but lies {:.3g} from it, "
                    "on an edge of {:.3g}. Are the nodes in the format's order?",
                    file.string(), elements.element_numbers[static_cast<std::size_t>(e)],
                    elements.node_numbers[static_cast<std::size_t>(mesh.tetrahedra(e, 4 + s))],
                    elements.node_numbers[static_cast<std::size_t>(mesh.tetrahedra(e, midside_edges[s][0]))],
                    elements.node_numbers[static_cast<std::size_t>(mesh.tetrahedra(e, midside_edges[s][1]))],
                    (middle - (a + b) / 2).norm(), (b - a).norm()));
        }
}

/// A side belongs to one element or to two.
void check_sides(const VolumeMesh& mesh, const Elements& elements, const std::filesystem::path& file) {
    constexpr std::array<std::array<int, 3>, 4> sides{{{0, 1, 2}, {0, 1, 3}, {1, 2, 3}, {0, 2, 3}}};
    std::vector<std::pair<std::array<int, 3>, Eigen::Index>> all;
    all.reserve(static_cast<std::size_t>(4 * mesh.tetrahedra.rows()));
    for (Eigen::Index e = 0; e < mesh.tetrahedra.rows(); ++e)
        for (const auto& side : sides) {
            std::array<int, 3> corners{mesh.tetrahedra(e, side[0]), mesh.tetrahedra(e, side[1]),
                                       mesh.tetrahedra(e, side[2])};
            std::ranges::sort(corners);
            all.emplace_back(corners, e);
        }
    std::ranges::sort(all);
    for (std::size_t i = 2; i < all.size(); ++i)
        if (all[i].first == all[i - 2].first) {
            const auto number = [&](std::size_t k) {
                return elements.element_numbers[static_cast<std::size_t>(all[k].second)];
            };
            throw InvalidInput(
                fmt::format("{}: elements {}, {} and {} share one side; two may. Does an element stand "
                            "there twice?",
                            file.string(), number(i - 2), number(i - 1), number(i)));
        }
}

/// Equal nodes are one, and nodes of no element are gone. Returns how many were merged, and how many belong to none.
std::pair<int, int> compact(VolumeMesh& mesh) {
    // To the grid that welds, any three nodes are a triangle.
    const Eigen::Index entries = mesh.tetrahedra.size();
    Surface triples{mesh.nodes, Triangles((entries + 2) / 3, 3)};
    for (Eigen::Index i = 0; i < triples.triangles.size(); ++i)
        triples.triangles.data()[i] = mesh.tetrahedra.data()[std::min(i, entries - 1)];
    const WeldResult welded = weld(triples, equal_nodes * bounding_box(mesh.nodes).diagonal());
    for (Eigen::Index i = 0; i < entries; ++i) mesh.tetrahedra.data()[i] = welded.surface.triangles.data()[i];
    const auto unused =
        static_cast<int>(mesh.nodes.rows()) - static_cast<int>(welded.surface.vertices.rows()) - welded.merged;
    mesh.nodes = welded.surface.vertices;
    return {welded.merged, unused};
}

/// Elements that hang together by sides are one part.
int count_parts(const VolumeMesh& mesh) {
    std::vector<int> leader(static_cast<std::size_t>(mesh.nodes.rows()));
    for (std::size_t i = 0; i < leader.size(); ++i) leader[i] = static_cast<int>(i);
    const auto find = [&](int node) {
        while (leader[static_cast<std::size_t>(node)] != node)
            node = leader[static_cast<std::size_t>(node)] =
                leader[static_cast<std::size_t>(leader[static_cast<std::size_t>(node)])];
        return node;
    };
    for (Eigen::Index e = 0; e < mesh.tetrahedra.rows(); ++e)
        for (int c = 1; c < 4; ++c) {
            const int a = find(mesh.tetrahedra(e, 0)), b = find(mesh.tetrahedra(e, c));
            leader[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
        }
    std::set<int> parts;
    for (Eigen::Index e = 0; e < mesh.tetrahedra.rows(); ++e) parts.insert(find(mesh.tetrahedra(e, 0)));
    return static_cast<int>(parts.size());
}

}  // namespace

void Elements::add(std::int64_t number, const std::vector<std::int64_t>& element_nodes, const std::string& where) {
    const auto n = static_cast<int>(element_nodes.size());
    if (nodes_per_element == 0) nodes_per_element = n;
    if (n != nodes_per_element)
        throw InvalidInput(fmt::format("{}: element {} has {} nodes, those before it {}. Keep tetrahedra of one kind.",
                                       where, number, n, nodes_per_element));
    corners.insert(corners.end(), element_nodes.begin(), element_nodes.end());
    element_numbers.push_back(number);
}

void note_materials(const Elements& elements, std::vector<std::string>& notes) {
    std::map<std::int64_t, int> count;
    for (const std::int64_t material : elements.materials) ++count[material];
    if (count.size() < 2) return;
    std::string list;
    for (const auto& [material, elements_of_it] : count) {
        if (list.size() > 100) {
            list += ", ...";
            break;
        }
        list += fmt::format("{}{} ({} elements)", list.empty() ? "" : ", ", material, elements_of_it);
    }
    notes.push_back(fmt::format(
        "The mesh tells {} materials apart: {}. One material is taken for the whole body: 'regions' with these labels "
        "give each its own.",
        count.size(), list));
}

VolumeMesh assemble(const Elements& elements, const std::filesystem::path& file, std::vector<std::string>& notes,
                    std::vector<int>* row_of_node) {
    if (elements.element_numbers.empty())
        throw InvalidInput(
            fmt::format("{}: holds no tetrahedra. Give a mesh of tetrahedra (4 or 10 nodes), or the body's surface as "
                        "one of {}.",
                        file.string(), surface_extensions()));
    VolumeMesh mesh{rows_of(elements.nodes), resolved(elements, file), {}};
    check_midsides(mesh, elements, file);
    const Tetrahedra rows = mesh.tetrahedra;
    const auto [merged, unused] = compact(mesh);
    if (row_of_node) {
        row_of_node->resize(static_cast<std::size_t>(mesh.nodes.rows()));
        for (Eigen::Index i = 0; i < rows.size(); ++i)
            (*row_of_node)[static_cast<std::size_t>(mesh.tetrahedra.data()[i])] = rows.data()[i];
    }
    const Eigen::Index turned = turn_inverted(mesh, elements, file);
    check_sides(mesh, elements, file);
    mesh.faces = boundary_faces(mesh.tetrahedra);

    // That all are numbered the other way round is a convention; that some are is a fault.
    if (turned > 0 && turned < mesh.tetrahedra.rows())
        notes.push_back(
            fmt::format("{} of {} elements were numbered inside out: turned.", turned, mesh.tetrahedra.rows()));
    if (merged > 0) notes.push_back(fmt::format("{} nodes lay on others: each became one with them.", merged));
    if (unused > 0) notes.push_back(fmt::format("{} nodes belong to no tetrahedron: left out.", unused));
    if (const int parts = count_parts(mesh); parts > 1)
        notes.push_back(
            fmt::format("The mesh is {} parts that share no node: each must be held, or the body falls apart.", parts));
    return mesh;
}

}  // namespace palpate::mesh
