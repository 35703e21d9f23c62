#include "bench/fem/bars.h"

#include <fmt/os.h>

#include <fstream>

#include "mesh/errors.h"

namespace palpate::bench {

namespace {

template <class Values>
void write_raw(const std::filesystem::path& file, const Values& values) {
    std::ofstream out(file, std::ios::binary);
    out.write(reinterpret_cast<const char*>(values.data()),
              static_cast<std::streamsize>(sizeof(*values.data()) * values.size()));
    if (!out) throw IoError(file.string() + " cannot be written");
}

std::vector<int> flagged(const std::vector<char>& flags) {
    std::vector<int> nodes;
    for (std::size_t i = 0; i < flags.size(); ++i) {
        if (flags[i]) nodes.push_back(static_cast<int>(i));
    }
    return nodes;
}

/// `count` of these, spread evenly.
std::vector<int> some_of(const std::vector<int>& nodes, int count) {
    std::vector<int> result;
    for (int k = 0; k < count; ++k)
        result.push_back(nodes[static_cast<std::size_t>((k + 0.5) * static_cast<double>(nodes.size()) / count)]);
    return result;
}

/// Counts from 1, midsides in the same order.
void write_deck(const std::filesystem::path& file, const Problem& problem) {
    auto out = fmt::output_file(file.string());
    const auto& [nodes, tetrahedra, faces] = problem.mesh;
    out.print("*NODE\n");
    for (Eigen::Index i = 0; i < nodes.rows(); ++i) {
        out.print("{}, {:.12g}, {:.12g}, {:.12g}\n", i + 1, nodes(i, 0), nodes(i, 1), nodes(i, 2));
    }
    out.print("*ELEMENT, TYPE=C3D{}, ELSET=BODY\n", tetrahedra.cols());
    for (Eigen::Index e = 0; e < tetrahedra.rows(); ++e) {
        out.print("{}", e + 1);
        for (const int node : tetrahedra.row(e)) out.print(", {}", node + 1);
        out.print("\n");
    }
    out.print("*NSET, NSET=MARKERS\n");
    for (const int node : problem.markers) out.print("{},\n", node + 1);
    out.print("*BOUNDARY\n");
    for (const int node : flagged(problem.held)) out.print("{}, 1, 3\n", node + 1);
    out.print("*MATERIAL, NAME=M\n*ELASTIC\n{}, {}\n*SOLID SECTION, ELSET=BODY, MATERIAL=M\n*STEP\n*GREEN\n*CLOAD\n",
              problem.material.young, problem.material.poisson);
    for (const int node : problem.loaded) out.print("{}, 3, 1.\n", node + 1);
    out.print("*NODE PRINT, NSET=MARKERS\nU\n*END STEP\n");
}

}  // namespace

std::vector<Bar> bars() {
    return {{"5k-linear", {50, 10, 8}, false},        {"5k-quadratic", {25, 5, 4}, true},
            {"20k-linear", {80, 15, 15}, false},      {"20k-quadratic", {40, 7, 8}, true},
            {"100k-linear", {138, 27, 26}, false},    {"100k-quadratic", {70, 13, 13}, true},
            {"300k-linear", {200, 38, 38}, false},    {"300k-quadratic", {101, 19, 19}, true},
            {"1000k-quadratic", {150, 29, 29}, true}, {"3000k-quadratic", {214, 42, 42}, true}};
}

Problem make_problem(const Bar& bar, int loads) {
    Problem problem;
    problem.mesh = mesh::make_bar(Vec3::Zero(), Vec3(100, 20, 20), bar.cells);
    const Eigen::Index corners = problem.mesh.nodes.rows();
    if (bar.is_quadratic) problem.mesh = mesh::to_quadratic(problem.mesh);
    std::vector<int> top, all;
    for (Eigen::Index i = 0; i < problem.mesh.nodes.rows(); ++i) {
        const Vec3 x = problem.mesh.nodes.row(i);
        problem.held.push_back(x.x() < 1e-9);
        if (x.x() > 20 && x.z() > 20 - 1e-9 && i < corners) top.push_back(static_cast<int>(i));
        if (x.x() > 1) all.push_back(static_cast<int>(i));
    }
    problem.loaded = some_of(top, loads);
    problem.markers = some_of(all, 200);
    return problem;
}

Eigen::SparseMatrix<double> unit_forces(const Problem& problem) {
    Eigen::SparseMatrix<double> F(problem.mesh.nodes.size(), static_cast<Eigen::Index>(problem.loaded.size()));
    for (Eigen::Index j = 0; j < F.cols(); ++j) F.insert(3 * problem.loaded[j] + 2, j) = 1;
    F.makeCompressed();
    return F;
}

void write_problem(const std::filesystem::path& folder, const Problem& problem) {
    std::filesystem::create_directories(folder);
    using Rows = Eigen::Matrix<int, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    using RowPoints = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
    write_raw(folder / "nodes.f64", RowPoints(problem.mesh.nodes));
    write_raw(folder / "tetrahedra.i32", Rows(problem.mesh.tetrahedra));
    write_raw(folder / "held.i32", flagged(problem.held));
    write_raw(folder / "loaded.i32", problem.loaded);
    write_raw(folder / "markers.i32", problem.markers);
    fmt::output_file((folder / "material.txt").string())
        .print("{} {} {}\n", problem.material.young, problem.material.poisson, problem.mesh.tetrahedra.cols());
    write_deck(folder / "green.inp", problem);
}

void write_displacements(const std::filesystem::path& file, const Problem& problem, const Eigen::MatrixXd& U) {
    std::vector<double> values;
    for (Eigen::Index j = 0; j < U.cols(); ++j) {
        for (const int node : problem.markers) {
            for (int c = 0; c < 3; ++c) values.push_back(U(3 * node + c, j));
        }
    }
    write_raw(file, values);
}

}  // namespace palpate::bench
