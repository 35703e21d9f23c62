#include <cmath>
#include <nlohmann/json.hpp>

#include "mesh/formats/vtk/vtk_files.h"
#include "mesh/text/atomic_file.h"
#include "skeleton/model/io/model_io.h"
#include "skeleton/model/stiffness_order.h"

namespace palpate::skeleton {

namespace {

using Json = nlohmann::ordered_json;

Json list(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

Json to_json(const Sphere& sphere) {
    const Mat3& m = sphere.inertia;
    Json json{{"center", list(sphere.center)},
              {"radius", sphere.radius},
              {"mass", sphere.mass},
              {"inertia", {m(0, 0), m(1, 1), m(2, 2), m(0, 1), m(0, 2), m(1, 2)}},
              {"held", sphere.held}};
    if (sphere.cell > 0) json["cell"] = sphere.cell;
    if (sphere.volume > 0) json["volume"] = sphere.volume;
    return json;
}

Json to_json(const Link& link) {
    Json json{{"a", link.a}, {"b", link.b}, {"length", link.length}};
    for (int s = 0; s < link.stiffness.size(); ++s) json[stiffness_names[s]] = link.stiffness[s];
    if (link.section) {
        json["at"] = list(link.section->at);
        json["across"] = list(link.section->axes.row(1));
        if (link.section->area > 0) json["area"] = link.section->area;
    }
    json["zone"] = link.zone;
    if (link.gyration > 0) json["gyration"] = link.gyration;
    return json;
}

Json to_json(const EffectRecord& effect) {
    Json parameters = Json::object();
    for (const EffectParameter& parameter : effect.parameters) {
        Json& json = parameters[parameter.name];
        json["value"] = parameter.value;
        if (!parameter.unit.empty()) json["unit"] = parameter.unit;
    }
    return {{"name", effect.name}, {"parameters", parameters}};
}

double rounded(double value, int digits) {
    if (value == 0) return 0;
    const double unit = std::pow(10, digits - 1 - std::floor(std::log10(std::abs(value))));
    return std::round(value * unit) / unit;
}

// Each share a list: the sphere, its weight, and `follow` row by row. Rigid motions are followed exactly however these
// are rounded, as long as the weights add up to 1, to which they are scaled when read.
Json to_json(const Attachment& attachment) {
    Json shares = Json::array();
    for (const SphereInfluence& share : attachment.shares) {
        Json list{share.sphere, rounded(share.weight, 8)};
        for (const double number : share.follow.reshaped<Eigen::RowMajor>()) list.push_back(rounded(number, 6));
        shares.push_back(std::move(list));
    }
    return shares;
}

template <typename Rows>
std::vector<Json> rows_of(const Rows& matrix) {
    std::vector<Json> rows;
    for (Eigen::Index i = 0; i < matrix.rows(); ++i) rows.push_back({matrix(i, 0), matrix(i, 1), matrix(i, 2)});
    return rows;
}

struct RegionToJson {
    Json operator()(const mesh::BoxRegion& box) const {
        return {{"box", {{"min", list(box.min)}, {"max", list(box.max)}}}};
    }
    Json operator()(const mesh::SphereRegion& sphere) const {
        return {{"sphere", {{"center", list(sphere.center)}, {"radius", sphere.radius}}}};
    }
    Json operator()(const mesh::PlaneRegion& plane) const {
        return {{"plane", {{"point", list(plane.point)}, {"normal", list(plane.normal)}, {"within", plane.within}}}};
    }
    Json operator()(const mesh::PointsRegion& points) const {
        Json region = {{"at", rows_of(points.points)}, {"within", points.within}};
        if (points.joined >= 0) region["joined"] = points.joined;
        return {{"points", region}};
    }
};

// A list with a line per element, so that a model can be read and edited by hand.
std::string lines(const std::vector<Json>& elements, const std::string& indent = "    ") {
    if (elements.empty()) return "[]";
    std::string text = "[";
    for (size_t i = 0; i < elements.size(); ++i) text += (i > 0 ? ",\n" : "\n") + indent + elements[i].dump();
    return text + "\n" + indent.substr(2) + "]";
}

template <typename Element>
std::vector<Json> all_to_json(const std::vector<Element>& elements) {
    std::vector<Json> all;
    all.reserve(elements.size());
    for (const Element& element : elements) all.push_back(to_json(element));
    return all;
}

std::string to_text(const Model& model) {
    std::vector<Json> supports;
    for (const mesh::Region& region : model.supports) supports.push_back(std::visit(RegionToJson{}, region));

    std::string text = "{\n  \"format\": \"palpate-model/1\",\n";
    if (!model.name.empty()) text += "  \"name\": " + Json(model.name).dump() + ",\n";
    text += "  \"law\": " + Json(law_names[static_cast<size_t>(model.law)]).dump() + ",\n";
    text += "  \"spheres\": " + lines(all_to_json(model.spheres)) + ",\n";
    text += "  \"links\": " + lines(all_to_json(model.links)) + ",\n";
    text += "  \"effects\": " + lines(all_to_json(model.effects)) + ",\n";
    if (model.surface.vertices.rows() > 0) {
        const std::string deep(6, ' ');
        text += "  \"skin\": {\n    \"vertices\": " + lines(rows_of(model.surface.vertices), deep);
        text += ",\n    \"triangles\": " + lines(rows_of(model.surface.triangles), deep);
        if (!model.skin.empty()) text += ",\n    \"attachments\": " + lines(all_to_json(model.skin), deep);
        text += "\n  },\n";
    }
    if (!model.dent.isZero(0))
        text += "  \"dent\": " + Json(std::vector<double>(model.dent.begin(), model.dent.end())).dump() + ",\n";
    if (model.damping)
        text += "  \"damping\": " + Json({{"mass", model.damping->alpha}, {"stiffness", model.damping->beta}}).dump() +
                ",\n";
    text += "  \"supports\": " + lines(supports) + ",\n";
    text += "  \"provenance\": " + Json(model.provenance).dump() + "\n}\n";
    return text;
}

}  // namespace

void write_model(const std::filesystem::path& file, const Model& model) { mesh::write_text(file, to_text(model)); }

void write_model_vtp(const std::filesystem::path& file, const Model& model, const mesh::MeshData& more) {
    const auto n = static_cast<Eigen::Index>(model.spheres.size()), m = static_cast<Eigen::Index>(model.links.size());
    Points centers(n, 3);
    Eigen::VectorXd radius(n), mass(n), held(n), volume(n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const Sphere& sphere = model.spheres[i];
        centers.row(i) = sphere.center.transpose();
        radius[i] = sphere.radius;
        mass[i] = sphere.mass;
        held[i] = sphere.held;
        volume[i] = sphere.volume;
    }
    Eigen::Matrix<int, Eigen::Dynamic, 2> ends(m, 2);
    const StiffnessOrder order(model);
    Eigen::MatrixXd stiffness(m, order.per_link());
    Eigen::VectorXd zone(m);
    for (Eigen::Index l = 0; l < m; ++l) {
        const Link& link = model.links[l];
        ends.row(l) << link.a, link.b;
        stiffness.row(l) = link.stiffness.transpose();
        zone[l] = link.zone;
    }
    mesh::MeshData data;
    data.points = {{"radius [mm]", radius}, {"mass [tonne]", mass}, {"held", held}};
    if (order.full()) data.points.push_back({"volume [MPa]", volume});
    for (int s = 0; s < order.per_link(); ++s)
        data.cells.push_back({std::string(stiffness_names[s]) + " [" + stiffness_units[s] + "]", stiffness.col(s)});
    data.cells.push_back({"zone", zone});
    data.points.insert(data.points.end(), more.points.begin(), more.points.end());
    data.cells.insert(data.cells.end(), more.cells.begin(), more.cells.end());
    mesh::write_vtp_lines(file, centers, ends, data);
}

}  // namespace palpate::skeleton
