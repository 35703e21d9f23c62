// How long equilibria in large deformation take: bars of quadratic tetrahedra, clamped at one end, sagging under their
// weight, untouched and pressed at 12 places. One thread. "cold" starts at rest; "warm" at the answer for a Young's
// modulus 5 % off, as a fit does; "guided" there, with the tangent that the fit's slopes left. "plain" is Newton's
// method from there with a factor a step. "off by": from plain's answers, as a share of the largest displacement.
// "force us" and "tangent us" are for one element, with its part in the assembly.

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <chrono>

#include "fem/elements/patch_load.h"
#include "fem/hyperelastic_body.h"
#include "fem/large_deformation/body/loaded_body.h"

using namespace palpate;

namespace {

template <class Work>
double seconds(Work&& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

struct Weight final : fem::PointPotential {
    fem::ActsOn acts_on() const override { return fem::ActsOn::material; }
    fem::PointTerms terms(const Vec3&, const Vec3& x) const override {
        const Vec3 g(0, 0, -9810);  // [mm/s^2]
        return {-g.dot(x), -g, Mat3::Zero()};
    }
};

Eigen::SparseMatrix<double> contacts(const mesh::VolumeMesh& mesh, int count) {
    std::vector<mesh::Contact> result;
    for (int k = 0; k < count; ++k) {
        const double x = 30 + 65.0 * (k + 0.5) / count;
        result.push_back({Vec3(x, 15 + 10 * std::sin(k), 30), Vec3(0.3 * std::cos(k), 0.3 * std::sin(k), -1), 6.0});
    }
    return fem::patch_loads(mesh, result, 1e-6);
}

/// Loads that move some node by `share` of the bar's length.
Eigen::MatrixXd scaled_loads(const fem::HyperelasticBody& body, const fem::BodySetting& setting, double share) {
    const Eigen::VectorXd rest = Eigen::VectorXd::Zero(body.mesh().nodes.size());
    Eigen::MatrixXd loads = contacts(body.mesh(), 12);
    const Eigen::MatrixXd u = body.factor(rest, {setting.law, setting.material, {}})->solve(loads);
    for (Eigen::Index j = 0; j < loads.cols(); ++j) {
        loads.col(j) *= share * 100 / u.col(j).reshaped(3, u.rows() / 3).colwise().norm().maxCoeff();
    }
    loads.conservativeResize(Eigen::NoChange, loads.cols() + 1);
    loads.rightCols<1>().setZero();
    return loads;
}

using Fields = std::vector<Eigen::VectorXd>;
using Guides = std::vector<std::shared_ptr<const fem::BodyTangent>>;

/// Newton's method as it is in textbooks, to what `equilibrium` comes to; its steps.
int newton(const fem::HyperelasticBody& body, const fem::BodySetting& setting, const Eigen::VectorXd& load,
           Eigen::VectorXd& u) {
    const auto unbalanced = [&](const Eigen::VectorXd& net) {
        double sum = 0;
        for (std::size_t i = 0; i < body.held().size(); ++i) {
            if (!body.held()[i]) sum += net.segment<3>(static_cast<Eigen::Index>(3 * i)).squaredNorm();
        }
        return std::sqrt(sum);
    };
    const Eigen::VectorXd rest = Eigen::VectorXd::Zero(u.size());
    const double tolerance = fem::NewtonOptions{}.tolerance * unbalanced(body.residual(rest, setting, load));
    for (int steps = 0;; ++steps) {
        const Eigen::VectorXd net = body.residual(u, setting, load);
        if (unbalanced(net) <= tolerance) return steps;
        u += body.factor(u, setting)->solve(net);
    }
}

void measure(const Eigen::Vector3i& cells, double share, const fem::BodySetting& setting) {
    const auto mesh = mesh::to_quadratic(mesh::make_bar(Vec3::Zero(), Vec3(100, 30, 30), cells));
    std::vector<char> held(mesh.nodes.rows());
    for (Eigen::Index i = 0; i < mesh.nodes.rows(); ++i) held[i] = mesh.nodes(i, 0) < 1e-9;
    std::unique_ptr<fem::HyperelasticBody> body;
    const double make = seconds([&] { body = std::make_unique<fem::HyperelasticBody>(mesh, held); });
    const Eigen::MatrixXd loads = scaled_loads(*body, setting, share);

    // A set of equilibria each from its own start.
    const auto row = [&](const char* name, double all, int steps, int factorisations) {
        fmt::print("{:>6} {:>7} {:>6} {:>7.2f} {:>6} {:>7}", mesh.nodes.rows(), mesh.tetrahedra.rows(), name, all,
                   steps, factorisations);
    };
    const auto solve = [&](const char* name, const fem::BodySetting& with, const Fields& start, const Guides& guides) {
        int steps = 0, factorisations = 0;
        Fields u(loads.cols());
        const double all = seconds([&] {
            for (Eigen::Index j = 0; j < loads.cols(); ++j) {
                const auto found = body->equilibrium(with, loads.col(j), {}, start.empty() ? nullptr : &start[j],
                                                     nullptr, guides.empty() ? nullptr : guides[j].get());
                steps += found.iterations;
                factorisations += found.factorisations;
                u[j] = found.u;
            }
        });
        row(name, all, steps, factorisations);
        return u;
    };
    const Fields u = solve("cold", setting, {}, {});
    double size = 0;
    for (const auto& field : u) size = std::max(size, field.reshaped(3, field.size() / 3).colwise().norm().maxCoeff());

    // One of each, in the bent state.
    constexpr int repeats = 20;
    const Eigen::VectorXd load = loads.col(0);
    const double elements = repeats * 1e-6 * static_cast<double>(mesh.tetrahedra.rows());
    const double force = seconds([&] {
        for (int k = 0; k < repeats; ++k) body->residual(u[0], setting, load);
    });
    const fem::BodyShape shape{mesh, held, fem::Dilatation::mean, fem::element_shapes(mesh),
                               fem::node_integrals(mesh, held)};
    const fem::LoadedBody loaded(shape, setting, load);
    const fem::EliminationOrder order = fem::elimination_order(mesh, held);
    fem::LowerMatrix K = order.unknowns.zero();
    const double tangents = seconds([&] {
        for (int k = 0; k < repeats; ++k) loaded.add_tangent(u[0], order.unknowns, K);
    });
    const double factor = seconds([&] {
        for (int k = 0; k < repeats; ++k) body->factor(u[0], setting);
    });
    const auto tangent = body->factor(u[0], setting);
    const double solution = seconds([&] {
        for (int k = 0; k < repeats; ++k) tangent->solve(load);
    });
    fmt::print(" {:>8.2f} {:>10.2f} {:>9.1f} {:>9.1f} {:>7.1f} {:>7.3f}\n", force / elements, tangents / elements,
               factor / repeats * 1e3, solution / repeats * 1e3, size, make);

    fem::BodySetting other = setting;
    other.material.young *= 1.05;
    Fields plain = u;
    int steps = 0;
    const double all = seconds([&] {
        for (Eigen::Index j = 0; j < loads.cols(); ++j) steps += newton(*body, other, loads.col(j), plain[j]);
    });
    row("plain", all, steps, steps);
    fmt::print("\n");
    const auto compare = [&](const Fields& found) {
        double off = 0;
        for (std::size_t j = 0; j < found.size(); ++j)
            off = std::max(off, (found[j] - plain[j]).lpNorm<Eigen::Infinity>() / size);
        fmt::print(" off by {:.1e}\n", off);
        std::fflush(stdout);
    };
    compare(solve("warm", other, u, {}));
    Guides guides;
    for (const Eigen::VectorXd& field : u) guides.push_back(body->factor(field, setting));
    compare(solve("guided", other, u, guides));
}

}  // namespace

int main() {
    const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
    fmt::print("{:>6} {:>7} {:>6} {:>7} {:>6} {:>7} {:>8} {:>10} {:>9} {:>9} {:>7} {:>7}\n", "nodes", "elem.", "start",
               "s, all", "steps", "factors", "force us", "tangent us", "factor ms", "solve ms", "max mm", "make s");
    for (const auto law : {fem::MaterialLaw::neo_hookean, fem::MaterialLaw::svk, fem::MaterialLaw::linear}) {
        const fem::BodySetting setting{law, {.young = 0.5, .poisson = 0.45}, {.points = {std::make_shared<Weight>()}}};
        fmt::print("{}\n", law == fem::MaterialLaw::neo_hookean ? "neo-Hooke"
                           : law == fem::MaterialLaw::svk       ? "svk"
                                                                : "linear");
        measure({12, 4, 4}, 0.05, setting);
        measure({17, 6, 5}, 0.10, setting);
    }
}
