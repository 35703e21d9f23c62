#include "mesh/meshing/tetrahedralise.h"

#include <fmt/core.h>
#include <tetgen.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <map>
#include <new>

#include "mesh/errors.h"
#include "mesh/system/bytes.h"
#include "mesh/system/child_process.h"
#include "mesh/topology/shells.h"

namespace palpate::mesh {
namespace {

constexpr double allowed_volume_error = 1e-3;  // share of what the surface encloses
constexpr int out_of_memory = 1;               // TetGen's code for it
constexpr double least_quality = 1e-4;         // 1: a regular tetrahedron, 0: a flat one

// ---- In the child process ---------------------------------------------------------------------------------------

/// The surface and the hole seeds as TetGen wants them; its destructor frees with delete[] what new[] made here.
void give(const Surface& surface, const Points& holes, double scale, tetgenio& in) {
    in.firstnumber = 0;
    in.numberofpoints = static_cast<int>(surface.vertices.rows());
    in.pointlist = new REAL[static_cast<std::size_t>(surface.vertices.size())];
    Eigen::Map<Points>(in.pointlist, surface.vertices.rows(), 3) = scale * surface.vertices;

    in.numberoffacets = static_cast<int>(surface.triangles.rows());
    in.facetlist = new tetgenio::facet[static_cast<std::size_t>(in.numberoffacets)];
    for (int t = 0; t < in.numberoffacets; ++t) {
        tetgenio::facet& facet = in.facetlist[t];
        tetgenio::init(&facet);
        facet.numberofpolygons = 1;
        facet.polygonlist = new tetgenio::polygon[1];
        facet.polygonlist[0].numberofvertices = 3;
        facet.polygonlist[0].vertexlist = new int[3];
        for (int i = 0; i < 3; ++i) facet.polygonlist[0].vertexlist[i] = surface.triangles(t, i);
    }

    in.numberofholes = static_cast<int>(holes.rows());
    if (holes.rows() > 0) {
        in.holelist = new REAL[static_cast<std::size_t>(holes.size())];
        Eigen::Map<Points>(in.holelist, holes.rows(), 3) = scale * holes;
    }
}

/// What TetGen came to.
struct Filling {
    int code = 0;  // why it gave up; 0: it did not
    Points nodes;
    Tetrahedra tetrahedra;

