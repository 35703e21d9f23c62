// The model for other programs: what their files hold is the model.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>

#include "mesh/formats/surface/read_surface.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/command_line/commands.h"
#include "pipeline/exports/four_influences.h"
#include "pipeline/exports/gltf.h"
#include "pipeline/exports/programs.h"
#include "samples/lattice.h"
#include "skeleton/model/io/model_io.h"
#include "skeleton/statics/equilibrium.h"
#include "skeleton/statics/statics.h"
#include "tests/messages.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {
namespace {

skeleton::Model exported_model() { return samples::make_lattice("cube", {3, 3, 2}, 1); }

std::string decoded(const std::string& text) {
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string bytes;
    unsigned bits = 0;
    int count = 0;
    for (const char c : text) {
        const std::size_t digit = digits.find(c);
        if (digit == std::string::npos) break;
        bits = bits << 6 | static_cast<unsigned>(digit);
        count += 6;
        if (count >= 8) bytes += static_cast<char>(bits >> (count -= 8) & 255);
    }
    return bytes;
}

/// A glTF file as a reader takes it.
struct ReadGltf {
    nlohmann::json json;
    std::string buffer;

    explicit ReadGltf(const std::filesystem::path& file) {
        const std::string text = mesh::read_text(file);
        if (file.extension() == ".glb") {
            std::array<std::uint32_t, 5> header{};
            std::memcpy(header.data(), text.data(), sizeof header);
            EXPECT_EQ(text.substr(0, 4), "glTF");
            EXPECT_EQ(header[1], 2U);
            EXPECT_EQ(header[2], text.size());
            json = nlohmann::json::parse(text.substr(20, header[3]));
            buffer = text.substr(20 + header[3] + 8);
        } else {
            json = nlohmann::json::parse(text);
            const std::string uri = json["buffers"][0]["uri"];
            buffer = decoded(uri.substr(uri.find(',') + 1));
        }
        EXPECT_EQ(json["buffers"][0]["byteLength"], buffer.size());
    }

