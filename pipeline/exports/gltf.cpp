#include "pipeline/exports/gltf.h"

#include <Eigen/Geometry>
#include <bit>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/exports/four_influences.h"
#include "pipeline/output/base64.h"
#include "pipeline/version.h"

namespace palpate::pipeline {
namespace {

using GltfJson = nlohmann::ordered_json;
static_assert(std::endian::native == std::endian::little, "glTF is written in the machine's byte order");

constexpr double gltf_metres = 1e-3;  // a millimetre in glTF's unit

// glTF's numbers for component types and targets.
constexpr int unsigned_short = 5123, unsigned_int = 5125, single_precision = 5126;
constexpr int vertex_data = 34962, index_data = 34963;

/// A glTF file as it grows: JSON, and the buffer that it speaks of.
class GltfFile {
public:
    GltfFile() {
        json["asset"] = {{"version", "2.0"}, {"generator", std::string("palpate ") + version}};
        for (const char* list : {"bufferViews", "accessors"}) json[list] = GltfJson::array();
    }

    /// Adds an array of rows; the accessor's number. `target`: 0 for none.
    template <typename Number, int columns>
    int add(
        const Eigen::Matrix<Number, Eigen::Dynamic, columns, columns == 1 ? Eigen::ColMajor : Eigen::RowMajor>& rows,
        const char* type, int component, int target, bool with_bounds = false) {
        const std::size_t bytes = static_cast<std::size_t>(rows.size()) * sizeof(Number);
        GltfJson view{{"buffer", 0}, {"byteOffset", buffer_.size()}, {"byteLength", bytes}};
        if (target != 0) view["target"] = target;
        json["bufferViews"].push_back(view);
        buffer_.append(reinterpret_cast<const char*>(rows.data()), bytes);
        buffer_.append((4 - buffer_.size() % 4) % 4, '\0');
        GltfJson accessor{{"bufferView", json["bufferViews"].size() - 1},
                          {"componentType", component},
                          {"count", rows.rows()},
                          {"type", type}};
        if (with_bounds) {
            for (Eigen::Index c = 0; c < rows.cols(); ++c) {
                accessor["min"].push_back(rows.col(c).minCoeff());
                accessor["max"].push_back(rows.col(c).maxCoeff());
            }
        }
        json["accessors"].push_back(accessor);
        return static_cast<int>(json["accessors"].size()) - 1;
    }

    std::string as_json();
    std::string as_binary();

