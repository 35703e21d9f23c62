#include "identify/recordings/files/exodus/read_exodus.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "identify/recordings/files/conversion.h"
#include "identify/recordings/files/exodus/exodus_values.h"
#include "identify/recordings/files/text/cell.h"
#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::identify {
namespace {

const NodalField* field_of(const ExodusNodes& nodes, const std::string& name) {
    const auto found =
        std::ranges::find_if(nodes.fields, [&](const NodalField& one) { return lower_case(one.name) == name; });
    return found == nodes.fields.end() ? nullptr : &*found;
}

/// Components x, y and z of a displacement; the last one null: it is not seen.
using Components = std::array<const NodalField*, 3>;

std::optional<Components> components(const ExodusNodes& nodes, const std::string& name) {
    const Components found{field_of(nodes, name + "x"), field_of(nodes, name + "y"), field_of(nodes, name + "z")};
    if (!found[0] || !found[1]) return std::nullopt;
    return found;
}

/// By the names that DICe (of its cameras' common frame first), Sierra and MOOSE give.
Components displacement_in(const ExodusNodes& nodes, const std::string& file) {
    for (const char* name : {"model_displacement_", "displacement_", "displ_", "disp_", "displ", "disp", "u_"})
        if (const auto found = components(nodes, name)) return *found;
    std::vector<std::string> names;
    for (const NodalField& field : nodes.fields) names.push_back(field.name);
    throw InvalidInput(fmt::format(
        "{}: an Exodus file whose nodes have {}, and no displacement (DISPLACEMENT_X, DISPLACEMENT_Y). Write "
        "it with one.",
        file, names.empty() ? "no quantity" : mesh::listed(names)));
}

/// Counts of frames, as DICe writes them, are no times.
bool are_frames(const Eigen::VectorXd& times) {
    for (Eigen::Index f = 0; f < times.size(); ++f)
        if (times[f] != times[0] + static_cast<double>(f)) return false;
    return times.size() == 0 || times[0] == 0 || times[0] == 1;
}

void set_clock(const ExodusNodes& nodes, Eigen::Index frames, const std::string& file, const FileMap& map,
               Recording& recording) {
    if (map.rate) return set_rate(*map.rate, frames, 0, recording);
    if (nodes.times.size() != frames || are_frames(nodes.times)) {
        set_no_clock(frames, recording);
        recording.notes.emplace_back("its times count frames: 'rate' in a map tells the clock");
        return;
    }
    if (!nodes.times.allFinite() || !std::ranges::is_sorted(nodes.times))
        throw InvalidInput(
            fmt::format("{}: its times do not ascend. Write it again, or give a map with 'rate'.", file));
    recording.times = nodes.times;
    recording.has_clock = true;
}

}  // namespace

bool is_exodus(const std::string& bytes) {
    return bytes.starts_with("CDF\x01") || bytes.starts_with("CDF\x02") || bytes.starts_with("CDF\x05") ||
           bytes.starts_with("\x89HDF");
}

Recording read_exodus(const std::filesystem::path& file, const FileMap& map) {
    const std::string name = file.filename().string();
    const ExodusNodes nodes = read_exodus_nodes(file);
    const Components moved = displacement_in(nodes, name);
    const NodalField* sigma = field_of(nodes, "sigma");  // DICe: negative where the correlation failed
    const bool is_dice = sigma && field_of(nodes, "gamma");
    const bool is_of_one_camera =
        (is_dice || field_of(nodes, "initial_coordinates_x")) && nodes.coordinates.cols() == 2;
    Recording recording =
        begun(name, is_dice || is_of_one_camera ? "Exodus, DICe, image correlation" : "Exodus, nodes");
    const double factor = position_factor(map, is_of_one_camera ? "pixel" : "", name, recording);

    const Eigen::Index count = nodes.coordinates.rows(), frames = moved[0]->values.cols();
    if (frames == 0) throw InvalidInput(fmt::format("{}: it holds no instant. Write it with its results.", name));
    int lost = 0;
    for (Eigen::Index p = 0; p < count; ++p) {
        const int id = nodes.ids.empty() ? static_cast<int>(p) + 1 : nodes.ids[static_cast<std::size_t>(p)];
        Vec3 rest = Vec3::Zero();
        rest.head(nodes.coordinates.cols()) = nodes.coordinates.row(p);
        RecordedPoint point{fmt::format("{}", id), Eigen::Matrix3Xd::Constant(3, frames, not_seen),
                            Eigen::Matrix3Xd::Constant(3, frames, not_seen)};
        for (Eigen::Index f = 0; f < frames; ++f) {
            const bool is_lost = sigma && sigma->values(p, f) < 0;
            lost += is_lost;
            Vec3 way = Vec3::Zero();
            for (std::size_t k = 0; k < 3; ++k)
                if (moved[k]) way[static_cast<Eigen::Index>(k)] = moved[k]->values(p, f);
            const Vec3 at = factor * (rest + way);
            if (is_lost || !at.allFinite() || at.cwiseAbs().maxCoeff() >= mesh::beyond_all_units) continue;
            point.at.col(f) = at;
            point.displacement.col(f) = factor * way;
        }
        recording.points.push_back(std::move(point));
    }
    recording.notes.push_back(fmt::format("nodes are those at rest, {} leads from them", mesh::cited(moved[0]->name)));
    recording.notes.emplace_back(nodes.ids.empty() ? "points are named by their order"
                                                   : "points are named by their id");
    if (lost > 0) recording.notes.push_back(fmt::format("{} readings of a negative sigma: not found there", lost));
    set_clock(nodes, frames, name, map, recording);
    name_points(map, name, recording);
    return recording;
}

}  // namespace palpate::identify
