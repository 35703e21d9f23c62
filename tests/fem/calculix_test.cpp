// Against CalculiX, another finite element program (GPL, calculix.de): the same mesh, law and loads.

#include <fmt/format.h>

#include <cstdlib>
#include <sstream>

#include "bodies.h"
#include "fem/hyperelastic_body.h"
#include "point_potentials.h"

// After bodies.h, whose message_of lives in another namespace.
#include "tests/temporary_folder.h"

namespace palpate::fem {
namespace {

/// A bar held at x = 0, with an end load and weight along -z.
struct Case {
    mesh::VolumeMesh mesh;
    std::vector<char> held;
    Material material;
    Eigen::VectorXd f;
    double g = 0;  // [mm/s^2]

    Case(const Vec3& size, const Eigen::Vector3i& cells)
        : mesh(mesh::to_quadratic(mesh::make_bar(Vec3::Zero(), size, cells))),
          held(nodes_where(mesh, [](const Vec3& x) { return x.x() < 1e-9; })),
          f(Eigen::VectorXd::Zero(mesh.nodes.size())) {}
};

/// Its input, in CalculiX' words; elements and nodes count from 1, midsides are in the same order.
std::string input(const Case& problem) {
    std::string text = "*NODE, NSET=ALL\n";
    const auto& [nodes, tetrahedra, faces] = problem.mesh;
    for (Eigen::Index i = 0; i < nodes.rows(); ++i) {
        text += fmt::format("{}, {:.15g}, {:.15g}, {:.15g}\n", i + 1, nodes(i, 0), nodes(i, 1), nodes(i, 2));
    }
    text += "*ELEMENT, TYPE=C3D10, ELSET=BODY\n";
    for (Eigen::Index e = 0; e < tetrahedra.rows(); ++e) {
        text += fmt::format("{}", e + 1);
        for (Eigen::Index k = 0; k < 10; ++k) text += fmt::format(", {}", tetrahedra(e, k) + 1);
        text += "\n";
    }
    text += "*BOUNDARY\n";
    for (std::size_t i = 0; i < problem.held.size(); ++i) {
        if (problem.held[i]) text += fmt::format("{}, 1, 3\n", i + 1);
    }
    // W = C10 (J^-2/3 tr F^T F - 3) + (J - 1)^2 / D1
    const Material& material = problem.material;
    const double K = material.young / (3 * (1 - 2 * material.poisson));
    text += fmt::format("*MATERIAL, NAME=SOFT\n*HYPERELASTIC, NEO HOOKE\n{:.15g}, {:.15g}\n*DENSITY\n{:.15g}\n",
                        material.shear_modulus() / 2, 2 / K, material.density);
    text += "*SOLID SECTION, ELSET=BODY, MATERIAL=SOFT\n*STEP, NLGEOM, INC=1000\n*STATIC\n0.1, 1.\n*CLOAD\n";
    for (Eigen::Index k = 0; k < problem.f.size(); ++k) {
        if (problem.f(k) != 0) text += fmt::format("{}, {}, {:.15g}\n", k / 3 + 1, k % 3 + 1, problem.f(k));
    }
    text += fmt::format("*DLOAD\nBODY, GRAV, {:.15g}, 0., 0., -1.\n", problem.g);
    return text + "*NODE PRINT, NSET=ALL, FREQUENCY=1000\nU\n*END STEP\n";
}

/// CalculiX' displacements (3n).
Eigen::VectorXd calculix(const Case& problem) {
    const TemporaryFolder folder;
    folder.write("bar.inp", input(problem));
    const std::string command =
        fmt::format("cd '{}' && OMP_NUM_THREADS=1 ccx -i bar > bar.log 2>&1", folder.path().string());
    EXPECT_EQ(std::system(command.c_str()), 0) << "ccx failed";
    Eigen::VectorXd u = Eigen::VectorXd::Constant(problem.f.size(), NAN);
    std::ifstream file(folder / "bar.dat");
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        Eigen::Index node = 0;
        Vec3 x;
        if (words >> node >> x(0) >> x(1) >> x(2)) u.segment<3>(3 * (node - 1)) = x;
    }
    return u;
}

bool installed() { return std::system("command -v ccx > /dev/null 2>&1") == 0; }

/// CalculiX' standard quadratic tetrahedra take the volume as the displacements have it.
Eigen::VectorXd ours(const Case& problem) {
    const BodySetting setting{Law::neo_hooke, problem.material, {std::make_shared<Weight>(Vec3(0, 0, -problem.g))}};
    return HyperelasticBody(problem.mesh, problem.held, Dilatation::full).equilibrium(setting, problem.f).u;
}

/// Largest displacement along -z.
double sag(const Eigen::VectorXd& u) { return -u.reshaped(3, u.size() / 3).row(2).minCoeff(); }

constexpr const char* missing = "CalculiX is not installed: Debian's package calculix-ccx.";
// CalculiX prints 7 digits and stops at half a per cent of the mean force, after a last correction of a millionth or
// so.
constexpr double tolerance = 1e-4;

TEST(CalculiX, CantileverBendsAlike) {
    if (!installed()) GTEST_SKIP() << missing;
    Case problem({50, 8, 8}, {10, 2, 2});
    problem.material = {.young = 0.2, .poisson = 0.4, .density = 0};
    for (Eigen::Index i = 0; i < problem.mesh.nodes.rows(); ++i) {
        if (problem.mesh.nodes(i, 0) > 50 - 1e-9) problem.f.segment<3>(3 * i) = Vec3(2e-4, 6e-4, -2.2e-3);
    }
    const Eigen::VectorXd theirs = calculix(problem);
    EXPECT_GT(sag(theirs), 0.3 * 50);
    EXPECT_LT((ours(problem) - theirs).norm(), tolerance * theirs.norm());
}

TEST(CalculiX, BarSagsAlikeUnderItsWeight) {
    if (!installed()) GTEST_SKIP() << missing;
    Case problem({40, 10, 10}, {8, 2, 2});
    problem.material = {.young = 0.02, .poisson = 0.45, .density = 1e-9};
    problem.g = 9810;
    const Eigen::VectorXd theirs = calculix(problem);
    EXPECT_GT(sag(theirs), 0.1 * 40);
    EXPECT_LT((ours(problem) - theirs).norm(), tolerance * theirs.norm());
}

}  // namespace
}  // namespace palpate::fem