    template <typename Number>
    Eigen::MatrixXd rows(int accessor, int columns) const {
        const auto& a = json["accessors"][accessor];
        const auto& view = json["bufferViews"][a["bufferView"].get<int>()];
        const int count = a["count"];
        EXPECT_EQ(view["byteLength"], count * columns * static_cast<int>(sizeof(Number)));
        Eigen::Matrix<Number, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> values(count, columns);
        std::memcpy(values.data(), buffer.data() + view["byteOffset"].get<std::size_t>(),
                    static_cast<std::size_t>(values.size()) * sizeof(Number));
        return values.template cast<double>();
    }
};

TEST(GltfExport, HoldsSkinJointsAndWeights) {
    const TemporaryFolder scratch;
    const skeleton::Model model = exported_model();
    for (const char* name : {"body.gltf", "body.glb"}) {
        write_gltf(scratch / name, model, {});
        const ReadGltf read(scratch / name);
        EXPECT_EQ(read.json["asset"]["version"], "2.0");
        const auto& primitive = read.json["meshes"][0]["primitives"][0];
        const auto& attributes = primitive["attributes"];
        const Eigen::MatrixXd positions = read.rows<float>(attributes["POSITION"], 3);
        EXPECT_LT((1000 * positions - model.surface.vertices).cwiseAbs().maxCoeff(), 1e-5);  // single precision
        const auto& bounds = read.json["accessors"][attributes["POSITION"].get<int>()];
        EXPECT_EQ(bounds["min"][0].get<double>(), positions.col(0).minCoeff());
        EXPECT_EQ(bounds["max"][2].get<double>(), positions.col(2).maxCoeff());
        const Eigen::MatrixXd corners = read.rows<std::uint32_t>(primitive["indices"], 1);
        EXPECT_EQ(corners.size(), model.surface.triangles.size());
        const Eigen::MatrixXd weights = read.rows<float>(attributes["WEIGHTS_0"], 4);
        EXPECT_GE(weights.minCoeff(), 0);
        EXPECT_LT((weights.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-6);

        // Bound, each joint puts every vertex where it rests: node matrix times inverse bind matrix is the identity.
        const auto& joints = read.json["skins"][0]["joints"];
        ASSERT_EQ(joints.size(), model.spheres.size());
        const Eigen::MatrixXd back = read.rows<float>(read.json["skins"][0]["inverseBindMatrices"], 16);
        for (std::size_t j = 0; j < joints.size(); ++j) {
            const auto& at = read.json["nodes"][joints[j].get<int>()]["translation"];
            for (int c = 0; c < 3; ++c) {
                EXPECT_NEAR(back(static_cast<Eigen::Index>(j), 12 + c), -at[c].get<double>(), 1e-7);
                EXPECT_NEAR(1000 * at[c].get<double>(), model.spheres[j].center[c], 1e-9);
            }
        }
    }
}

TEST(GltfExport, MovesFromRestThroughTheStates) {
    const TemporaryFolder scratch;
    const skeleton::Model model = exported_model();
    skeleton::Load load;
    load.forces.push_back({model.skin.back(), Vec3(0, 1, -4)});
    const skeleton::Equilibrium pressed = skeleton::equilibrium(model, load);
    write_gltf(scratch / "body.glb", model, {pressed.state});
    const ReadGltf read(scratch / "body.glb");
    const auto& animation = read.json["animations"][0];
    ASSERT_EQ(animation["channels"].size(), 2 * model.spheres.size());
    for (const auto& channel : animation["channels"]) {
        const auto sphere = channel["target"]["node"].get<Eigen::Index>() - 2;
        const int output = animation["samplers"][channel["sampler"].get<int>()]["output"];
        if (channel["target"]["path"] == "translation") {
            const Eigen::MatrixXd x = 1000 * read.rows<float>(output, 3);
            EXPECT_LT((x.row(0).transpose() - model.spheres[sphere].center).norm(), 1e-5);
            EXPECT_LT((x.row(1) - pressed.state.x.row(sphere)).norm(), 1e-5);
        } else {
            const Eigen::Vector4d q = read.rows<float>(output, 4).row(1);
            EXPECT_LT((Eigen::Quaterniond(q).toRotationMatrix() - pressed.state.R[sphere]).norm(), 1e-6);
        }
    }
}

TEST(GltfExport, ASkinOfFourSpheresOrFewerLosesNothing) {
    // Each vertex hangs on one sphere or two, to first order as the mean of where these would carry it.
    EXPECT_LT(four_influences(exported_model()).relative_error, 0.01);  // the ridge of the fit
}

TEST(GltfExport, PassesKhronossValidatorWhereThereIsOne) {
    const TemporaryFolder scratch;
    skeleton::Load load;
    const skeleton::Model model = exported_model();
    load.forces.push_back({model.skin.back(), Vec3(0, 1, -4)});
    write_gltf(scratch / "body.glb", model, {skeleton::equilibrium(model, load).state});
    mesh::write_text(
        scratch / "validate.js",
        "let validator;\n"
        "try { validator = require('gltf-validator'); } catch { process.exit(77); }\n"
        "validator.validateBytes(new Uint8Array(require('fs').readFileSync(process.argv[2])))\n"
        "  .then(r => { console.log(JSON.stringify(r.issues)); process.exit(r.issues.numErrors ? 1 : 0); });\n");
    const int status = std::system(
        ("node " + (scratch / "validate.js").string() + " " + (scratch / "body.glb").string() + " 2>/dev/null")
            .c_str());
    const int code = WEXITSTATUS(status);
    if (code == 77 || code == 127) GTEST_SKIP() << "npm's gltf-validator is not installed (NODE_PATH)";
    EXPECT_EQ(code, 0);
}

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

TEST(ExportCommand, WritesTheStateThatIsAskedFor) {
    const TemporaryFolder scratch;
    const skeleton::Model model = exported_model();
    skeleton::write_model(scratch / "model.json", model);
    mesh::write_text(scratch / "probes.csv",
                     "probe,time,x,y,z,fx,fy,fz,radius\n1,0,80,80,40,0,0,-2,0\n1,1,80,80,40,0,0,-4,0\n");
    commands::ExportOptions options{scratch / "model.json", scratch / "pressed.stl", "stl", scratch / "probes.csv", {}};
    commands::Common replacing;
    replacing.force = true;
    const auto lowest = [&] {
        commands::export_model(options, replacing);
        return mesh::read_surface(options.output).vertices.col(2).minCoeff();
    };
    const double last = lowest();
    options.state = 0;
    const double first = lowest();
    EXPECT_LT(last, first);
    options.state = 2;
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { lowest(); }), {"--state is 2", "has states 0 to 1"}));
    options = {scratch / "model.json", scratch / "body.vtp", "vtp", {}, {}};
    commands::export_model(options, {});
    EXPECT_EQ(mesh::read_surface(options.output).vertices.rows(), model.surface.vertices.rows());
}

