#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "mesh/formats/surface/read_surface.h"
#include "mesh/formats/vtk/vtk_files.h"
#include "mesh/supports/held_parts.h"
#include "mesh/supports/region_yaml.h"
#include "pipeline/body/region_field.h"
#include "pipeline/case/settings/settings.h"
#include "pipeline/case/subject/subject_body.h"
#include "pipeline/command_line/terminal/console.h"
#include "pipeline/run/folder/report_stage.h"
#include "pipeline/run/stages/stages.h"
#include "skeleton/construction/build.h"
#include "skeleton/model/io/model_io.h"

// The stages of a run that make the body: its mesh and its skeleton.

namespace palpate::pipeline::commands {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// What each support holds of the mesh, and whether that is enough.
void report_supports(Job& job) {
    json words = json::array();
    const std::vector<mesh::HeldPart> parts = mesh::held_parts(job.subject.supports, job.body);
    for (std::size_t i = 0; i < parts.size(); ++i) {
        words.push_back(mesh::describe_held_part(job.subject.supports, parts, i, "nodes of the mesh"));
        Console::notice("held         " + words.back().get<std::string>());
    }
    for (const std::string& warning : mesh::too_little_held(job.subject.supports, job.body)) {
        words.push_back(warning);
        Console::warning(warning);
    }
    job.folder.note("supports", words);
}

void take_model(Job& job, const fs::path& given) {
    job.folder.stage({"skeleton", {}, {given}, {}, {"skeleton/model.json", "skeleton/skeleton.vtp"}}, [&] {
        const skeleton::Model model = skeleton::read_model(given);
        skeleton::write_model(job.folder.path() / "skeleton/model.json", model);
        skeleton::write_model_vtp(job.folder.path() / "skeleton/skeleton.vtp", model);
        return json{{"spheres", model.spheres.size()}, {"links", model.links.size()}};
    });
    job.model = skeleton::read_model(job.folder.path() / "skeleton/model.json");
    Console::notice(
        fmt::format("skeleton     {} spheres, {} links, as given", job.model.spheres.size(), job.model.links.size()));
}

}  // namespace

json moduli_of(const std::vector<mesh::MaterialRegion>& regions) {
    json all = json::array();
    for (const mesh::MaterialRegion& region : regions)
        all.push_back({region.name, region.label.value_or(0), region.young.value_or(0), region.poisson.value_or(0),
                       region.density.value_or(0)});
    return all;
}

void mesh_stage(Job& job) {
    const Case& c = job.subject.settings;
    if (c.model) {  // there is a skeleton already: the surface is for pictures
        mesh::write_vtp(job.folder.path() / "mesh/surface.vtp", job.subject.surface);
        return;
    }
    json key = settings_of_stage(c, "mesh");
    key["supports"] = mesh::regions_to_yaml(job.subject.supports);  // elements end at their borders
    if (!job.subject.regions.empty()) key["regions"] = moduli_of(job.subject.regions);
    const bool ran = job.folder.stage({"mesh", key, job.subject.files, {}, {"mesh/body.vtu", "mesh/surface.vtp"}}, [&] {
        const MeshedBody body = make_body(job.subject, {c.edge_length, c.linear_elements}, Console::progress());
        for (const std::string& note : body.notes) Console::notice("Repair: " + note);
        mesh::write_vtu(job.folder.path() / "mesh/body.vtu", body.volume,
                        regions_shown(element_regions(job.subject, body)));
        mesh::write_vtp(job.folder.path() / "mesh/surface.vtp", body.surface);
        return json{{"nodes", body.volume.nodes.rows()},
                    {"tetrahedra", body.volume.tetrahedra.rows()},
                    {"volume_mm3", mesh::element_volumes(body.volume).sum()},
                    {"repair", body.notes}};
    });
    mesh::MeshData data;
    job.body = mesh::read_vtu(job.folder.path() / "mesh/body.vtu", &data);
    job.element_regions = regions_read(data);
    job.surface = mesh::read_surface(job.folder.path() / "mesh/surface.vtp");
    report_stage(job.folder, "mesh", ran,
                 fmt::format("{} tetrahedra, {} nodes", job.body.tetrahedra.rows(), job.body.nodes.rows()));
    report_supports(job);
}

void skeleton_stage(Job& job) {
    const Case& c = job.subject.settings;
    const fs::path file = job.folder.path() / "skeleton/model.json";
    if (c.model) {
        take_model(job, *c.model);
        return;
    }
    const bool ran = job.folder.stage(
        {"skeleton",
         {{"settings", settings_of_stage(c, "skeleton")},
          {"young", job.subject.material.young},
          {"poisson", job.subject.material.poisson},
          {"density", job.subject.material.density},
          {"regions", moduli_of(job.subject.regions)},
          {"supports", mesh::regions_to_yaml(job.subject.supports)}},
         {},
         {"mesh"},
         {"skeleton/model.json", "skeleton/skeleton.vtp", "skeleton/medial_axis.vtp"}},
        [&] {
            skeleton::BuildReport report;
            skeleton::Model model = skeleton::build_skeleton(job.surface, job.body, job.subject.material,
                                                             job.subject.supports, c.skeleton, &report);
            model.name = c.name;
            std::ranges::move(take_regions(job.subject.regions, job.subject.material.young, model),
                              std::back_inserter(report.notes));
            Console::notices(report.notes);
            skeleton::write_model(file, model);
            skeleton::write_model_vtp(job.folder.path() / "skeleton/skeleton.vtp", model);
            mesh::write_vtp_lines(job.folder.path() / "skeleton/medial_axis.vtp", report.medial_centers, {},
                                  {.points = {{"radius [mm]", report.medial_radii}}});
            const auto held = std::count_if(model.spheres.begin(), model.spheres.end(), [](auto& s) { return s.held; });
            return json{{"spheres", model.spheres.size()},
                        {"held_spheres", held},
                        {"links", model.links.size()},
                        {"coverage_mm", report.coverage},
                        {"notes", report.notes}};
        });
    job.model = skeleton::read_model(file);
    report_stage(job.folder, "skeleton", ran,
                 fmt::format("{} spheres, {} links", job.model.spheres.size(), job.model.links.size()));
}

}  // namespace palpate::pipeline::commands
