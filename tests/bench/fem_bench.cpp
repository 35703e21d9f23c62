// How long the reference body takes: bars of linear and of quadratic tetrahedra, clamped at one end, pulled at nodes on
// top. One line a mesh; wall seconds, peak memory of the process so far. tests/bench/fem/compare.py runs it beside
// other codes.

#include <fmt/format.h>
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <map>

#include "bench/fem/bars.h"
#include "fem/distributed/processes.h"
#include "fem/elastic_body.h"
#include "mesh/errors.h"

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

struct Settings {
    int threads = 2, loads = 100;
    double memory = 0;  // that a factor may take [GB]; 0: as the body decides
    fem::Solver solver = fem::Solver::automatic;
    std::string only, folder{};  // empty: all meshes; nothing is written
};

void measure(const bench::Bar& bar, const Settings& settings) {
    const bench::Problem problem = bench::make_problem(bar, settings.loads);
    if (!settings.folder.empty()) bench::write_problem(std::filesystem::path(settings.folder) / bar.name, problem);
    const Eigen::SparseMatrix<double> loads = bench::unit_forces(problem), one = loads.leftCols(1);

    double solve_1 = 0, solve_all = 0;
    Eigen::MatrixXd U;
    std::unique_ptr<fem::ElasticBody> body;
    const double make = seconds([&] {
        body = std::make_unique<fem::ElasticBody>(problem.mesh, problem.material, problem.held,
                                                  fem::ElasticBodyOptions{.threads = settings.threads,
                                                                          .memory = settings.memory,
                                                                          .loads = settings.loads,
                                                                          .solver = settings.solver});
    });
    solve_1 = seconds([&] { body->solve(one); });
    solve_all = seconds([&] { U = body->solve(loads); });
    const fem::ElasticBodyStats& stats = body->stats();
    fmt::print("{:<15} {:>7} {:>8} {:>8.3f} {:>8.3f} {:>8.3f} {:>9} {:>8.3f} {:>8.4f} {:>8.2f} {:>8.2f}\n", bar.name,
               stats.nodes, stats.elements, stats.seconds_assemble, stats.seconds_analyse,
               stats.seconds_factor - stats.seconds_analyse,
               stats.solver != fem::Solver::factor ? fmt::format("CG {}", body->most_iterations())
                                                   : fmt::format("{:.2f} GB", 8e-9 * stats.factor_entries),
               solve_1, solve_all / static_cast<double>(loads.cols()), make + solve_all, peak_gb());
    std::fflush(stdout);
    if (!settings.folder.empty()) {
        bench::write_displacements(std::filesystem::path(settings.folder) / bar.name / "ours.f64", problem, U);
    }
}

}  // namespace

int main(int argc, char** argv) {
    fem::Processes processes;
    if (!processes.lead()) {
        processes.serve();
        return 0;
    }
    CLI::App app{"How long the reference body takes"};
    Settings settings;
    app.add_option("--threads", settings.threads)->check(CLI::PositiveNumber);
    app.add_option("--loads", settings.loads)->check(CLI::PositiveNumber);
    app.add_option("--memory", settings.memory, "that a factor may take [GB]; 0: as the body decides");
    const std::map<std::string, fem::Solver> solvers{{"automatic", fem::Solver::automatic},
                                                     {"factor", fem::Solver::factor},
                                                     {"multigrid", fem::Solver::multigrid},
                                                     {"petsc", fem::Solver::petsc}};
    app.add_option("--solver", settings.solver, "petsc: under mpirun, in as many processes")
        ->transform(CLI::CheckedTransformer(solvers));
    app.add_option("--only", settings.only, "the mesh of this name, as 20k-quadratic; otherwise all up to 100k nodes");
    app.add_option("--folder", settings.folder, "where the meshes and the answers are written for other codes");
    CLI11_PARSE(app, argc, argv);

    fmt::print("threads {}, loads {}\n{:<15} {:>7} {:>8} {:>8} {:>8} {:>8} {:>9} {:>8} {:>8} {:>8} {:>8}\n",
               settings.threads, settings.loads, "mesh", "nodes", "elements", "assemble", "analyse", "factor", "size",
               "1 load", "a load", "all", "peak GB");
    try {
        for (const bench::Bar& bar : bench::bars()) {
            const bool is_huge =
                bar.name.starts_with("300k") || bar.name.starts_with("1000k") || bar.name.starts_with("3000k");
            if (settings.only.empty() ? !is_huge : bar.name == settings.only) measure(bar, settings);
        }
    } catch (const std::runtime_error& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 4;
    }
    return 0;
}