TEST(ExportMessages, AModelWithoutASkinHasNothingToShow) {
    const TemporaryFolder scratch;
    skeleton::Model model = exported_model();
    model.skin.clear();
    model.surface = {};
    skeleton::write_model(scratch / "model.json", model);
    for (const char* to : {"gltf", "stl", "vtp"}) {
        const commands::ExportOptions options{scratch / "model.json", scratch / "body", to, {}, {}};
        EXPECT_TRUE(says(message_of<InvalidInput>([&] { commands::export_model(options, {}); }), {"no skin"})) << to;
    }
    const commands::SimulateOptions moving{scratch / "model.json", scratch / "p.csv", scratch / "out", 0.01, 0.1};
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { commands::simulate(moving, {}); }), {"has no skin"}));
}

TEST(SimulateMotion, RingsAndComesToRestInTheEquilibrium) {
    const TemporaryFolder scratch;
    skeleton::write_model(scratch / "model.json", exported_model());
    mesh::write_text(scratch / "probes.csv", "probe,time,x,y,z,fx,fy,fz,radius\n1,0,80,80,40,0,0,-2,0\n");
    const commands::SimulateOptions still{scratch / "model.json", scratch / "probes.csv", scratch / "still"};
    const double end = commands::simulate(still, {}).json["states"][0]["max_displacement_mm"];
    for (const bool implicit : {false, true}) {
        commands::SimulateOptions moving{scratch / "model.json", scratch / "probes.csv", scratch / "moving", 0.001,
                                         0.3};
        moving.implicit = implicit;
        moving.damping = 0.2;
        const commands::Outcome outcome = commands::simulate(moving, {});
        const auto& probe = outcome.json["probes"][0];
        EXPECT_EQ(probe["frames"], 301);
        // A weight let go swings beyond where it comes to rest, by exp(-pi zeta / sqrt(1 - zeta^2)) = 0.53 at most.
        EXPECT_GT(probe["max_displacement_mm"], 1.2 * end);
        EXPECT_LT(probe["max_displacement_mm"], 1.6 * end);
        const auto frame = [&](int i) {
            return mesh::read_text(scratch / "moving" / fmt::format("simulation_{:05}.vtp", i));
        };
        EXPECT_NE(frame(10), frame(40));
    }
}

TEST(SimulateMotion, BeginsInTheEquilibriumOfARowOfTimeZero) {
    const TemporaryFolder scratch;
    skeleton::Model model = exported_model();
    model.damping = {.alpha = 0, .beta = 0.01};
    skeleton::write_model(scratch / "model.json", model);
    const std::string pressed = "probe,time,x,y,z,fx,fy,fz,radius\n1,0,80,80,40,0,0,-2,0\n";
    mesh::write_text(scratch / "pressed.csv", pressed);
    mesh::write_text(scratch / "released.csv", pressed + "1,1,0,0,0,0,0,0,0\n");
    const double start = commands::simulate({scratch / "model.json", scratch / "pressed.csv", scratch / "still"}, {})
                             .json["states"][0]["max_displacement_mm"];
    commands::SimulateOptions moving{scratch / "model.json", scratch / "released.csv", scratch / "moved", 0.001, 0.3};
    moving.implicit = true;
    const nlohmann::json told = commands::simulate(moving, {}).json;
    EXPECT_NEAR(told["probes"][0]["max_displacement_mm"].get<double>(), start, 0.01 * start);  // where it was let go
    EXPECT_EQ(told["damping"]["stiffness"], 0.01);
}

TEST(SimulateMotion, CreepsFromLoadToLoadAsStatesDo) {
    const TemporaryFolder scratch;
    skeleton::Model model = exported_model();
    model.damping = {.alpha = 0, .beta = 0.01};
    model.effects.push_back({"viscosity", {{"creep", 0.8, "1"}, {"tau", 0.4, "s"}}});
    skeleton::write_model(scratch / "model.json", model);
    mesh::write_text(scratch / "probes.csv",
                     "probe,time,x,y,z,fx,fy,fz,radius\n1,0.5,80,80,40,0,0,-1,0\n1,1.5,80,80,40,0,0,-2,0\n");
    const commands::SimulateOptions still{scratch / "model.json", scratch / "probes.csv", scratch / "still"};
    const double end = commands::simulate(still, {}).json["states"][1]["max_displacement_mm"];
    commands::SimulateOptions moving{scratch / "model.json", scratch / "probes.csv", scratch / "moved", 0.01, 1.5};
    moving.implicit = true;
    const double reached = commands::simulate(moving, {}).json["probes"][0]["max_displacement_mm"];
    EXPECT_NEAR(reached, end,
                0.01 * end);  // steps are a fortieth of the time of the creep
}

}  // namespace
}  // namespace palpate::pipeline
