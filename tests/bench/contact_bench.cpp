// How many factors an equilibrium under a rigid tool takes: a slab of quadratic tetrahedra on a rigid base, pressed by
// a sphere and by a flat punch. One thread. "cold" starts at rest; "other ratio" at the answer for a Poisson's ratio of
// 0.45 instead of 0.43, as a fit does; "deeper" at that for half the depth.

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <chrono>

#include "fem/hyperelastic_body.h"

using namespace palpate;

namespace {

constexpr double young = 0.02, radius = 6, thickness = 20;

struct Press {
    mesh::Tool tool;
    double depth;
};

class Slab {
public:
    explicit Slab(const Press& press)
        : tool_(std::make_shared<fem::RigidTool>(press.tool)), body_(mesh(), held()), depth_(press.depth) {}

    void write_rows() const {
        const Eigen::VectorXd half = row("cold, half depth", 0.5, 0.45, nullptr);
        row("other ratio, half depth", 0.5, 0.43, &half);
        const Eigen::VectorXd whole = row("deeper", 1, 0.45, &half);
        row("other ratio", 1, 0.43, &whole);
        row("cold", 1, 0.45, nullptr);
    }

private:
    static mesh::VolumeMesh mesh() {
        return mesh::to_quadratic(mesh::make_bar(Vec3(-20, -20, 0), Vec3(40, 40, thickness), {11, 11, 5}));
    }
    static std::vector<char> held() {
        const mesh::VolumeMesh of = mesh();
        std::vector<char> result(of.nodes.rows());
        for (Eigen::Index i = 0; i < of.nodes.rows(); ++i) result[i] = of.nodes(i, 2) < 1e-6;
        return result;
    }

    Eigen::VectorXd row(const char* what, double share, double poisson, const Eigen::VectorXd* start) const {
        // Turned a little: what touches first is not where it presses most.
        const mesh::ToolMotion motion{0, Vec3(0.7, 0.3, -share * depth_), Vec3(0.03, 0.05, 0)};
        fem::BodySetting setting{fem::MaterialLaw::neo_hookean, {.young = young, .poisson = poisson}, {}};
        setting.effects.tools = {std::make_shared<fem::ToolPotential>(tool_, motion, young)};
        const auto begin = std::chrono::steady_clock::now();
        const fem::BodyEquilibrium found =
            body_.equilibrium(setting, Eigen::VectorXd::Zero(body_.mesh().nodes.size()), {}, start);
        const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
        fmt::print("| {} | {} | {} | {} | {:.5f} | {:.2f} |\n", tool_->tool.name, what, found.iterations,
                   found.factorisations, body_.wrench(found.u, setting.effects.tools[0]).head<3>().norm(),
                   taken.count());
        return found.u;
    }

    std::shared_ptr<const fem::RigidTool> tool_;
    fem::HyperelasticBody body_;
    double depth_;
};

}  // namespace

int main() {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    fmt::print("| tool | start | iterations | factors | force [N] | s |\n|---|---|--:|--:|--:|--:|\n");
    const Vec3 above(0, 0, thickness);
    Slab({{.name = "sphere", .shape = mesh::SphereShape{radius}, .origin = above + radius * Vec3::UnitZ()}, 3})
        .write_rows();
    Slab({{.name = "flat punch", .shape = mesh::FlatShape{radius, -Vec3::UnitZ()}, .origin = above}, 1.5}).write_rows();
}
