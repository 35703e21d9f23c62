#include "mesh/formats/cad/read_cad.h"

#include <fmt/format.h>

#include <fstream>

#include "mesh/errors.h"

#ifdef PALPATE_WITH_CAD
#include "mesh/formats/cad/tessellate.h"
#include "mesh/system/bytes.h"
#include "mesh/system/child_process.h"
#endif

namespace palpate::mesh {

#ifdef PALPATE_WITH_CAD

template <class Archive>
void serialize(Archive& archive, Tessellation& t) {
    archive(t.error, t.solids, t.solids_united, t.faces, t.faces_missing, t.chord, t.surface.vertices,
            t.surface.triangles);
}

namespace {

constexpr ChildLimits reading_limits{300, 8192};
constexpr ChildLimits uniting_limits{120, 8192};

/// What the child came to, its own failure as an error in words.
Tessellation in_child(const std::filesystem::path& file, bool unite, const ChildLimits& limits) {
    using End = ChildResult::End;
    ChildResult child = run_in_child([&] { return to_bytes(tessellate(file, unite, cad_chord)); }, limits);
    Tessellation result;
    if (child.end == End::Answered) {
        from_bytes(std::move(child.answer), result);
        return result;
    }
    result.error = child.end == End::OutOfTime     ? fmt::format("OpenCASCADE did not end within {} s", limits.seconds)
                   : child.end == End::OutOfMemory ? fmt::format("OpenCASCADE needs more than {} MiB", limits.mebibytes)
                                                   : std::string("OpenCASCADE crashed");
    return result;
}

void note_solids(const Tessellation& t, const std::string& why_apart, std::vector<std::string>& notes) {
    if (t.solids == 0)
        notes.push_back(fmt::format("The file holds {} faces and no solid: sewn together where they meet.", t.faces));
    if (t.solids < 2) return;
    if (!why_apart.empty())
        notes.push_back(
            fmt::format("An assembly of {} solids that stay apart ({}): the repair unites them.", t.solids, why_apart));
    else if (t.solids_united == 1)
        notes.push_back(fmt::format("An assembly of {} solids: united to one body of one material.", t.solids));
    else
        notes.push_back(fmt::format(
            "An assembly of {} solids: where they touch they are united, {} are left that do not touch. Each must be "
            "held, or the body falls apart.",
            t.solids, t.solids_united));
}

}  // namespace

Surface read_cad(const std::filesystem::path& file, std::vector<std::string>& notes) {
    if (!std::filesystem::is_regular_file(file)) throw IoError(fmt::format("{}: no such file.", file.string()));
    if (!std::ifstream(file)) throw IoError(fmt::format("{}: cannot be opened for reading.", file.string()));
    Tessellation t = in_child(file, false, reading_limits);
    std::string why_apart;
    if (t.error.empty() && t.solids > 1) {
        Tessellation together = in_child(file, true, uniting_limits);
        why_apart = together.error;
        if (together.error.empty()) t = std::move(together);
    }
    if (!t.error.empty())
        throw InvalidInput(
            fmt::format("{}: {}. Export the body again as STEP (AP203 or AP214), or as STL.", file.string(), t.error));
    note_solids(t, why_apart, notes);
    if (t.faces_missing > 0)
        notes.push_back(
            fmt::format("{} of {} faces could not be meshed: they are holes now.", t.faces_missing, t.faces));
    notes.push_back(fmt::format("{} CAD faces cut into triangles, within {:.3g} mm of them.", t.faces, t.chord));
    return t.surface;
}

#else

Surface read_cad(const std::filesystem::path& file, std::vector<std::string>&) {
    throw InvalidInput(fmt::format(
        "{}: this program was built without OpenCASCADE, which reads CAD. Install libocct-data-exchange-dev "
        "and build it again, or export the body as STL.",
        file.string()));
}

#endif

}  // namespace palpate::mesh
