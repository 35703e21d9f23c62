#include <fmt/format.h>

#include <Eigen/Geometry>
#include <map>
#include <nlohmann/json.hpp>

#include "mesh/errors.h"
#include "mesh/text/atomic_file.h"
#include "skeleton/model/attachment/attach.h"
#include "skeleton/model/io/json_fields.h"
#include "skeleton/model/io/model_io.h"

namespace palpate::skeleton {

namespace {

nlohmann::ordered_json parse(const std::filesystem::path& file) {
    const std::string text = mesh::read_text(file);
    try {
        return nlohmann::ordered_json::parse(text);  // ordered: an effect keeps its parameters' order
    } catch (const nlohmann::json::exception& error) {
        // "[json.exception.parse_error.101] parse error at line 3, column 5: ...": ours begins after the bracket.
        const std::string what = error.what();
        const size_t bracket = what.find("] ");
        throw InvalidInput(fmt::format("{}: is not valid JSON: {}", file.string(),
                                       bracket == std::string::npos ? what : what.substr(bracket + 2)));
    }
}

Mat3 solid_sphere_inertia(double mass, double radius) { return 0.4 * mass * radius * radius * Mat3::Identity(); }

Mat3 read_inertia(const JsonField& field) {
    const std::vector<JsonField> m = field.list(6);
    const double xy = m[3].number(), xz = m[4].number(), yz = m[5].number();
    Mat3 inertia;
    inertia << m[0].number_at_least(0), xy, xz,  //
        xy, m[1].number_at_least(0), yz,         //
        xz, yz, m[2].number_at_least(0);
    return inertia;
}

Sphere read_sphere(const JsonField& field, const std::vector<mesh::Region>& supports) {
    field.allow_only({"center", "radius", "mass", "inertia", "held", "cell", "volume"});
    Sphere sphere;
    sphere.center = field["center"].vector();
    sphere.radius = field["radius"].positive_number();
    sphere.mass = field["mass"].number_at_least(0);
    sphere.inertia =
        field.has("inertia") ? read_inertia(field["inertia"]) : solid_sphere_inertia(sphere.mass, sphere.radius);
    sphere.held = field.has("held") ? field["held"].boolean() : mesh::contains(supports, sphere.center);
    if (field.has("cell")) sphere.cell = field["cell"].positive_number();
    if (field.has("volume")) sphere.volume = field["volume"].number_at_least(0);
    if (sphere.volume > 0 && !(sphere.cell > 0))
        field["volume"].complain(
            "is a stiffness against changes of the cell's volume: give the field 'cell' too [mm^3]");
    return sphere;
}

// The section of a full link: square, in the link's middle, unless told.
LinkSection read_section(const JsonField& field, const Link& link, const std::vector<Sphere>& spheres) {
    const Vec3 &a = spheres[link.a].center, &b = spheres[link.b].center;
    LinkSection section;
    section.at = field.has("at") ? field["at"].vector() : Vec3((a + b) / 2);
    if (field.has("area")) section.area = field["area"].positive_number();
    const Vec3 along = (b - a).normalized();
    Vec3 across = along.unitOrthogonal();
    if (field.has("across")) {
        across = field["across"].vector();
        across -= across.dot(along) * along;
        if (!(across.norm() > 1e-6)) field["across"].fail("a direction across the link");
        across.normalize();
    }
    section.axes << along.transpose(), across.transpose(), along.cross(across).transpose();
    return section;
}

Link read_link(const JsonField& field, const std::vector<Sphere>& spheres) {
    field.allow_only({"a", "b", "length", "elongation", "flexion", "torsion", "flexion_2", "shear", "shear_2", "at",
                      "across", "area", "zone", "gyration"});
    Link link;
    link.a = field["a"].index(spheres.size());
    link.b = field["b"].index(spheres.size());
    if (link.a == link.b) field.complain(fmt::format("a and b are both {}; a link joins two spheres", link.a));
    if (link.a > link.b) std::swap(link.a, link.b);
    const double distance = (spheres[link.b].center - spheres[link.a].center).norm();
    if (!(distance > 0))
        field.complain(fmt::format("spheres {} and {} have the same centre; move one of them", link.a, link.b));
    link.length = field.has("length") ? field["length"].positive_number() : distance;
    const bool full = field.has("shear") || field.has("shear_2") || field.has("flexion_2");
    link.stiffness.resize(full ? 6 : 3);
    for (int s = 0; s < link.stiffness.size(); ++s) link.stiffness[s] = field[stiffness_names[s]].number_at_least(0);
    if (full) link.section = read_section(field, link, spheres);
    for (const char* of_section : {"at", "across", "area"}) {
        if (full || !field.has(of_section)) continue;
        field[of_section].complain(
            "is of a full link's section, but the link is the paper's: give it flexion_2, shear and shear_2, or take "
            "this away");
    }
    if (field.has("zone")) link.zone = field["zone"].index(1'000'000);
    if (field.has("gyration")) link.gyration = field["gyration"].positive_number();
    return link;
}

std::vector<Link> read_links(const JsonField& field, const std::vector<Sphere>& spheres) {
    std::vector<Link> links;
    std::map<std::pair<int, int>, size_t> seen;
    for (const JsonField& element : field.list()) {
        const Link link = read_link(element, spheres);
        const auto [first, fresh] = seen.try_emplace({link.a, link.b}, links.size());
        if (!fresh)
            element.complain(fmt::format("joins spheres {} and {}, as links[{}] does already; keep one of them", link.a,
                                         link.b, first->second));
        if (!links.empty() && link.section.has_value() != links.front().section.has_value())
            element.complain(
                "and links[0] are of two kinds: either all links have flexion_2, shear and shear_2, or none has");
        links.push_back(link);
    }
    return links;
}

mesh::Region read_region(const JsonField& field) {
    const std::vector<std::string> kinds{"box", "sphere", "plane", "points"};
    field.allow_only(kinds);
    if (field.keys().size() != 1) field.complain("must have one field, one of 'box', 'sphere', 'plane', 'points'");
    const JsonField region = field[field.keys().front()];
    if (field.has("box")) {
        region.allow_only({"min", "max"});
        const mesh::BoxRegion box{region["min"].vector(), region["max"].vector()};
        if ((box.min.array() > box.max.array()).any()) region.complain("max must not lie below min");
        return box;
    }
    if (field.has("sphere")) {
        region.allow_only({"center", "radius"});
        return mesh::SphereRegion{region["center"].vector(), region["radius"].number_at_least(0)};
    }
    if (field.has("plane")) {
        region.allow_only({"point", "normal", "within"});
        const Vec3 normal = region["normal"].vector();
        if (normal.norm() == 0) region["normal"].fail("longer than 0");
        return mesh::PlaneRegion{region["point"].vector(), normal, region["within"].number_at_least(0)};
    }
    region.allow_only({"at", "within", "joined"});
    const std::vector<JsonField> at = region["at"].list();
    mesh::PointsRegion points{Points(static_cast<Eigen::Index>(at.size()), 3), region["within"].number_at_least(0),
                              region.has("joined") ? region["joined"].number_at_least(0) : -1.0};
    for (size_t i = 0; i < at.size(); ++i) points.points.row(i) = at[i].vector().transpose();
    return points;
}

EffectRecord read_effect(const JsonField& field) {
    field.allow_only({"name", "parameters"});
    EffectRecord effect{field["name"].text(), {}};
    const JsonField parameters = field["parameters"];
    for (const std::string& name : parameters.keys()) {
        const JsonField parameter = parameters[name];
        parameter.allow_only({"value", "unit"});
        effect.parameters.push_back(
            {name, parameter["value"].number(), parameter.has("unit") ? parameter["unit"].text() : std::string()});
    }
    try {
        if (is_body_effect(effect.name)) make_physics(effect);
    } catch (const InvalidInput& error) {
        field.complain(error.what());
    }
    return effect;
}

void read_skin(const JsonField& field, Model& model) {
    field.allow_only({"vertices", "triangles", "attachments"});
    const std::vector<JsonField> vertices = field["vertices"].list();
    model.surface.vertices.resize(static_cast<Eigen::Index>(vertices.size()), 3);
    for (size_t i = 0; i < vertices.size(); ++i) model.surface.vertices.row(i) = vertices[i].vector().transpose();

    const std::vector<JsonField> triangles = field["triangles"].list();
    model.surface.triangles.resize(static_cast<Eigen::Index>(triangles.size()), 3);
    for (size_t i = 0; i < triangles.size(); ++i) {
        const std::vector<JsonField> corners = triangles[i].list(3);
        for (int c = 0; c < 3; ++c) model.surface.triangles(i, c) = corners[c].index(vertices.size());
    }

    if (!field.has("attachments")) {
        for (size_t i = 0; i < vertices.size(); ++i)
            model.skin.push_back(attach_to_links(model, model.surface.vertices.row(i).transpose()));
        return;
    }
    const std::vector<JsonField> attachments = field["attachments"].list(vertices.size());
    for (size_t i = 0; i < attachments.size(); ++i) {
        const std::vector<JsonField> parts = attachments[i].list();
        if (parts.empty()) attachments[i].fail("a list of at least one share");
        const Vec3 at = model.surface.vertices.row(static_cast<Eigen::Index>(i)).transpose();
        if (!parts.front().is_list()) {  // two spheres, and how far the vertex is from the first to the second
            attachments[i].list(3);
            model.skin.push_back(between(model, parts[0].index(model.spheres.size()),
                                         parts[1].index(model.spheres.size()), parts[2].number_between(0, 1), at));
            continue;
        }
        Attachment attachment{{}, at};
        double sum = 0;
        for (const JsonField& part : parts) {
            const std::vector<JsonField> numbers = part.list(20);
            SphereInfluence share{.sphere = numbers[0].index(model.spheres.size()), .weight = numbers[1].number()};
            for (int j = 0; j < 18; ++j) share.follow(j / 6, j % 6) = numbers[2 + j].number();
            sum += share.weight;
            attachment.shares.push_back(share);
        }
        if (std::abs(sum - 1) > 1e-6) attachments[i].complain(fmt::format("weights add up to {}, not to 1", sum));
        for (SphereInfluence& share : attachment.shares) share.weight /= sum;
        model.skin.push_back(std::move(attachment));
    }
}

}  // namespace

Model read_model(const std::filesystem::path& file) {
    const nlohmann::ordered_json json = parse(file);
    const JsonField root(json, file.string());
    root.allow_only(
        {"format", "name", "law", "spheres", "links", "effects", "skin", "dent", "damping", "supports", "provenance"});
    root["format"].choice({"palpate-model/1"});

    Model model;
    if (root.has("name")) model.name = root["name"].text();
    if (root.has("law"))
        model.law = static_cast<EquilibriumLaw>(root["law"].choice({law_names.begin(), law_names.end()}));
    if (root.has("supports"))
        for (const JsonField& region : root["supports"].list()) model.supports.push_back(read_region(region));
    for (const JsonField& sphere : root["spheres"].list()) model.spheres.push_back(read_sphere(sphere, model.supports));
    if (model.spheres.empty()) root["spheres"].fail("a list of at least one sphere");
    model.links = read_links(root["links"], model.spheres);
    if (root.has("effects"))
        for (const JsonField& effect : root["effects"].list()) model.effects.push_back(read_effect(effect));
    if (root.has("skin")) read_skin(root["skin"], model);
    if (root.has("dent")) {
        const std::vector<JsonField> amplitudes = root["dent"].list(6);
        for (int i = 0; i < 6; ++i) model.dent[i] = amplitudes[i].number();
    }
    if (root.has("damping")) {
        root["damping"].allow_only({"mass", "stiffness"});
        model.damping = {.alpha = root["damping"]["mass"].number_at_least(0),
                         .beta = root["damping"]["stiffness"].number_at_least(0)};
    }
    if (root.has("provenance"))
        for (const std::string& key : root["provenance"].keys()) model.provenance[key] = root["provenance"][key].text();
    return model;
}

}  // namespace palpate::skeleton
