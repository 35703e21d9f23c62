#include <fmt/format.h>

#include <iterator>

#include "mesh/text/atomic_file.h"
#include "pipeline/exports/programs.h"
#include "pipeline/exports/what_is_left_out.h"
#include "pipeline/version.h"

namespace palpate::pipeline {
namespace {

constexpr double gel_metres = 1e-3, gel_kilograms = 1e3;             // a millimetre, a tonne
constexpr double gel_stiffness = 1e3, gel_turning_stiffness = 1e-3;  // N/mm in N/m, N mm in N m

constexpr const char* gel_builder = R"cpp(
    /// Makes the body in a GEL world: m, N, kg, s. Its links remember the poses of their nodes as at rest, so make it
    /// before you move it.
    inline cGELMesh* make_palpate_body(cGELWorld* world) {
        cGELMesh* body = new cGELMesh();
        world->m_gelMeshes.push_front(body);
        chai3d::cMesh* skin = body->newMesh();
        for (const auto& x : palpate_body::vertices) skin->newVertex(x[0], x[1], x[2]);
        for (const auto& t : palpate_body::triangles) skin->newTriangle(t[0], t[1], t[2]);
        skin->computeAllNormals();
        body->buildVertices();
        std::vector<cGELSkeletonNode*> nodes;
        for (const auto& s : palpate_body::spheres) {
            cGELSkeletonNode* node = new cGELSkeletonNode();
            node->m_pos.set(s.x, s.y, s.z);
            node->m_rot.identity();
            node->m_radius = s.radius;
            node->setMass(s.mass);
            node->m_fixed = s.held;
            body->m_nodes.push_back(node);
            nodes.push_back(node);
        }
        for (const auto& l : palpate_body::links) {
            cGELSkeletonLink* link = new cGELSkeletonLink(nodes[l.a], nodes[l.b]);
            link->m_length0 = l.length;
            link->m_kSpringElongation = l.elongation;
            link->m_kSpringFlexion = l.flexion;
            link->m_kSpringTorsion = l.torsion;
            body->m_links.push_back(link);
        }
        body->m_useSkeletonModel = true;
        body->connectVerticesToSkeleton(false);
        return body;
    }
)cpp";

}  // namespace

std::vector<std::string> write_chai3d(const std::filesystem::path& file, const skeleton::Model& model) {
    std::string text;
    const auto out = std::back_inserter(text);
    fmt::format_to(out,
                   "// A body of palpate {} for CHAI3D's GEL module: include it after \"chai3d.h\" and \"GEL3D.h\".\n"
                   "#pragma once\n\n#include <vector>\n\nnamespace palpate_body {{\n\n"
                   "struct Sphere {{\n    double x, y, z, radius, mass;  // [m], [kg]\n    bool held;\n}};\n"
                   "struct Link {{\n    int a, b;\n    double length, elongation, flexion, torsion;  // [m], [N/m], "
                   "[N m/rad]\n}};\n\nconst std::vector<Sphere> spheres = {{\n",
                   version);
    for (const skeleton::Sphere& sphere : model.spheres) {
        const Vec3 x = gel_metres * sphere.center;
        fmt::format_to(out, "    {{{:.9g}, {:.9g}, {:.9g}, {:.9g}, {:.9g}, {}}},\n", x.x(), x.y(), x.z(),
                       gel_metres * sphere.radius, gel_kilograms * sphere.mass, sphere.held);
    }
    fmt::format_to(out, "}};\n\nconst std::vector<Link> links = {{\n");
    for (const skeleton::Link& link : model.links) {
        // Bent by phi each end of GEL's link turns by phi / 2, so 2 kF (phi / 2)^2 / 2 is to be kF phi^2 / 2.
        const double flexion = link.section ? link.stiffness[1] + link.stiffness[3] : link.stiffness[1];
        fmt::format_to(out, "    {{{}, {}, {:.9g}, {:.9g}, {:.9g}, {:.9g}}},\n", link.a, link.b,
                       gel_metres * link.length, gel_stiffness * link.stiffness[0], gel_turning_stiffness * flexion,
                       gel_turning_stiffness * link.stiffness[2]);
    }
    fmt::format_to(out, "}};\n\nconst std::vector<std::vector<double>> vertices = {{\n");
    for (const auto& x : model.surface.vertices.rowwise()) {
        fmt::format_to(out, "    {{{:.9g}, {:.9g}, {:.9g}}},\n", gel_metres * x[0], gel_metres * x[1],
                       gel_metres * x[2]);
    }
    fmt::format_to(out, "}};\n\nconst std::vector<std::vector<unsigned>> triangles = {{\n");
    for (const auto& t : model.surface.triangles.rowwise()) {
        fmt::format_to(out, "    {{{}, {}, {}}},\n", t[0], t[1], t[2]);
    }
    text += "};\n\n}  // namespace palpate_body\n";
    text += gel_builder;
    mesh::write_text(file, text);

    std::vector<std::string> left_out = omitted_effects(model, [](const skeleton::EffectRecord&) { return false; });
    if (!model.links.empty() && model.links.front().section) {
        left_out.emplace_back("GEL's links have one flexion, no shear and no axes: flexion is the mean of both planes");
        left_out.emplace_back("GEL keeps no volumes");
    }
    left_out.emplace_back("GEL binds each vertex of the skin to one node or link");
    return left_out;
}

}  // namespace palpate::pipeline