    template <class Archive>
    void serialize(Archive& archive) {
        archive(code, nodes, tetrahedra);
    }
};

Filling call_tetgen(const Surface& surface, const Points& holes, double scale, std::string switches) {
    tetgenio in, out;
    give(surface, holes, scale, in);
    try {
        ::tetrahedralize(switches.data(), &in, &out);
    } catch (const int code) {
        if (code == out_of_memory) throw std::bad_alloc();
        return {.code = code, .nodes = {}, .tetrahedra = {}};
    }
    Filling filling{.nodes = Eigen::Map<const Points>(out.pointlist, out.numberofpoints, 3), .tetrahedra = {}};
    if (out.numberofcorners == 4)
        filling.tetrahedra = Eigen::Map<const Tetrahedra>(out.tetrahedronlist, out.numberoftetrahedra, 4);
    return filling;
}

// ---- In this process --------------------------------------------------------------------------------------------

/// Why TetGen gave up, in words; empty where it did not.
std::string complaint(int code) {
    switch (code) {
        case 0:
            return "";
        case 3:
            return "it found that the surface crosses itself";
        case 4:
            return "it found a detail that is too small";
        case 5:
            return "it found two sides of the surface too close to each other";
        default:
            return fmt::format("it gave up (code {})", code);
    }
}

/// 6 sqrt(2) V / (root mean square edge)^3 of the worst element: 1 for a regular one.
double worst_quality(const VolumeMesh& mesh, const Eigen::VectorXd& volumes) {
    double worst = 1;
    for (Eigen::Index e = 0; e < mesh.tetrahedra.rows(); ++e) {
        double squares = 0;
        for (int i = 0; i < 4; ++i)
            for (int j = i + 1; j < 4; ++j)
                squares +=
                    (mesh.nodes.row(mesh.tetrahedra(e, i)) - mesh.nodes.row(mesh.tetrahedra(e, j))).squaredNorm();
        worst = std::min(worst, 6 * std::sqrt(2.0) * volumes[e] / std::pow(squares / 6, 1.5));
    }
    return worst;
}

/// What is wrong with the answer, in words; empty: nothing. Turns inverted elements.
std::string fault(VolumeMesh& mesh, const Surface& surface, double expected_volume) {
    if (mesh.tetrahedra.rows() == 0) return "it returned no elements";
    if (!mesh.nodes.allFinite() || mesh.tetrahedra.minCoeff() < 0 || mesh.tetrahedra.maxCoeff() >= mesh.nodes.rows())
        return "it returned nodes that are not finite or do not exist";
    if (mesh.nodes.rows() < surface.vertices.rows() || mesh.nodes.topRows(surface.vertices.rows()) != surface.vertices)
        return "it moved or dropped vertices of the surface";

    std::vector<char> used(static_cast<std::size_t>(mesh.nodes.rows()), 0);
    for (const int node : mesh.tetrahedra.reshaped()) used[static_cast<std::size_t>(node)] = 1;
    if (const auto loose = std::count(used.begin(), used.end(), 0); loose > 0)
        return fmt::format("{} of its nodes belong to no element", loose);

    Eigen::VectorXd volumes = element_volumes(mesh);
    for (Eigen::Index e = 0; e < volumes.size(); ++e)
        if (volumes[e] < 0) {
            std::swap(mesh.tetrahedra(e, 0), mesh.tetrahedra(e, 1));
            volumes[e] = -volumes[e];
        }
    if (std::abs(volumes.sum() - expected_volume) > allowed_volume_error * expected_volume)
        return fmt::format("its elements fill {:.6g} mm^3 where the surface encloses {:.6g} mm^3", volumes.sum(),
                           expected_volume);
    if (const double quality = worst_quality(mesh, volumes); quality < least_quality)
        return fmt::format("its flattest element has a quality of {:.1e} (at least {:.0e} is allowed)", quality,
                           least_quality);
    return {};
}

/// How the child ended otherwise than with an answer, in words.
std::string ending(const ChildResult& child, const TetrahedraliseOptions& options) {
    using End = ChildResult::End;
    switch (child.end) {
        case End::OutOfTime:
            return fmt::format("it did not end within the time limit of {:.3g} s", options.time_limit);
        case End::OutOfMemory:
            return fmt::format("it needed more than the memory limit of {:.0f} MiB", options.memory_limit);
        case End::Crashed:
            return fmt::format("it crashed ({})", strsignal(child.signal));
        case End::Failed:
            return fmt::format("it gave up (exit code {})", child.code);
        case End::Answered:
            break;
    }
    return {};
}

double mean_edge(const Surface& surface) {
    double sum = 0;
    for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t)
        for (int i = 0; i < 3; ++i)
            sum += (surface.vertices.row(surface.triangles(t, i)) -
                    surface.vertices.row(surface.triangles(t, (i + 1) % 3)))
                       .norm();
    return sum / static_cast<double>(surface.triangles.size());
}

/// @throws InvalidInput unless every edge has two triangles that agree, and every vertex a triangle.
void require_closed(const Surface& surface) {
    std::map<std::pair<int, int>, int> balance;  // of an edge's triangles, one way less the other
    std::vector<char> used(static_cast<std::size_t>(surface.vertices.rows()), 0);
    for (const auto& t : surface.triangles.rowwise())
        for (int i = 0; i < 3; ++i) {
            const int a = t[i], b = t[(i + 1) % 3];
            used[static_cast<std::size_t>(a)] = 1;
            balance[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
        }
    const auto open = std::count_if(balance.begin(), balance.end(), [](const auto& edge) { return edge.second != 0; });
    if (surface.triangles.rows() == 0 || open > 0)
        throw InvalidInput(
            fmt::format("Tetrahedra: the surface is not closed ({} triangles, {} open edges). Repair it first.",
                        surface.triangles.rows(), open));
    const auto loose = std::find(used.begin(), used.end(), 0);
    if (loose != used.end())
        throw InvalidInput(fmt::format("Tetrahedra: vertex {} of the surface belongs to no triangle. Repair it first.",
                                       loose - used.begin()));
}

/// All of them as one, their vertices and triangles in this order.
Surface united(Surface surface, const std::vector<Surface>& others) {
    for (const Surface& other : others) {
        const Eigen::Index vertices = surface.vertices.rows(), triangles = surface.triangles.rows();
        surface.vertices.conservativeResize(vertices + other.vertices.rows(), Eigen::NoChange);
        surface.vertices.bottomRows(other.vertices.rows()) = other.vertices;
        surface.triangles.conservativeResize(triangles + other.triangles.rows(), Eigen::NoChange);
        surface.triangles.bottomRows(other.triangles.rows()) = other.triangles.array() + static_cast<int>(vertices);
    }
    return surface;
}

}  // namespace

void TetrahedraliseOptions::validate() const {
    const auto check = [](const char* name, double value, double least, double most, const char* unit) {
        if (!(value >= least && value <= most))
            throw InvalidInput(
                fmt::format("Tetrahedra: {} is {} {}; {} to {} is allowed.", name, value, unit, least, most));
    };
    check("edge_length", edge_length, 0, 1e9, "mm");
    check("quality", quality, 1.1, 3, "");
    check("time_limit", time_limit, 1e-3, 86400, "s");
    check("memory_limit", memory_limit, 16, 1e7, "MiB");
}

VolumeMesh tetrahedralise(const Surface& surface, const TetrahedraliseOptions& options) {
    return tetrahedralise_within(surface, {}, options);
}

VolumeMesh tetrahedralise_within(const Surface& outside, const std::vector<Surface>& interfaces,
                                 const TetrahedraliseOptions& options) {
    options.validate();
    const Surface surface = united(outside, interfaces);
    require_closed(surface);
    const std::vector<Shell> shells = find_shells(outside);
    const double volume = enclosed_volume(shells);
    const Points holes = cavity_points(shells);

    // TetGen's tolerances suit bodies of about this size; a power of two scales without rounding.
    const double scale = std::exp2(std::round(std::log2(1000 / bounding_box(surface.vertices).diagonal())));
    const double edge = scale * (options.edge_length > 0 ? options.edge_length : mean_edge(surface));
    const double largest =
        edge * edge * edge / (3 * std::sqrt(2.0));  // twice a regular tetrahedron: the mean comes out near one

    // First with the surface's triangles kept (Y), then with leave to cut them, in what is left of the time.
    const auto start = std::chrono::steady_clock::now();
    std::string faults;
    for (const char* keep : {"Y", ""}) {
        const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        const double left = options.time_limit - spent;
        const ChildLimits limits{*keep ? 0.6 * left : left, options.memory_limit};
        const std::string switches = fmt::format("p{}q{:.4f}a{:.9f}Q", keep, options.quality, largest);
        ChildResult child =
            run_in_child([&] { return to_bytes(call_tetgen(surface, holes, scale, switches)); }, limits);
        std::string wrong = ending(child, options);
        if (child.end == ChildResult::End::Answered) {
            Filling filling;
            from_bytes(std::move(child.answer), filling);
            VolumeMesh mesh{.nodes = filling.nodes / scale, .tetrahedra = std::move(filling.tetrahedra), .faces = {}};
            wrong = complaint(filling.code);
            if (wrong.empty()) wrong = fault(mesh, surface, volume);
            if (wrong.empty()) {
                mesh.faces = boundary_faces(mesh.tetrahedra);
                return mesh;
            }
        }
        if (child.end == ChildResult::End::OutOfMemory) {
            faults += wrong;
            break;  // without Y it needs no less
        }
        faults += *keep ? wrong : "; and with leave to cut the surface's triangles " + wrong;
    }
    throw SolverFailure(
        fmt::format("TetGen did not fill the surface: {}. Repair and remesh the surface, with a {} edge length.",
                    faults, faults.find("limit") != std::string::npos ? "larger" : "smaller"));
}

}  // namespace palpate::mesh
