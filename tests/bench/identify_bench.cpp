// How well and how fast stiffness is identified: the paper's experiments by several methods, intervals, particles a
// second, and thousands of links from what moves on the surface.
//
//   identify_bench experiments      the paper's two, at 0 to 5 % noise, beside least squares and global search
//   identify_bench coverage         how often 95 % intervals hold the truth
//   identify_bench particles        a second, next to a loop and to a matrix product
//   identify_bench scaling          10^2 to 10^4 links
//
// Each prints a table in Markdown.

#include <cblas.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "identify/identify.h"
#include "identify/inference/domains/force/force_domain.h"
#include "identify/inference/domains/force/node_configuration.h"
#include "identify/loading/twin.h"
#include "identify/numerics/random.h"
#include "pipeline/run/folder/peak_memory.h"
#include "samples/lattice.h"
#include "tests/bench/identify/block.h"
#include "tests/bench/identify/optimisers.h"
#include "tests/bench/identify/trial.h"

namespace {

using namespace palpate;
using namespace palpate::identify;
using namespace palpate::bench;

/// What a method found, and what it takes to be left open.
struct Found {
    Eigen::VectorXd stiffness;
    double sd = std::numeric_limits<double>::quiet_NaN();  // rms of sd over stiffness, as told
    double seconds = 0;
};

Found by_identify(const Trial& trial, Method method, Domain domain, std::uint64_t seed) {
    const Watch watch;
    const IdentifyResult result =
        identify::identify(trial.experiment.start, trial.set, trial.options(method, domain, seed));
    Found found{Eigen::VectorXd(static_cast<Eigen::Index>(trial.truth.size())), 0, watch.seconds()};
    for (std::size_t p = 0; p < trial.truth.size(); ++p) {
        const PosteriorRow& row = result.posterior[p];
        found.stiffness[static_cast<Eigen::Index>(p)] = method == Method::burion2008 ? row.mean : row.q50;
        found.sd += std::pow(row.sd / row.mean, 2) / static_cast<double>(trial.truth.size());
    }
    found.sd = std::sqrt(found.sd);
    return found;
}

template <typename Optimiser>
Found by_optimiser(const Trial& trial, Optimiser optimise) {
    const PositionDomain domain = trial.domain();
    const Watch watch;
    const Eigen::VectorXd theta = optimise(domain);
    const double seconds = watch.seconds();
    return {domain.parameters().units().array() * theta.array().exp(), std::numeric_limits<double>::quiet_NaN(),
            seconds};
}

void experiments(int repeats) {
    using Run = std::function<Found(const Trial&, std::uint64_t)>;
    const std::vector<std::pair<const char*, Run>> methods{
        {"tempered, positions (default)",
         [](const Trial& t, auto seed) { return by_identify(t, Method::tempered, Domain::position, seed); }},
        {"tempered, forces",
         [](const Trial& t, auto seed) { return by_identify(t, Method::tempered, Domain::force, seed); }},
        {"Algorithm 1 as printed, forces",
         [](const Trial& t, auto seed) { return by_identify(t, Method::burion2008, Domain::force, seed); }},
        {"Levenberg-Marquardt (Eigen, finite differences), positions",
         [](const Trial& t, auto) { return by_optimiser(t, levenberg_marquardt); }},
#ifdef PALPATE_WITH_NLOPT
        {"CRS2 (NLopt), positions, one set",
         [](const Trial& t, auto) { return by_optimiser(t, controlled_random_search); }},
#endif
    };
    fmt::print(
        "| experiment | noise, % of spacing | method | error %, rms | told sd % | seconds, median "
        "|\n|---|---|---|---|---|---|\n");
    for (const auto& made : {samples::make_cube_experiment(), samples::make_sheet_experiment()}) {
        for (const double noise : {0.0, 0.0005, 0.005, 0.01, 0.05}) {
            for (const auto& [name, run] : methods) {
                double errors = 0, sds = 0;
                std::vector<double> seconds;
                int failed = 0;
                const int sets = std::string(name).ends_with("one set") ? 1 : repeats;  // it takes minutes
                for (int i = 0; i < sets; ++i) {
                    const Trial trial(made, noise, 100 + i);
                    try {
                        const Found found = run(trial, 1 + i);
                        errors += std::pow(trial.error_of(found.stiffness), 2);
                        sds += found.sd;
                        seconds.push_back(found.seconds);
                    } catch (const SolverFailure&) {
                        ++failed;
                    }
                }
                const double n = sets - failed;
                std::ranges::sort(seconds);
                fmt::print("| {} | {:g} | {}{} | {:.3g} | {:.3g} | {:.3g} |\n", made.elongation.size() > 1 ? "II" : "I",
                           100 * noise, name, failed > 0 ? fmt::format(" ({} failed)", failed) : "",
                           n > 0 ? 100 * std::sqrt(errors / n) : 0, n > 0 ? 100 * sds / n : 0,
                           seconds.empty() ? 0 : seconds[seconds.size() / 2]);
                std::fflush(stdout);
            }
        }
    }
}

void coverage(int repeats) {
    fmt::print(
        "| experiment | noise, % of spacing | repeats | numbers in their 95 % intervals, % | sd of that | error %, rms "
        "|\n|---|---|---|---|---|---|\n");
    for (const auto& made : {samples::make_cube_experiment(), samples::make_sheet_experiment()}) {
        for (const double noise : {0.0005, 0.005, 0.01, 0.05}) {
            int inside = 0, all = 0;
            double errors = 0;
            for (int i = 0; i < repeats; ++i) {
                const Trial trial(made, noise, 5000 + i);
                const IdentifyResult result =
                    identify::identify(made.start, trial.set, trial.options(Method::tempered, Domain::position, 1 + i));
                for (std::size_t p = 0; p < trial.truth.size(); ++p) {
                    const PosteriorRow& row = result.posterior[p];
                    inside += row.q025 <= trial.truth[p] && trial.truth[p] <= row.q975 ? 1 : 0;
                    errors += std::pow(row.q50 / trial.truth[p] - 1, 2);
                    ++all;
                }
            }
            const double share = static_cast<double>(inside) / all;
            fmt::print("| {} | {:g} | {} | {:.1f} | {:.1f} | {:.3g} |\n", made.elongation.size() > 1 ? "II" : "I",
                       100 * noise, repeats, 100 * share, 100 * std::sqrt(share * (1 - share) / repeats),
                       100 * std::sqrt(errors / all));
            std::fflush(stdout);
        }
    }
}

void particles() {
    fmt::print(
        "| parameters P | H | particles at once | particles/s | particles/s, a loop | of the machine's matrix product, "
        "% "
        "|\n|---|---|---|---|---|---|\n");
    const auto line = [](const ForceStatistics& s, const char* kind) {
        const auto P = static_cast<int>(s.g.size());
        const int N = P <= 100 ? 4096 : 20'000'000 / P;  // few, so that they stay in the cache
        Eigen::MatrixXd X(N, P);
        for (int p = 0; p < P; ++p) X.col(p) = RandomStream(1, 0, p).normals(N);
        double check = 0;
        const auto rate = [&](auto work, int count) {
            const Watch watch;
            int times = 0;
            do {
                check += work();
                ++times;
            } while (watch.seconds() < 1);
            return count * times / watch.seconds();
        };
        const double batch = rate([&] { return squared_errors(s, X).sum(); }, N);
        const int few = std::max(1, std::min(N, 100'000 / P));
        const Eigen::MatrixXd H = s.H;
        const double loop = rate(
            [&] {
                double sum = 0;
                for (int i = 0; i < few; ++i) {
                    for (int a = 0; a < P; ++a) {
                        double row = 2 * s.g[a];
                        for (int b = 0; b < P; ++b) row += H(a, b) * X(i, b);
                        sum += row * X(i, a);
                    }
                }
                return sum;
            },
            few);
        Eigen::MatrixXd A = Eigen::MatrixXd::Random(1024, 1024), B = A, C = A;
        const double peak = 2.0 * std::pow(1024, 3) *
                            rate(
                                [&] {
                                    cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, 1024, 1024, 1024, 1,
                                                A.data(), 1024, B.data(), 1024, 0, C.data(), 1024);
                                    return C(0, 0);
                                },
                                1);
        fmt::print("| {} | {} | {} | {:.3g} | {:.3g} | {:.0f} |{}\n", P, kind, N, batch, loop,
                   100 * batch * 2.0 * P * P / peak, std::isfinite(check) ? "" : " ");
        std::fflush(stdout);
    };
    for (const int P : {6, 100, 1000}) {
        Eigen::MatrixXd R(P, P);
        for (int p = 0; p < P; ++p) R.col(p) = RandomStream(2, 0, p).normals(P);
        line({(R.transpose() * R).sparseView(), R.col(0), 1, P}, "dense");
    }
    for (const int side : {6, 7}) {
        const Block block(side, skeleton::EquilibriumLaw::large_rotation);
        const Parameters parameters = group_stiffness(block.start, Scope::links, {skeleton::Stiffness::torsion});
        const MeasurementSet whole =
            simulate_measurements(block.truth, block.set.states, markers_on_spheres(block.start));
        const ForceDomain domain = force_domain(block.start, parameters, measured_configurations(block.start, whole));
        line(domain.forces, "of a lattice");
    }
}

void scaling(const std::vector<int>& sides, const std::vector<std::string>& laws, int threads) {
    fmt::print(
        "| law | links | numbers | markers | seconds | peak memory, GB | median error of ln k: informed % | and prior "
        "% | informed, % | in their 95 % intervals, % |\n|---|---|---|---|---|---|---|---|---|---|\n");
    for (const skeleton::EquilibriumLaw law :
         {skeleton::EquilibriumLaw::linear, skeleton::EquilibriumLaw::large_rotation}) {
        if (std::ranges::find(laws, skeleton::law_names[static_cast<std::size_t>(law)]) == laws.end()) continue;
        for (const int n : sides) {
            const Block block(n, law);
            IdentifyOptions how;
            how.law = law == skeleton::EquilibriumLaw::linear ? LawChoice::linear : LawChoice::large_rotation;
            how.fixed = {skeleton::Stiffness::torsion};
            how.threads = threads;
            const Watch watch;
            const IdentifyResult result = identify::identify(block.start, block.set, how);
            const double seconds = watch.seconds();
            std::vector<double> errors, all;
            int inside = 0;
            for (const PosteriorRow& row : result.posterior) {
                const int kind = row.parameter.starts_with("elongation") ? 0 : 1;
                const double truth = block.truth.links[row.link].stiffness[kind];
                const double error = std::abs(std::log(row.q50 / truth));
                if (row.informed) errors.push_back(error);
                inside += row.q025 <= truth && truth <= row.q975 ? 1 : 0;
                all.push_back(std::abs(std::log(block.start.links[row.link].stiffness[kind] / truth)));
            }
            const auto median = [](std::vector<double> v) {
                if (v.empty()) return 0.0;
                std::ranges::nth_element(v, v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2));
                return v[v.size() / 2];
            };
            fmt::print("| {} | {} | {} | {} | {:.1f} | {:.2g} | {:.2g} | {:.2g} | {:.0f} | {:.0f} |\n",
                       skeleton::law_names[static_cast<std::size_t>(law)], block.start.links.size(),
                       result.posterior.size(), block.set.markers.size(), seconds, pipeline::peak_memory_mb() / 1e3,
                       100 * median(errors), 100 * median(all),
                       100.0 * static_cast<double>(errors.size()) / static_cast<double>(result.posterior.size()),
                       100.0 * inside / static_cast<double>(result.posterior.size()));
            for (const std::string& note : result.notes) fmt::print(stderr, "  {}\n", note);
            std::fflush(stdout);
        }
    }
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"How well and how fast stiffness is identified"};
    int repeats = 20, threads = 2;
    std::vector<int> sides{4, 8, 15};
    std::vector<std::string> laws(skeleton::law_names.begin(), skeleton::law_names.end());
    app.require_subcommand(1);
    auto* e = app.add_subcommand("experiments", "The paper's two, beside other methods");
    e->add_option("--repeats", repeats, "Sets a row");
    e->callback([&] { experiments(repeats); });
    auto* c = app.add_subcommand("coverage", "How often 95 % intervals hold the truth");
    c->add_option("--repeats", repeats, "Sets a row");
    c->callback([&] { coverage(repeats); });
    app.add_subcommand("particles", "A second")->callback([] { particles(); });
    auto* s = app.add_subcommand("scaling", "Up to 10^4 links");
    s->add_option("--sides", sides, "Spheres along a side of each block");
    s->add_option("--laws", laws, "Each with every block");
    s->add_option("--threads", threads, "");
    s->callback([&] { scaling(sides, laws, threads); });
    CLI11_PARSE(app, argc, argv);
}
