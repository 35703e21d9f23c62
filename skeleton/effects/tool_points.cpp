#include "skeleton/effects/tool_points.h"

#include <numbers>

#include "skeleton/model/attachment/attach.h"

namespace palpate::skeleton {

namespace {

/// Points, and where a grip's regions are asked whether they hold them: for those on a sphere, at its centre.
struct Candidates {
    PointSet set;
    Points asked;
};

Candidates gripped(const Model& model) {
    Candidates candidates;
    std::vector<Vec3> asked;
    for (const Attachment& vertex : model.skin) {
        candidates.set.at.push_back(vertex);
        asked.push_back(vertex.rest);
    }
    for (int i = 0; i < static_cast<int>(model.spheres.size()); ++i) {
        const Sphere& sphere = model.spheres[i];
        for (int axis = 0; axis < 3; ++axis) {
            for (const double sign : {1.0, -1.0}) {
                candidates.set.at.push_back(
                    on_sphere(model, i, sphere.center + sign * sphere.radius * Vec3::Unit(axis)));
                asked.push_back(sphere.center);
            }
        }
    }
    candidates.asked.resize(std::ssize(asked), 3);
    for (std::size_t k = 0; k < asked.size(); ++k) candidates.asked.row(static_cast<Eigen::Index>(k)) = asked[k];
    candidates.set.weights = Eigen::VectorXd::Ones(std::ssize(asked));
    return candidates;
}

Candidates on_skin(const Model& model) {
    Candidates candidates{point_set(model, fem::ActsOn::surface), {}};
    candidates.asked.resize(std::ssize(candidates.set.at), 3);
    for (std::size_t k = 0; k < candidates.set.at.size(); ++k)
        candidates.asked.row(static_cast<Eigen::Index>(k)) = candidates.set.at[k].rest;
    return candidates;
}

}  // namespace

double layer_stiffness(const mesh::Tool& tool, double young) {
    constexpr double plane_strain = 4.0 / 3;  // E* / E of what keeps its volume
    constexpr double touched = 1.0 / 3;       // of the radius of a round tool: pressed in by a ninth of it
    double a = 0;
    if (const auto* ball = std::get_if<mesh::SphereShape>(&tool.shape)) a = touched * ball->radius;
    if (const auto* punch = std::get_if<mesh::FlatShape>(&tool.shape)) a = punch->radius;
    if (const auto* solid = std::get_if<mesh::SurfaceShape>(&tool.shape))
        a = touched * mesh::bounding_box(solid->surface.vertices).extent().minCoeff() / 2;
    return 2 * plane_strain * young / (std::numbers::pi * a);
}

fem::PointTerms LayeredTool::terms(const Vec3& X, const Vec3& x) const {
    constexpr double h = 1e-5;  // [mm]: its square is next to nothing on any tool's curvature
    fem::PointTerms own = tool_->terms(X, x);
    if (own.gradient.norm() <= 2 * h) return own;  // not in touch a little farther out
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3 step = h * Vec3::Unit(axis);
        own.hessian.col(axis) = (tool_->terms(X, x + step).gradient - tool_->terms(X, x - step).gradient) / (2 * h);
    }
    own.hessian = (own.hessian + own.hessian.transpose()).eval() / 2;
    return own;
}

PointSet tool_points(const Model& model, const fem::ToolPotential& tool) {
    const Candidates all = tool.is_grip() ? gripped(model) : on_skin(model);
    const Eigen::VectorXd weights = tool.parts()
                                        ? Eigen::VectorXd(layer_stiffness(tool.tool(), tool.young()) * all.set.weights)
                                        : tool.weights(all.asked, all.set.weights);
    PointSet felt;
    std::vector<Eigen::Index> chosen;
    for (Eigen::Index k = 0; k < weights.size(); ++k) {
        if (weights[k] == 0) continue;
        felt.at.push_back(all.set.at[k]);
        chosen.push_back(k);
    }
    felt.weights = weights(chosen);
    return felt;
}

}  // namespace palpate::skeleton
