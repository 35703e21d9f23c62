#include "tests/fuzz/readers.h"

#include <cstdint>
#include <cstring>
#include <string>

#include "identify/measurements/measurement_set.h"
#include "identify/recordings/files/read_recordings.h"
#include "mesh/formats/read_body.h"
#include "mesh/formats/solution/read_solution.h"
#include "mesh/formats/surface/read_surface.h"
#include "mesh/formats/surface/surface_formats.h"
#include "mesh/formats/volume/write_volume.h"
#include "mesh/formats/vtk/vtk_files.h"
#include "mesh/text/atomic_file.h"
#include "pipeline/case/settings/read_case.h"
#include "pipeline/output/csv/posterior.h"
#include "samples/lattice.h"
#include "skeleton/model/io/model_io.h"
#include "tests/identify/recordings/c3d_sample.h"
#include "tests/identify/recordings/exodus_sample.h"
#include "tests/identify/recordings/mat_sample.h"
#include "tests/identify/recordings/text_samples.h"
#include "tests/temporary_folder.h"

namespace palpate::fuzz {
namespace {

namespace fs = std::filesystem;

mesh::Surface small_box() { return mesh::make_box({0, 0, 0}, {100, 20, 20}, {2, 1, 1}); }

/// A format that is written; the others' inputs stand below.
Reader surface(const char* extension) {
    const std::string name = std::string("body") + extension;
    return {extension + 1,
            [=](const fs::path& folder) {
                mesh::write_surface(folder / name, small_box());
                return folder / name;
            },
            [=](const fs::path& folder) { mesh::read_surface(folder / name); }};
}

Reader written(const char* name, const std::string& file, const std::string& text,
               const std::function<void(const fs::path&)>& read) {
    return {name,
            [=](const fs::path& folder) {
                mesh::write_text(folder / file, text);
                return folder / file;
            },
            [=](const fs::path& folder) { read(folder / file); }};
}

/// One file of a measurement set.
Reader set(const char* file) {
    return {
        file,
        [=](const fs::path& folder) {
            identify::MeasurementSet set;
            set.rest_surface = small_box();
            set.supports = {mesh::BoxRegion{Vec3(-1, -1, -1), Vec3(1, 21, 21)}};
            set.markers = {{0, Vec3(100, 10, 20), std::nullopt}, {4, Vec3(50, 10, 25), Vec3(50, 10, 20)}};
            set.states = {{.probe = 1,
                           .contacts = {{Vec3(100, 10, 20), Vec3(0, 0, -1), 3}},
                           .readings = {{0, Vec3(100, 10, 18), 0.1}, {1, Vec3(50, 10, 24), identify::missing}},
                           .gravity = Vec3(0, 0, -9810)}};
            set.recordings = {
                {.probe = 2,
                 .loads = {{.probe = 2, .contacts = {{Vec3(100, 10, 20), Vec3(0, 0, -1), 3}}}, {.probe = 2, .time = 1}},
                 .instants = {{0, {{0, Vec3(100, 10, 18), 0.1}}}, {0.01, {{0, Vec3(100, 10, 19), 0.1}}}}}};
            identify::write_measurement_set(folder / "set", set);
            // as STL, which is read in no time
            mesh::write_surface(folder / "set/rest.stl", set.rest_surface);
            std::string yaml = mesh::read_text(folder / "set/set.yaml");
            mesh::write_text(folder / "set/set.yaml", yaml.replace(yaml.find("rest.vtp"), 8, "rest.stl"));
            return folder / "set" / file;
        },
        [](const fs::path& folder) { identify::read_measurement_set(folder / "set"); }};
}

/// One file of a set of the second format.
Reader rig(const char* name, const char* file) {
    return {name,
            [=](const fs::path& folder) {
                identify::MeasurementSet set;
                set.rest_surface = small_box();
                set.supports = {mesh::BoxRegion{Vec3(-1, -1, -1), Vec3(1, 21, 21)}};
                set.tools = {{.name = "ball", .shape = mesh::SphereShape{5}, .origin = Vec3(50, 10, 26)},
                             {.name = "punch", .shape = mesh::FlatShape{5, -Vec3::UnitZ()}, .origin = Vec3(60, 10, 21)},
                             {.name = "grip",
                              .shape = mesh::GripShape{{mesh::BoxRegion{Vec3(99, -1, -1), Vec3(101, 21, 21)}}},
                              .bonded = true}};
                Points path(2, 3);
                path << 1, 10, 10, 90, 10, 10;
                set.actuators = {{.name = "cable", .kind = mesh::TendonActuator{path}}};
                set.markers = {{0, Vec3(100, 10, 20), std::nullopt}};
                set.states = {
                    {.probe = 0},
                    {.probe = 1,
                     .motions = {{0, Vec3(0, 0, -2), Vec3::Zero()}, {2, Vec3(1, identify::missing, 0), Vec3::Zero()}},
                     .actuations = {{0, 2, 0.1}},
                     .readings = {{0, Vec3(101, 10, 20), 0.1, identify::StateName{0, 0}}},
                     .reactions = {{0, Vec3(identify::missing, 0, -1), Vec3::Zero(), 0.1}}}};
                identify::write_measurement_set(folder / "set", set);
                mesh::write_surface(folder / "set/rest.stl", set.rest_surface);
                std::string yaml = mesh::read_text(folder / "set/set.yaml");
                mesh::write_text(folder / "set/set.yaml", yaml.replace(yaml.find("rest.vtp"), 8, "rest.stl"));
                return folder / "set" / file;
            },
            [](const fs::path& folder) { identify::read_measurement_set(folder / "set"); }};
}

Reader model() {
    return {"model.json",
            [](const fs::path& folder) {
                skeleton::write_model(folder / "model.json", samples::make_lattice("bar", {3, 2, 1}, 1));
                return folder / "model.json";
            },
            [](const fs::path& folder) { skeleton::read_model(folder / "model.json"); }};
}

Reader volume() {
    return {"vtu",
            [](const fs::path& folder) {
                mesh::write_vtu(folder / "body.vtu", mesh::make_bar({0, 0, 0}, {100, 20, 20}, {1, 1, 1}));
                return folder / "body.vtu";
            },
            [](const fs::path& folder) { mesh::read_vtu(folder / "body.vtu"); }};
}

const char* const text_stl =
    "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid "
    "a\n";
const char* const text_ply =
    "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
    "double z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
std::string case_with_all_settings() {
    pipeline::Case settings;
    settings.mesh = "body.stl";
    settings.supports = {mesh::BoxRegion{Vec3(-1, -1, -1), Vec3(5, 21, 21)}};
    return pipeline::to_yaml(settings);
}
const char* const deck =
    "*NODE, NSET=ALL\n1, 0, 0, 0\n2, 2, 0, 0\n3, 2, 2, 0\n4, 0, 2, 0\n5, 0, 0, 2\n6, 2, 0, 2\n7, 2, 2, 2\n8, 0, 2, 2\n"
    "*ELEMENT, TYPE=C3D8, ELSET=E\n1, 1, 2, 3, 4, 5, 6, 7, 8\n*NSET, NSET=LOW, GENERATE\n1, 4, 1\n*BOUNDARY\nLOW, 1, "
    "3\n"
    "*MATERIAL, NAME=A\n*ELASTIC\n0.1, 0.4\n*STEP\n*STATIC\n*CLOAD\n7, 3, -1.\n*DLOAD\nE, GRAV, 9810, 0, 0, -1\n*END "
    "STEP\n";
const char* const frd =
    "    2C                             4                                     1\n"
    " -1         1 0.00000E+00 0.00000E+00 0.00000E+00\n -1         2 2.00000E+00 0.00000E+00 0.00000E+00\n"
    " -1         3 0.00000E+00 2.00000E+00 0.00000E+00\n -1         4 0.00000E+00 0.00000E+00 2.00000E+00\n -3\n"
    "    3C                             1                                     1\n"
    " -1         1    3    0    1\n -2         1         2         3         4\n -3\n"
    "  100CL  101 1.000000000           4                     0    1           1\n -4  DISP        4    1\n"
    " -1         4-1.00000E-01-2.50000E-02-1.00000E+00\n -3\n";
const char* const posterior =
    "parameter,link,unit,mean,sd,q025,q50,q975,prior_mean,prior_sd,informed\n"
    "elongation:link0,0,N/mm,1.2,0.1,1.0,1.2,1.4,1,0.5,1\nflexion,,N*mm/rad,400,10,380,400,420,500,200,1\n";

const char* const ply_strips =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement "
    "tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 0 2 1\n";
const char* const gmsh_1 =
    "$NOD\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$ENDNOD\n$ELM\n2\n1 2 7 1 3 1 2 3\n2 4 7 1 4 1 2 3 4\n$ENDELM\n";
const char* const vtk_grid =
    "# vtk DataFile Version 3.0\na\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 float\n0 0 0 2 0 0 2 2 0 0 2 0 0 0 2 2 "
    "0 2 2 2 2 0 2 2\nCELLS 1 9\n8 0 1 2 3 4 5 6 7\nCELL_TYPES 1\n12\n";
const char* const vtk_surface =
    "# vtk DataFile Version 2.0\na\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n0 0 0 1 0 0 0 1 0 1 1 0\nPOLYGONS 1 4\n3 "
    "0 "
    "1 2\nTRIANGLE_STRIPS 1 5\n4 0 1 2 3\n";

std::string gmsh() {
    const TemporaryFolder folder;
    mesh::write_gmsh(folder / "body.msh", mesh::make_bar({0, 0, 0}, {100, 20, 20}, {1, 1, 1}), mesh::GmshVersion::v4_1);
    return mesh::read_text(folder / "body.msh");
}
const char* const medit =
    "MeshVersionFormatted 2\nDimension 3\nVertices\n4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\nTetrahedra\n1\n1 2 3 4 "
    "0\nEnd\n";
/// 4 x 4 x 4 voxels, of which 2 x 2 x 2 are an organ.
std::string voxels() {
    std::string bytes(64, '\0');
    for (const std::size_t v : {21u, 22u, 25u, 26u, 37u, 38u, 41u, 42u}) bytes[v] = 1;
    return bytes;
}
std::string meta_image() {
    return "ObjectType = Image\nNDims = 3\nTransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 0 0 0\nElementSpacing = 1 1 "
           "2\n"
           "DimSize = 4 4 4\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n" +
           voxels();
}
std::string nrrd() {
    return "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: 4 4 4\n"
           "space directions: (1,0,0) (0,1,0) (0,0,2)\nspace origin: (0,0,0)\nencoding: raw\n\n" +
           voxels();
}
std::string nifti() {
    std::string head(352, '\0');
    const auto put = [&](std::size_t at, auto value) { std::memcpy(head.data() + at, &value, sizeof value); };
    put(0, std::int32_t{348});
    for (std::size_t d = 0; d < 4; ++d) put(40 + 2 * d, static_cast<std::int16_t>(d == 0 ? 3 : 4));
    put(70, std::int16_t{2});
    for (std::size_t d = 0; d < 3; ++d) put(80 + 4 * d, 1.0F);
    put(108, 352.0F);
    head.replace(344, 3, "n+1");
    return head + voxels();
}
/// Two files of TetGen; the second is broken.
Reader tetgen() {
    return {"ele",
            [](const fs::path& folder) {
                mesh::write_text(folder / "body.node", "4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n");
                mesh::write_text(folder / "body.ele", "1 4 0\n1 1 2 3 4\n");
                return folder / "body.ele";
            },
            [](const fs::path& folder) { mesh::read_body(folder / "body.ele"); }};
}
void read_body(const fs::path& file) { mesh::read_body(file); }

/// A file of a rig.
Reader recording(const char* name, const std::string& file, const std::string& content) {
    return written(name, file, content, [](const fs::path& f) { identify::read_recordings(f); });
}

/// What `write` writes into a file.
std::string bytes_of(const std::function<void(const fs::path&)>& write) {
    const TemporaryFolder folder;
    write(folder / "sample");
    return mesh::read_text(folder / "sample");
}

}  // namespace

std::vector<Reader> all_readers() {
    std::vector<Reader> readers{
        volume(),
        model(),
        written("text_stl", "text.stl", text_stl, [](const fs::path& f) { mesh::read_surface(f); }),
        written("text_ply", "text.ply", text_ply, [](const fs::path& f) { mesh::read_surface(f); }),
        written("case", "case.yaml", case_with_all_settings(), [](const fs::path& f) { pipeline::read_case(f); }),
        written("inp", "body.inp", deck, read_body),
        written("msh", "body.msh", gmsh(), read_body),
        written("msh1", "one.msh", gmsh_1, read_body),
        written("strips", "strips.ply", ply_strips, [](const fs::path& f) { mesh::read_surface(f); }),
        written("vtk", "body.vtk", vtk_grid, read_body),
        written("vtk_surface", "surface.vtk", vtk_surface, read_body),
        written("medit", "body.mesh", medit, read_body),
        tetgen(),
        written("mha", "body.mha", meta_image(), read_body),
        written("nrrd", "body.nrrd", nrrd(), read_body),
        written("nii", "body.nii", nifti(), read_body),
        written("frd", "job.frd", frd, [](const fs::path& f) { mesh::read_solution(f); }),
        written("posterior", "posterior.csv", posterior, [](const fs::path& f) { pipeline::read_posterior(f); }),
        set("set.yaml"),
        set("probes.csv"),
        set("markers.csv"),
        set("positions.csv"),
        set("states.csv"),
        set("motion_probes.csv"),
        set("motion_positions.csv"),
        rig("rig_set.yaml", "set.yaml"),
        rig("motions.csv", "motions.csv"),
        rig("reactions.csv", "reactions.csv"),
        rig("actuations.csv", "actuations.csv"),
        rig("displacements.csv", "displacements.csv"),
        recording("c3d", "run.c3d", identify::C3dSample().bytes()),
        recording("trc", "run.trc", identify::trc_sample),
        recording("motive", "take.csv", identify::motive_sample),
        recording("vicon", "trial.csv", identify::vicon_sample),
        recording("bluehill", "pull.csv", identify::bluehill_sample),
        recording("testxpert", "pull.tra", identify::zwick_sample),
        recording("aramis", "frame.txt", identify::aramis_sample),
        recording("dice", "frame.csv", identify::dice_sample),
        recording("vic", "frame.csv", identify::vic_sample),
        recording("scan", "scan.ply", identify::ply_sample),
        recording("exodus", "frames.e", bytes_of([](const fs::path& f) { identify::write_exodus(f, {}); })),
        recording("ncorr", "frames.mat", bytes_of([](const fs::path& f) { identify::write_ncorr(f); })),
        recording("multidic", "frames.mat", bytes_of([](const fs::path& f) { identify::write_multidic(f); })),
        recording("long_table", "long.csv", identify::long_sample)};
    for (const mesh::SurfaceFormat& format : mesh::surface_formats())
        if (format.write) readers.push_back(surface(format.extension));
    return readers;
}

}  // namespace palpate::fuzz
