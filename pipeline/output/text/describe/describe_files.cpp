#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <sstream>

#include "identify/numerics/summaries.h"
#include "mesh/errors.h"
#include "mesh/formats/read_body.h"
#include "mesh/formats/solution/read_solution.h"
#include "mesh/formats/surface/read_surface.h"
#include "mesh/formats/vtk/poly_data.h"
#include "mesh/text/atomic_file.h"
#include "mesh/topology/check_surface.h"
#include "pipeline/output/csv/posterior.h"
#include "pipeline/output/text/describe/describe.h"

namespace palpate::pipeline {
namespace {

namespace fs = std::filesystem;

std::string box_in_words(const Points& points) {
    if (points.rows() == 0) return "empty";
    const Vec3 extent = mesh::bounding_box(points).extent();
    return fmt::format("{:.4g} x {:.4g} x {:.4g} mm", extent.x(), extent.y(), extent.z());
}

/// "error [mm]: 0.1 to 6" of each array, lengths of vectors.
void describe_arrays(const std::vector<mesh::DataArray>& arrays, const char* of, Description& description) {
    for (const mesh::DataArray& array : arrays) {
        if (array.values.rows() == 0) continue;
        const Eigen::VectorXd sizes = array.values.cols() == 1 ? Eigen::VectorXd(array.values.col(0))
                                                               : Eigen::VectorXd(array.values.rowwise().norm());
        description.lines.push_back(fmt::format("{} of {}: {:.4g} to {:.4g}{}", array.name, of, sizes.minCoeff(),
                                                sizes.maxCoeff(), array.values.cols() == 1 ? "" : " (lengths)"));
    }
}

/// What each kind of table begins with, and what it is.
const std::map<std::string, std::string>& tables() {
    static const std::map<std::string, std::string> kinds{
        {"parameter,link,", "stiffnesses with their intervals"},
        {"parameter,other,", "stiffnesses that are known together rather than alone"},
        {"weight,", "particles: stiffnesses that stand for the posterior, with their weights"},
        {"stage,step,", "how the search and the particles converged"},
        {"probe,time,x,y,z,fx", "probes: forces on the body"},
        {"probe,time,marker,x", "measured positions of markers"},
        {"probe,time,marker,ux", "measured displacements of markers"},
        {"probe,time,tool,x", "motions of tools"},
        {"probe,time,tool,fx", "measured reactions of tools"},
        {"probe,time,actuator", "what actuators were set to"},
        {"probe,time,gx", "gravity and pressure that are known to act"},
        {"marker,x,y,z", "markers at rest"},
        {"probe,marker,axis,time", "a body in motion, measured and played"},
        {"own,spheres,", "errors of skeletons over their number of spheres"}};
    return kinds;
}

}  // namespace

Description describe_table(const fs::path& file) {
    std::istringstream lines(mesh::read_text(file));
    std::string header, line;
    int rows = 0;
    while (std::getline(lines, line)) {
        if (line.empty() || line[0] == '#') continue;
        if (header.empty())
            header = line;
        else
            ++rows;
    }
    const auto kind = std::ranges::find_if(tables(), [&](const auto& k) { return header.starts_with(k.first); });
    if (kind == tables().end()) {
        throw InvalidInput(
            fmt::format("{}: a table with the columns {}, which is none of ours", file.string(), header));
    }
    Description description{.kind = kind->second, .lines = {fmt::format("{} rows: {:.300}", rows, header)}, .next = {}};
    if (kind->first != "parameter,link,") return description;
    const auto posterior = read_posterior(file);
    const auto informed = std::ranges::count_if(posterior, [](const auto& row) { return row.informed; });
    description.lines.push_back(
        fmt::format("{} of {} are constrained by the measurements", informed, posterior.size()));
    for (std::size_t i = 0; i < std::min<std::size_t>(posterior.size(), 8); ++i) {
        const auto& row = posterior[i];
        description.lines.push_back(fmt::format("{:<20} {:.4g} {} (95 %: {:.4g} to {:.4g})", row.parameter, row.q50,
                                                row.unit, row.q025, row.q975));
    }
    return description;
}

Description describe_series(const fs::path& file) {
    const auto steps = mesh::read_pvd(file);
    Description description{
        .kind = fmt::format("a series of {} steps for ParaView", steps.size()), .lines = {}, .next = {}};
    if (!steps.empty()) {
        description.lines.push_back("first: " + steps.front().file.string());
        const Description first = describe(steps.front().file);
        description.lines.insert(description.lines.end(), first.lines.begin(), first.lines.end());
    }
    description.next = "paraview " + file.string();
    return description;
}

Description describe_poly_data(const fs::path& file) {
    const mesh::PolyData part = mesh::as_poly_data(mesh::read_vtk(file, mesh::VtkKind::poly_data));
    Description description{.kind = fmt::format("{} points, {} triangles, {} lines", part.points.rows(),
                                                part.triangles.rows(), part.lines.rows()),
                            .lines = {box_in_words(part.points)},
                            .next = "paraview " + file.string()};
    describe_arrays(part.data.points, "points", description);
    describe_arrays(part.data.cells, "cells", description);
    return description;
}

Description describe_volume(const fs::path& file) {
    mesh::MeshData data;
    const mesh::VolumeMesh body = mesh::read_vtu(file, &data);
    Description description{
        .kind = fmt::format("a volume of {} {} tetrahedra, {} nodes", body.tetrahedra.rows(),
                            body.is_quadratic() ? "quadratic" : "linear", body.nodes.rows()),
        .lines = {fmt::format("{}, {:.4g} mm^3", box_in_words(body.nodes), mesh::element_volumes(body).sum())},
        .next = "paraview " + file.string()};
    describe_arrays(data.points, "nodes", description);
    describe_arrays(data.cells, "tetrahedra", description);
    return description;
}

Description describe_surface(const fs::path& file) {
    const mesh::SurfaceReport report = mesh::check_surface(mesh::read_surface(file));
    const Vec3 extent = report.box.extent();
    Description description{
        .kind = fmt::format("a surface of {} triangles", report.triangles),
        .lines = {fmt::format("{:.4g} x {:.4g} x {:.4g} in the units of the file", extent.x(), extent.y(), extent.z())},
        .next = "palpate run " + file.string()};
    const auto faults = mesh::describe_faults(report);
    for (const std::string& fault : faults) description.lines.push_back(fault);
    if (faults.empty()) description.lines.push_back(fmt::format("sound; it encloses {:.4g}", report.volume));
    return description;
}

Description describe_body(const fs::path& file) {
    const mesh::BodyFile body = mesh::read_body(file);
    Description description{
        .kind = fmt::format("a body within a surface of {} triangles", body.surface.triangles.rows()),
        .lines = {box_in_words(body.surface.vertices)},
        .next = "palpate run " + file.string()};
    if (body.volume) {
        description.kind = fmt::format("a body of {} {} tetrahedra, {} nodes", body.volume->tetrahedra.rows(),
                                       body.volume->is_quadratic() ? "quadratic" : "linear", body.volume->nodes.rows());
    }
    description.lines.insert(description.lines.end(), body.notes.begin(), body.notes.end());
    return description;
}

Description describe_solution(const fs::path& file) {
    const mesh::Solution solution = mesh::read_solution(file);
    Description description{
        .kind = fmt::format("{} displacement fields of {} nodes", solution.steps.size(), solution.nodes.rows()),
        .lines = {box_in_words(solution.nodes)},
        .next = fmt::format("palpate probe BODY --from {} -o set",
                            file.has_parent_path() ? file.parent_path().string() : ".")};
    for (const mesh::SolvedStep& step : solution.steps) {
        const Eigen::VectorXd lengths = step.displacement.rowwise().norm();
        description.lines.push_back(
            fmt::format("time {:g}: up to {:.4g}", step.time,
                        lengths.unaryExpr([](double u) { return identify::known_part(u); }).maxCoeff()));
    }
    return description;
}

}  // namespace palpate::pipeline
