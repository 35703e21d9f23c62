#include <fmt/format.h>
#include <fmt/ranges.h>

#include <iterator>
#include <optional>
#include <utility>

#include "fem/effects/point/gravity.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/exports/four_influences.h"
#include "pipeline/exports/programs.h"
#include "pipeline/exports/sofa_law.h"
#include "pipeline/exports/what_is_left_out.h"
#include "pipeline/version.h"
#include "skeleton/statics/statics.h"

namespace palpate::pipeline {
namespace {

// NAME = np.array([...]) with a row a line; `number`: how each is written.
template <typename Rows>
std::string numpy_array(const char* name, const Rows& rows, const char* number = "{:.10g}") {
    std::string text = fmt::format("{} = np.array([\n", name);
    for (Eigen::Index i = 0; i < rows.rows(); ++i) {
        text += "    [";
        for (Eigen::Index c = 0; c < rows.cols(); ++c) {
            text += fmt::format(fmt::runtime(number), rows(i, c)) + (c + 1 < rows.cols() ? ", " : "],\n");
        }
    }
    return text + fmt::format("]).reshape(-1, {})\n", rows.cols());
}

/// The weight that an effect of a body is [mm/s^2]; none: it is something else, which a scene does not hold.
std::optional<Vec3> weight_of(const skeleton::EffectRecord& effect) {
    fem::Effects physics = skeleton::make_physics(effect);
    const auto points = std::exchange(physics.points, {});
    const auto* weight = points.size() == 1 ? dynamic_cast<const fem::Gravity*>(points.front().get()) : nullptr;
    if (!weight || !physics.empty()) return std::nullopt;
    return weight->g();
}

Vec3 sofa_gravity(const skeleton::Model& model) {
    Vec3 g = Vec3::Zero();
    for (const skeleton::EffectRecord& effect : model.effects) {
        if (skeleton::is_body_effect(effect.name)) g += weight_of(effect).value_or(Vec3::Zero());
    }
    return g;
}

}  // namespace

std::vector<std::string> write_sofa(const std::filesystem::path& file, const skeleton::Model& model) {
    const auto n = std::ssize(model.spheres), m = std::ssize(model.links);
    const bool full = m > 0 && model.links.front().section.has_value();
    Points X(n, 3), D0(m, 3), at(m, 3);
    Eigen::VectorXd mass(n), length(m);
    Eigen::VectorXi a(m), b(m);
    Eigen::MatrixXd K(m, full ? 6 : 3), axes(m, 9);
    std::vector<int> held;
    for (Eigen::Index i = 0; i < n; ++i) {
        X.row(i) = model.spheres[i].center.transpose();
        mass[i] = model.spheres[i].mass;
        if (model.spheres[i].held) held.push_back(static_cast<int>(i));
    }
    for (Eigen::Index l = 0; l < m; ++l) {
        const skeleton::Link& link = model.links[l];
        a[l] = link.a;
        b[l] = link.b;
        length[l] = link.length;
        K.row(l) = link.stiffness.transpose();
        D0.row(l) = skeleton::rest_direction(model, link).transpose();
        if (!full) continue;
        at.row(l) = link.section->at.transpose();
        axes.row(l) = link.section->axes.reshaped<Eigen::RowMajor>().transpose();
    }
    const Vec3 g = sofa_gravity(model);
    std::string text = fmt::format(
        "# A body of palpate {} as a scene for SOFA with SofaPython3: runSofa -l SofaPython3 {}\n"
        "# Units: mm, N, tonne, s. The law of the links, forces(x, q), is the model's own and needs numpy alone.\n"
        "import numpy as np\n\nGRAVITY = [{:.10g}, {:.10g}, {:.10g}]\nHELD = [{}]\n",
        version, file.filename().string(), g.x(), g.y(), g.z(), fmt::join(held, ", "));
    text += "# spheres: centres at rest, masses\n" + numpy_array("X", X) + numpy_array("MASS", mass);
    text += "# links: ends, length at rest, stiffnesses " +
            std::string(full ? "(elongation, flexion, torsion, flexion_2, shear, shear_2)"
                             : "(elongation, flexion, torsion)") +
            "\n" + numpy_array("A", a, "{}") + "A = A[:, 0]\n" + numpy_array("B", b, "{}") + "B = B[:, 0]\n" +
            numpy_array("L", length) + numpy_array("K", K);
    text += full ? numpy_array("AT", at) + numpy_array("AXES", axes) + "AXES = AXES.reshape(-1, 3, 3)\n"
                 : numpy_array("D0", D0);
    text += "# skin, and the four spheres that carry each vertex\n";
    if (model.skin.empty()) {
        text += "VERTICES, TRIANGLES, INFLUENCES, WEIGHTS = [], [], [], []\n";
    } else {
        const FourInfluences influences = four_influences(model);
        text +=
            numpy_array("VERTICES", model.surface.vertices) + numpy_array("TRIANGLES", model.surface.triangles, "{}") +
            numpy_array("INFLUENCES", influences.spheres, "{}") + numpy_array("WEIGHTS", influences.weights, "{:.6g}");
    }
    mesh::write_text(file, text + sofa_law);

    std::vector<std::string> left_out =
        omitted_effects(model, [](const auto& effect) { return weight_of(effect).has_value(); });
    if (full) left_out.emplace_back("the scene keeps no volumes");
    left_out.emplace_back("the scene spreads the mass evenly over the spheres");
    return left_out;
}

}  // namespace palpate::pipeline
