// How long the reference body takes: bars of quadratic tetrahedra, held at one end, probed on top.
// Usage: fem_bench [threads]. One line a mesh; wall seconds, peak memory of the process so far.

#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>
#include <cstdlib>

#include "fem/elastic_body.h"
#include "fem/patch_load.h"

using namespace palpate;

namespace {

template <class Work>
double seconds(Work&& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double peak_gb() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) * 1024e-9;
}

/// Probes along the top of the bar, aslant.
Eigen::SparseMatrix<double> probes(const mesh::VolumeMesh& mesh, int count) {
    std::vector<mesh::Contact> contacts;
    for (int k = 0; k < count; ++k) {
        const double x = 20 + 75.0 * (k + 0.5) / count;
        contacts.push_back({Vec3(x, 10 + 5 * std::sin(k), 20), Vec3(0.1 * std::cos(k), 0, -1), 3.0});
    }
    return fem::patch_loads(mesh, contacts, 1e-6);
}

void measure(const Eigen::Vector3i& cells, int threads) {
    const auto mesh = mesh::to_quadratic(mesh::make_bar(Vec3::Zero(), Vec3(100, 20, 20), cells));
    std::vector<char> held(mesh.nodes.rows());
    for (Eigen::Index i = 0; i < mesh.nodes.rows(); ++i) held[i] = mesh.nodes(i, 0) < 1e-9;

    const double start = seconds([&] {
        const fem::ElasticBody body(mesh, {}, held, {.threads = threads});
        Eigen::SparseMatrix<double> loads;
        const double patch_100 = seconds([&] { loads = probes(mesh, 100); });
        const Eigen::SparseMatrix<double> one = loads.leftCols(1);
        const double solve_1 = seconds([&] { body.solve(one); });
        const double solve_100 = seconds([&] { body.solve(loads); });
        fmt::print("{:>8} {:>9} {:>9.3f} {:>9.3f} {:>9.3f} {:>9.4f} {:>9.3f} {:>9.3f}", mesh.nodes.rows(),
                   mesh.tetrahedra.rows(), body.stats().seconds_assemble, body.stats().seconds_factor,
                   body.stats().factor_entries * 8e-9, solve_1, solve_100, patch_100);
    });
    fmt::print(" {:>9.3f} {:>9.2f}\n", start, peak_gb());
    std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
    const int threads = argc > 1 ? std::atoi(argv[1]) : 2;
    fmt::print("threads {}\n{:>8} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9}\n", threads, "nodes",
               "elements", "assemble", "factor", "factor GB", "1 probe", "100", "patches", "all", "peak GB");
    measure({25, 5, 5}, threads);
    measure({43, 8, 8}, threads);
    measure({72, 13, 13}, threads);
}
