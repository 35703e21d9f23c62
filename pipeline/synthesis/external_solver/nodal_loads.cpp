#include "pipeline/synthesis/external_solver/nodal_loads.h"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>

#include "mesh/errors.h"
#include "mesh/formats/solution/solution.h"
#include "mesh/geometry/surface_tree.h"

namespace palpate::pipeline {
namespace {

using identify::LoadState;

/// Nodal forces of one step on a surface, sorted into patches.
class Patches {
public:
    /// `forces`: of the surface's vertices [N].
    Patches(const mesh::Surface& surface, const std::map<int, Vec3>& forces) : surface_(surface), forces_(forces) {
        for (const auto& [vertex, force] : forces_) leader_[vertex] = vertex;
        for (const auto& triangle : surface_.triangles.rowwise())
            for (int a = 0; a < 3; ++a) join(triangle[a], triangle[(a + 1) % 3]);
    }

    std::vector<std::vector<int>> execute() {
        std::map<int, std::vector<int>> patches;
        for (const auto& [vertex, force] : forces_) patches[find(vertex)].push_back(vertex);
        std::vector<std::vector<int>> list;
        list.reserve(patches.size());
        for (auto& [leader, patch] : patches) list.push_back(std::move(patch));
        return list;
    }

private:
    int find(int vertex) {
        while (leader_[vertex] != vertex) vertex = leader_[vertex] = leader_[leader_[vertex]];
        return vertex;
    }
    void join(int a, int b) {
        if (!leader_.contains(a) || !leader_.contains(b)) return;
        const int first = find(a), second = find(b);
        leader_[std::max(first, second)] = std::min(first, second);
    }

    const mesh::Surface& surface_;
    const std::map<int, Vec3>& forces_;
    std::map<int, int> leader_;
};

/// What a disc under an even force does not tell: forces that differ in direction, and how they turn about its middle.
std::string left_out(const std::vector<int>& patch, const std::map<int, Vec3>& forces, const mesh::Contact& contact,
                     const mesh::Surface& surface) {
    double lengths = 0;
    Vec3 torque = Vec3::Zero();
    for (const int vertex : patch) {
        lengths += forces.at(vertex).norm();
        torque += (surface.vertices.row(vertex).transpose() - contact.point).cross(forces.at(vertex));
    }
    const double force = contact.force.norm();
    if (force < 0.9 * lengths) return fmt::format("{:.0f} % of the nodal forces cancel", 100 * (1 - force / lengths));
    const double arm = torque.norm() / force;
    if (contact.radius > 0 && arm > 0.2 * contact.radius)
        return fmt::format("they turn about it with an arm of {:.2g} mm", arm);
    return "";
}

mesh::Contact contact_of(const std::vector<int>& patch, const std::map<int, Vec3>& forces, const mesh::Surface& surface,
                         const mesh::SurfaceTree& tree) {
    mesh::Contact contact;
    for (const int vertex : patch) contact.force += forces.at(vertex);
    const double strength = contact.force.norm();
    if (patch.size() == 1 || strength == 0) {
        contact.point = surface.vertices.row(patch.front());
        return contact;
    }
    // Consistent forces of quadratic elements may point the other way at single nodes: weights may be negative.
    const Vec3 direction = contact.force / strength;
    const auto weight = [&](int vertex) { return forces.at(vertex).dot(direction) / strength; };
    Vec3 middle = Vec3::Zero();
    for (const int vertex : patch) middle += weight(vertex) * surface.vertices.row(vertex).transpose();
    double square = 0;
    for (const int vertex : patch)
        square += weight(vertex) * (surface.vertices.row(vertex).transpose() - middle).squaredNorm();
    contact.point = tree.closest(middle).position;
    contact.radius = std::sqrt(2 * std::max(square, 0.0));
    return contact;
}

}  // namespace

std::vector<LoadState> states_of_steps(const mesh::Deck& deck, double unit, std::vector<std::string>& notes) {
    mesh::Solution mesh = mesh::mesh_of(deck);
    mesh.surface.vertices *= unit;
    const mesh::SurfaceTree tree(mesh.surface);
    std::map<std::int64_t, int> vertex_of;
    for (std::size_t v = 0; v < mesh.node_of_vertex.size(); ++v)
        vertex_of[deck.cells.node_numbers[static_cast<std::size_t>(mesh.node_of_vertex[v])]] = static_cast<int>(v);

    std::vector<LoadState> states;
    for (const mesh::DeckStep& step : deck.steps) {
        LoadState& state = states.emplace_back();
        state.probe = static_cast<int>(states.size());
        state.time = 1;
        if (!step.others.empty())
            throw InvalidInput(
                fmt::format("step {} has a load that is no nodal force ({}); put a probes.csv beside the "
                            "results that says where each state is touched, and how strongly.",
                            state.probe, step.others.front()));
        if (step.gravity) state.gravity = unit * *step.gravity;
        std::map<int, Vec3> forces;
        for (const auto& [node, force] : step.forces) {
            if (force.isZero(0)) continue;
            const auto found = vertex_of.find(node);
            if (found == vertex_of.end())
                throw InvalidInput(
                    fmt::format("{}: step {} presses on node {}, which is not on the surface; contacts "
                                "press on the surface.",
                                deck.file.string(), state.probe, node));
            forces[found->second] = force;
        }
        for (const std::vector<int>& patch : Patches(mesh.surface, forces).execute()) {
            const mesh::Contact contact = contact_of(patch, forces, mesh.surface, tree);
            if (contact.force.isZero(0)) continue;
            if (const std::string words = left_out(patch, forces, contact, mesh.surface); !words.empty())
                notes.push_back(fmt::format("Step {}: a contact stands for the forces of {} nodes, and {}.",
                                            state.probe, patch.size(), words));
            state.contacts.push_back(contact);
        }
    }
    return states;
}

mesh::Region held_region(const Points& held, const Points& others, double spacing) {
    const mesh::Box box = mesh::bounding_box(held);
    for (const double share : {1e-3, 1e-5, 1e-7}) {
        const double margin = share * std::max(box.longest_side(), spacing);
        const mesh::BoxRegion region{box.min.array() - margin, box.max.array() + margin};
        const auto is_in = [&](const auto& node) { return mesh::contains(region, Vec3(node.transpose())); };
        if (std::ranges::none_of(others.rowwise(), is_in)) return region;
    }
    return mesh::PointsRegion{held, spacing};
}

}  // namespace palpate::pipeline
