#include "mesh/formats/volume/write_volume.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <map>

#include "mesh/text/atomic_file.h"

namespace palpate::mesh {
namespace {

using Text = fmt::memory_buffer;

template <class... T>
void put(Text& text, fmt::format_string<T...> format, T&&... values) {
    fmt::format_to(std::back_inserter(text), format, std::forward<T>(values)...);
}

/// `kind`: NSET or ELSET.
void put_set(Text& text, const char* kind, const std::string& name, const std::vector<char>& is_in) {
    put(text, "*{}, {}={}\n", kind, kind, name);
    int on_line = 0;
    for (std::size_t n = 0; n < is_in.size(); ++n)
        if (is_in[n]) put(text, "{}{}", on_line++ == 0 ? "" : (on_line % 10 == 1 ? ",\n" : ", "), n + 1);
    put(text, "\n");
}

/// The sides of elements that lie on the boundary: element, and the side's number as Abaqus counts.
std::vector<std::pair<Eigen::Index, int>> boundary_sides(const VolumeMesh& mesh) {
    // Sides 1 to 4 of C3D4 and C3D10. [Abaqus Analysis User's Guide, 28.1.4]
    constexpr std::array<std::array<int, 3>, 4> sides{{{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}}};
    const auto sorted = [](std::array<int, 3> corners) {
        std::ranges::sort(corners);
        return corners;
    };
    std::map<std::array<int, 3>, int> boundary;
    for (const auto& face : mesh.faces.rowwise()) boundary[sorted({face[0], face[1], face[2]})] = 1;
    std::vector<std::pair<Eigen::Index, int>> found;
    for (Eigen::Index e = 0; e < mesh.tetrahedra.rows(); ++e)
        for (int s = 0; s < 4; ++s)
            if (boundary.contains(sorted({mesh.tetrahedra(e, sides[s][0]), mesh.tetrahedra(e, sides[s][1]),
                                          mesh.tetrahedra(e, sides[s][2])})))
                found.emplace_back(e, s + 1);
    return found;
}

// CalculiX cuts numbers after 20 characters: 12 digits and an exponent fit.

void put_material(Text& text, const SolverMaterial& material, bool is_neo_hookean, const std::string& name,
                  const std::string& elements) {
    put(text, "*MATERIAL, NAME={}\n", name);
    if (is_neo_hookean) {
        const double mu = material.young / (2 * (1 + material.poisson));
        const double K = material.young / (3 * (1 - 2 * material.poisson));
        put(text, "*HYPERELASTIC, NEO HOOKE\n{:.12g}, {:.12g}\n", mu / 2, 2 / K);
    } else {
        put(text, "*ELASTIC\n{:.12g}, {:.12g}\n", material.young, material.poisson);
    }
    put(text, "*DENSITY\n{:.12g}\n*SOLID SECTION, ELSET={}, MATERIAL={}\n", material.density, elements, name);
}

void put_materials(Text& text, const SolverSetting& setting) {
    if (setting.regions.empty()) {
        put_material(text, setting.material, setting.is_neo_hookean, "BODY", "EBODY");
        return;
    }
    for (int r = -1; r < static_cast<int>(setting.regions.size()); ++r) {
        const std::string elements = r < 0 ? "EBODY0" : fmt::format("EREGION{}", r + 1);
        std::vector<char> is_in(setting.region_of_element.size());
        for (std::size_t e = 0; e < is_in.size(); ++e) is_in[e] = setting.region_of_element[e] == r;
        put_set(text, "ELSET", elements, is_in);
        put_material(text, r < 0 ? setting.material : setting.regions[static_cast<std::size_t>(r)],
                     setting.is_neo_hookean, r < 0 ? "BODY" : fmt::format("REGION{}", r + 1), elements);
    }
}

void put_steps(Text& text, const SolverSetting& setting) {
    if (setting.steps.empty()) return;
    if (std::ranges::count(setting.held, 1) > 0) put(text, "*BOUNDARY\nNHELD, 1, 3\n");
    for (const Eigen::VectorXd& forces : setting.steps) {
        put(text, "*STEP{}\n*STATIC\n{}, 1.\n*CLOAD, OP=NEW\n", setting.large_deformation ? ", NLGEOM, INC=1000" : "",
            setting.large_deformation ? 0.25 : 1.0);
        for (Eigen::Index k = 0; k < forces.size(); ++k)
            if (forces[k] != 0) put(text, "{}, {}, {:.12g}\n", k / 3 + 1, k % 3 + 1, forces[k]);
        put(text, "*NODE FILE, FREQUENCY=1000\nU\n*END STEP\n");
    }
}

std::vector<char> nodes_of(const Faces& faces, Eigen::Index nodes) {
    std::vector<char> is_in(static_cast<std::size_t>(nodes), 0);
    for (const int node : faces.reshaped()) is_in[static_cast<std::size_t>(node)] = 1;
    return is_in;
}

/// Nodes counted from 1, in Gmsh's order: it counts the midsides of edges (2,3) and (1,3) the other way round.
template <class Row>
void put_gmsh_nodes(Text& text, const Row& row) {
    for (Eigen::Index c = 0; c < row.size(); ++c) {
        const Eigen::Index from = row.size() == 10 && c >= 8 ? 17 - c : c;
        put(text, " {}", row[from] + 1);
    }
    put(text, "\n");
}

struct GmshTypes {
    int tetrahedron, triangle;
};
GmshTypes gmsh_types(const VolumeMesh& mesh) { return mesh.is_quadratic() ? GmshTypes{11, 9} : GmshTypes{4, 2}; }

void put_version_2(Text& text, const VolumeMesh& mesh) {
    const auto [tetrahedron, triangle] = gmsh_types(mesh);
    put(text, "$Nodes\n{}\n", mesh.nodes.rows());
    for (Eigen::Index n = 0; n < mesh.nodes.rows(); ++n)
        put(text, "{} {} {} {}\n", n + 1, mesh.nodes(n, 0), mesh.nodes(n, 1), mesh.nodes(n, 2));
    put(text, "$EndNodes\n$Elements\n{}\n", mesh.faces.rows() + mesh.tetrahedra.rows());
    Eigen::Index number = 0;
    for (const auto& face : mesh.faces.rowwise()) {
        put(text, "{} {} 2 2 1", ++number, triangle);
        put_gmsh_nodes(text, face);
    }
    for (const auto& element : mesh.tetrahedra.rowwise()) {
        put(text, "{} {} 2 1 1", ++number, tetrahedron);
        put_gmsh_nodes(text, element);
    }
    put(text, "$EndElements\n");
}

void put_version_4(Text& text, const VolumeMesh& mesh) {
    const auto [tetrahedron, triangle] = gmsh_types(mesh);
    const Box box = bounding_box(mesh.nodes);
    const std::string bounds =
        fmt::format("{} {} {} {} {} {}", box.min.x(), box.min.y(), box.min.z(), box.max.x(), box.max.y(), box.max.z());
    put(text, "$Entities\n0 0 1 1\n1 {} 1 2 0\n1 {} 1 1 1 1\n$EndEntities\n", bounds, bounds);
    const Eigen::Index n = mesh.nodes.rows(), all = mesh.faces.rows() + mesh.tetrahedra.rows();
    put(text, "$Nodes\n1 {} 1 {}\n3 1 0 {}\n", n, n, n);
    for (Eigen::Index i = 0; i < n; ++i) put(text, "{}\n", i + 1);
    for (const auto& node : mesh.nodes.rowwise()) put(text, "{} {} {}\n", node[0], node[1], node[2]);
    put(text, "$EndNodes\n$Elements\n2 {} 1 {}\n2 1 {} {}\n", all, all, triangle, mesh.faces.rows());
    Eigen::Index number = 0;
    for (const auto& face : mesh.faces.rowwise()) {
        put(text, "{}", ++number);
        put_gmsh_nodes(text, face);
    }
    put(text, "3 1 {} {}\n", tetrahedron, mesh.tetrahedra.rows());
    for (const auto& element : mesh.tetrahedra.rowwise()) {
        put(text, "{}", ++number);
        put_gmsh_nodes(text, element);
    }
    put(text, "$EndElements\n");
}

}  // namespace

void write_inp(const std::filesystem::path& file, const VolumeMesh& mesh, const SolverSetting& setting) {
    Text text;
    put(text, "*HEADING\nmade by palpate; mm, N, MPa, tonne, s\n*NODE, NSET=NALL\n");
    for (Eigen::Index n = 0; n < mesh.nodes.rows(); ++n)
        put(text, "{}, {:.12g}, {:.12g}, {:.12g}\n", n + 1, mesh.nodes(n, 0), mesh.nodes(n, 1), mesh.nodes(n, 2));
    put(text, "*ELEMENT, TYPE={}, ELSET=EBODY\n", mesh.is_quadratic() ? "C3D10" : "C3D4");
    for (Eigen::Index e = 0; e < mesh.tetrahedra.rows(); ++e) {
        put(text, "{}", e + 1);
        for (const int node : mesh.tetrahedra.row(e)) put(text, ", {}", node + 1);
        put(text, "\n");
    }
    put_set(text, "NSET", "NSKIN", nodes_of(mesh.faces, mesh.nodes.rows()));
    if (std::ranges::count(setting.held, 1) > 0) put_set(text, "NSET", "NHELD", setting.held);
    put(text, "*SURFACE, NAME=SKIN, TYPE=ELEMENT\n");
    for (const auto& [element, side] : boundary_sides(mesh)) put(text, "{}, S{}\n", element + 1, side);
    put_materials(text, setting);
    put_steps(text, setting);
    write_text(file, fmt::to_string(text));
}

void write_gmsh(const std::filesystem::path& file, const VolumeMesh& mesh, GmshVersion version) {
    Text text;
    put(text, "$MeshFormat\n{} 0 8\n$EndMeshFormat\n$Comments\nmade by palpate, mm\n$EndComments\n",
        version == GmshVersion::v2_2 ? "2.2" : "4.1");
    put(text, "$PhysicalNames\n2\n2 2 \"skin\"\n3 1 \"body\"\n$EndPhysicalNames\n");
    version == GmshVersion::v2_2 ? put_version_2(text, mesh) : put_version_4(text, mesh);
    write_text(file, fmt::to_string(text));
}

}  // namespace palpate::mesh