    GltfJson json;

private:
    std::string buffer_;
};

std::string GltfFile::as_json() {
    json["buffers"] = {
        {{"byteLength", buffer_.size()}, {"uri", "data:application/octet-stream;base64," + base64(buffer_)}}};
    return json.dump() + "\n";
}

std::string gltf_word(std::size_t number) {
    const auto value = static_cast<std::uint32_t>(number);
    return {reinterpret_cast<const char*>(&value), sizeof value};
}

std::string GltfFile::as_binary() {
    json["buffers"] = {{{"byteLength", buffer_.size()}}};
    std::string text = json.dump();
    text.append((4 - text.size() % 4) % 4, ' ');
    return "glTF" + gltf_word(2) + gltf_word(12 + 8 + text.size() + 8 + buffer_.size()) + gltf_word(text.size()) +
           "JSON" + text + gltf_word(buffer_.size()) + std::string("BIN\0", 4) + buffer_;
}

using Rows3 = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;
using Rows4 = Eigen::Matrix<float, Eigen::Dynamic, 4, Eigen::RowMajor>;

int add_skinned_mesh(GltfFile& gltf, const skeleton::Model& model, const FourInfluences& influences) {
    using Numbers = Eigen::Matrix<std::uint32_t, Eigen::Dynamic, 1>;
    using Joints = Eigen::Matrix<std::uint16_t, Eigen::Dynamic, 4, Eigen::RowMajor>;
    const Points normals = mesh::vertex_normals(model.surface);
    Rows4 weights = influences.weights.cast<float>();
    for (Eigen::Index v = 0; v < weights.rows(); ++v) weights.row(v) /= weights.row(v).sum();
    const Numbers corners = model.surface.triangles.reshaped<Eigen::RowMajor>().cast<std::uint32_t>();
    GltfJson attributes;
    attributes["POSITION"] = gltf.add<float, 3>((gltf_metres * model.surface.vertices).cast<float>(), "VEC3",
                                                single_precision, vertex_data, true);
    attributes["NORMAL"] = gltf.add<float, 3>(normals.cast<float>(), "VEC3", single_precision, vertex_data);
    attributes["JOINTS_0"] = gltf.add<std::uint16_t, 4>(Joints(influences.spheres.cast<std::uint16_t>()), "VEC4",
                                                        unsigned_short, vertex_data);
    attributes["WEIGHTS_0"] = gltf.add<float, 4>(weights, "VEC4", single_precision, vertex_data);
    const int indices = gltf.add<std::uint32_t, 1>(corners, "SCALAR", unsigned_int, index_data);
    gltf.json["materials"] = {
        {{"name", "body"},
         {"pbrMetallicRoughness",
          {{"baseColorFactor", {0.80, 0.42, 0.38, 1.0}}, {"metallicFactor", 0.0}, {"roughnessFactor", 0.55}}}}};
    gltf.json["meshes"] = {
        {{"name", "skin"}, {"primitives", {{{"attributes", attributes}, {"indices", indices}, {"material", 0}}}}}};
    return 0;
}

/// Nodes: the skin, the skeleton's root, then a joint a sphere.
void add_nodes(GltfFile& gltf, const skeleton::Model& model) {
    const auto n = static_cast<Eigen::Index>(model.spheres.size());
    GltfJson nodes = GltfJson::array(), children = GltfJson::array();
    Eigen::Matrix<float, Eigen::Dynamic, 16, Eigen::RowMajor> inverse_bind(n, 16);
    for (Eigen::Index i = 0; i < n; ++i) {
        const skeleton::Sphere& sphere = model.spheres[i];
        const Vec3 at = gltf_metres * sphere.center;
        Eigen::Matrix4f back = Eigen::Matrix4f::Identity();
        back.topRightCorner<3, 1>() = -at.cast<float>();
        inverse_bind.row(i) = back.reshaped().transpose();  // column after column, as glTF has it
        children.push_back(i + 2);
    }
    nodes.push_back({{"name", model.name.empty() ? "body" : model.name}, {"mesh", 0}, {"skin", 0}});
    nodes.push_back({{"name", "skeleton"}, {"children", children}});
    for (Eigen::Index i = 0; i < n; ++i) {
        const skeleton::Sphere& sphere = model.spheres[i];
        const Vec3 at = gltf_metres * sphere.center;
        nodes.push_back({{"name", "sphere " + std::to_string(i)},
                         {"translation", {at.x(), at.y(), at.z()}},
                         {"extras", {{"radius_mm", sphere.radius}, {"held", sphere.held}}}});
        gltf.json["skins"][0]["joints"].push_back(i + 2);
    }
    gltf.json["nodes"] = nodes;
    gltf.json["skins"][0]["skeleton"] = 1;
    gltf.json["skins"][0]["inverseBindMatrices"] = gltf.add<float, 16>(inverse_bind, "MAT4", single_precision, 0);
    gltf.json["scenes"] = {{{"nodes", {0, 1}}}};
    gltf.json["scene"] = 0;
}

/// From rest through the states, a second each.
void add_animation(GltfFile& gltf, const skeleton::Model& model, const std::vector<skeleton::State>& states) {
    const auto frames = static_cast<Eigen::Index>(states.size()) + 1;
    const skeleton::State rest = skeleton::rest_state(model);
    Eigen::Matrix<float, Eigen::Dynamic, 1> times(frames);
    for (Eigen::Index f = 0; f < frames; ++f) times[f] = static_cast<float>(f);
    const int input = gltf.add<float, 1>(times, "SCALAR", single_precision, 0, true);
    GltfJson samplers = GltfJson::array(), channels = GltfJson::array();
    const auto follow = [&](std::size_t sphere, const char* path, int output) {
        channels.push_back({{"sampler", samplers.size()}, {"target", {{"node", sphere + 2}, {"path", path}}}});
        samplers.push_back({{"input", input}, {"interpolation", "LINEAR"}, {"output", output}});
    };
    for (std::size_t i = 0; i < model.spheres.size(); ++i) {
        Rows3 places(frames, 3);
        Rows4 turns(frames, 4);
        for (Eigen::Index f = 0; f < frames; ++f) {
            const skeleton::State& state = f == 0 ? rest : states[f - 1];
            places.row(f) = (gltf_metres * state.x.row(static_cast<Eigen::Index>(i))).cast<float>();
            turns.row(f) = Eigen::Quaterniond(state.R[i]).coeffs().transpose().cast<float>();
        }
        follow(i, "translation", gltf.add<float, 3>(places, "VEC3", single_precision, 0));
        follow(i, "rotation", gltf.add<float, 4>(turns, "VEC4", single_precision, 0));
    }
    gltf.json["animations"] = {{{"name", "states"}, {"channels", channels}, {"samplers", samplers}}};
}

}  // namespace

GltfReport write_gltf(const std::filesystem::path& file, const skeleton::Model& model,
                      const std::vector<skeleton::State>& states) {
    if (model.skin.empty() || model.surface.triangles.rows() == 0)
        throw InvalidInput("the model has no skin, which is what glTF shows: give it one");
    if (model.spheres.size() > 65535)
        throw InvalidInput("the model has more than 65535 spheres, and glTF numbers joints by 16 bits");
    const FourInfluences influences = four_influences(model);
    GltfFile gltf;
    add_skinned_mesh(gltf, model, influences);
    add_nodes(gltf, model);
    if (!states.empty()) add_animation(gltf, model, states);
    mesh::write_text(file, file.extension() == ".glb" ? gltf.as_binary() : gltf.as_json());
    return {influences.relative_error};
}

}  // namespace palpate::pipeline
