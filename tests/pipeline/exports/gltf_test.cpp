#include "pipeline/exports/gltf.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>

#include "mesh/text/atomic_file.h"
#include "pipeline/exports/four_influences.h"
#include "skeleton/statics/equilibrium.h"
#include "tests/pipeline/exports/exported_model.h"
#include "tests/temporary_folder.h"

namespace palpate::pipeline {
namespace {

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

}  // namespace
}  // namespace palpate::pipeline
