#include "pipeline/exports/programs.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstdio>

#include "mesh/text/atomic_file.h"
#include "skeleton/statics/statics.h"
#include "tests/pipeline/exports/exported_model.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {
namespace {

// The model for other programs: what their files hold is the model.

TEST(SofaExport, ItsForcesAreTheModels) {
    const TemporaryFolder scratch;
    skeleton::Model model = exported_model();
    for (const bool full : {false, true}) {
        if (full) {
            for (skeleton::Link& link : model.links) {
                const Vec3 along = skeleton::rest_direction(model, link), across = along.unitOrthogonal();
                const Vec3 middle = (model.spheres[link.a].center + model.spheres[link.b].center) / 2;
                skeleton::LinkSection section;
                section.at = middle + Vec3(1, 2, -1);
                section.axes << along.transpose(), across.transpose(), along.cross(across).transpose();
                link.section = section;
                link.stiffness.resize(6);
                link.stiffness << 2, 750, 500, 600, 1, 1.5;
            }
        }
        write_sofa(scratch / "scene.py", model);
        // a state far from rest, and what the scene says of it
        Eigen::VectorXd step(model.dofs());
        for (Eigen::Index i = 0; i < step.size(); ++i)
            step[i] = (i % 6 < 3 ? 5 : 0.4) * std::sin(1.0 + static_cast<double>(i));
        const skeleton::State state = skeleton::advance(skeleton::rest_state(model), step);
        std::string poses = "import sys, numpy as np\nsys.path.insert(0, r'" + scratch.path().string() +
                            "')\nfrom scene import forces\nstate = np.array([";
        for (Eigen::Index i = 0; i < state.x.rows(); ++i) {
            const Eigen::Quaterniond q(state.R[i]);
            poses += fmt::format("[{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g}],", state.x(i, 0),
                                 state.x(i, 1), state.x(i, 2), q.x(), q.y(), q.z(), q.w());
        }
        poses += "])\nfor row in forces(state[:, :3], state[:, 3:]): print(*('%.17g' % f for f in row))\n";
        mesh::write_text(scratch / "ask.py", poses);
        FILE* pipe = popen(("for p in python3 /usr/bin/python3; do $p -B " + (scratch / "ask.py").string() +
                            " 2>/dev/null && break; done")
                               .c_str(),
                           "r");
        Eigen::VectorXd forces(model.dofs());
        int read = 0;
        while (read < forces.size() && std::fscanf(pipe, "%lf", &forces[read]) == 1) ++read;
        pclose(pipe);
        if (read == 0) GTEST_SKIP() << "python3 has no numpy";
        ASSERT_EQ(read, forces.size());
        const Eigen::VectorXd expected = skeleton::residual(model, state, {});
        // the scene tells numbers to ten digits
        EXPECT_LT((forces - expected).cwiseAbs().maxCoeff(), 1e-8 * expected.cwiseAbs().maxCoeff());
    }
}

TEST(SofaExport, SaysWhatTheSceneLeavesOut) {
    const TemporaryFolder scratch;
    skeleton::Model model = exported_model();
    model.effects = {{"gravity", {{"gx", 0, ""}, {"gy", 0, ""}, {"gz", -9810, ""}}},
                     {"stiffening", {{"c2", 3, ""}, {"c3", 20, ""}}}};
    EXPECT_EQ(write_sofa(scratch / "scene.py", model),
              (std::vector<std::string>{"effect 'stiffening' is left out",
                                        "the scene spreads the mass evenly over the spheres"}));
    EXPECT_NE(mesh::read_text(scratch / "scene.py").find("GRAVITY = [0, 0, -9810]"), std::string::npos);
}

TEST(Chai3dExport, IsInMetresAndKilograms) {
    const TemporaryFolder scratch;
    const skeleton::Model model = exported_model();
    const std::vector<std::string> left_out = write_chai3d(scratch / "body.h", model);
    EXPECT_EQ(left_out, std::vector<std::string>{"GEL binds each vertex of the skin to one node or link"});
    const std::string text = mesh::read_text(scratch / "body.h");
    // spheres of 10 mm and a gram, 40 mm apart; links of 2 N/mm, 750 and 500 N mm/rad
    EXPECT_NE(text.find("{0, 0, 0.04, 0.01, 0.001, true},"), std::string::npos);
    EXPECT_NE(text.find("{0, 6, 0.04, 2000, 0.75, 0.5},"), std::string::npos);
}

}  // namespace
}  // namespace palpate::pipeline
