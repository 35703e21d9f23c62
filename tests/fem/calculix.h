#pragma once

#include <fmt/format.h>

#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "bodies.h"
#include "fem/material.h"
#include "tests/temporary_folder.h"

namespace palpate::fem {

/// CalculiX, another finite element program (GPL, calculix.de): input in its words, and what it makes of it.
namespace calculix {

constexpr const char* missing = "CalculiX is not installed: Debian's package calculix-ccx.";
inline bool installed() { return std::system("command -v ccx > /dev/null 2>&1") == 0; }

/// Nodes, elements BODY and held nodes; they count from 1, midsides are in the same order. Numbers are cut after 20
/// characters: 12 digits and an exponent fit.
inline std::string mesh_of(const mesh::VolumeMesh& mesh, const std::vector<char>& held) {
    std::string text = "*NODE, NSET=ALL\n";
    const auto& [nodes, tetrahedra, faces] = mesh;
    for (Eigen::Index i = 0; i < nodes.rows(); ++i) {
        text += fmt::format("{}, {:.12g}, {:.12g}, {:.12g}\n", i + 1, nodes(i, 0), nodes(i, 1), nodes(i, 2));
    }
    text += "*ELEMENT, TYPE=C3D10, ELSET=BODY\n";
    for (Eigen::Index e = 0; e < tetrahedra.rows(); ++e) {
        text += fmt::format("{}", e + 1);
        for (Eigen::Index k = 0; k < 10; ++k) text += fmt::format(", {}", tetrahedra(e, k) + 1);
        text += "\n";
    }
    text += "*BOUNDARY\n";
    for (std::size_t i = 0; i < held.size(); ++i) {
        if (held[i]) text += fmt::format("{}, 1, 3\n", i + 1);
    }
    return text;
}

/// W = C10 (J^-2/3 tr F^T F - 3) + (J - 1)^2 / D1
inline std::string neo_hookean(const std::string& name, const Material& material) {
    const double K = material.young / (3 * (1 - 2 * material.poisson));
    return fmt::format("*MATERIAL, NAME={}\n*HYPERELASTIC, NEO HOOKE\n{:.12g}, {:.12g}\n*DENSITY\n{:.12g}\n", name,
                       material.shear_modulus() / 2, 2 / K, material.density);
}

inline std::string section(const std::string& elements, const std::string& material) {
    return fmt::format("*SOLID SECTION, ELSET={}, MATERIAL={}\n", elements, material);
}

/// Nodal forces, which take the place of those of the step before.
inline std::string forces(const Eigen::VectorXd& f) {
    std::string text = "*CLOAD, OP=NEW\n";
    for (Eigen::Index k = 0; k < f.size(); ++k) {
        if (f(k) != 0) text += fmt::format("{}, {}, {:.12g}\n", k / 3 + 1, k % 3 + 1, f(k));
    }
    return text;
}

/// A step of large deformation with these loads; displacements are printed at its end.
inline std::string step(const std::string& loads, double increment = 0.1) {
    return fmt::format(
        "*STEP, NLGEOM, INC=1000\n*STATIC\n{}, 1.\n{}*NODE PRINT, NSET=ALL, FREQUENCY=1000\nU\n*END STEP\n", increment,
        loads);
}

/// Displacements of `nodes` nodes at the end of each step (3n).
inline std::vector<Eigen::VectorXd> run(const std::string& input, Eigen::Index nodes) {
    const TemporaryFolder folder;
    folder.write("body.inp", input);
    const std::string command =
        fmt::format("cd '{}' && OMP_NUM_THREADS=1 ccx -i body > body.log 2>&1", folder.path().string());
    EXPECT_EQ(std::system(command.c_str()), 0) << "ccx failed";
    std::vector<Eigen::VectorXd> steps;
    std::ifstream file(folder / "body.dat");
    for (std::string line; std::getline(file, line);) {
        if (line.find("displacements") != std::string::npos) steps.emplace_back(Eigen::VectorXd::Zero(3 * nodes));
        std::istringstream words(line);
        Eigen::Index node = 0;
        Vec3 x;
        if (!steps.empty() && words >> node >> x(0) >> x(1) >> x(2) && node <= nodes) {
            steps.back().segment<3>(3 * (node - 1)) = x;
        }
    }
    EXPECT_FALSE(steps.empty()) << "ccx printed no displacements";
    if (steps.empty()) steps.emplace_back(Eigen::VectorXd::Constant(3 * nodes, NAN));
    return steps;
}

}  // namespace calculix
}  // namespace palpate::fem
