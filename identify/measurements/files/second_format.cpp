#include "identify/measurements/files/second_format.h"

#include <fmt/format.h>

#include <array>
#include <string>

#include "mesh/errors.h"

namespace palpate::identify {
namespace {

namespace fs = std::filesystem;

/// A part of the second format: a field of set.yaml within a mapping of it ("" for the whole), or a file.
struct FormatPart {
    const char* mapping;
    const char* name;
    const char* instead = nullptr;  // what to do, of a part that cannot be fitted yet
};

constexpr const char* see_triangulated =
    "Triangulate the markers from the cameras into positions.csv, and take views, images.csv and noise.image out.";
constexpr const char* see_points =
    "Read points off the surfaces into positions.csv (an empty marker is a point without a name), and take surfaces/ "
    "and noise.surface out.";

constexpr std::array parts_of_yaml{FormatPart{"", "tools"},
                                   FormatPart{"", "actuators"},
                                   FormatPart{"", "displacements"},
                                   FormatPart{"", "correlated"},
                                   FormatPart{"units", "angle"},
                                   FormatPart{"units", "pressure"},
                                   FormatPart{"units", "moment"},
                                   FormatPart{"noise", "reaction"},
                                   FormatPart{"noise", "moment"},
                                   FormatPart{"", "regions"},
                                   FormatPart{"", "views", see_triangulated},
                                   FormatPart{"noise", "image", see_triangulated},
                                   FormatPart{"correlated", "image", see_triangulated},
                                   FormatPart{"noise", "surface", see_points},
                                   FormatPart{"correlated", "surface", see_points}};
constexpr std::array parts_in_files{FormatPart{"", "motions.csv"},
                                    FormatPart{"", "reactions.csv"},
                                    FormatPart{"", "actuations.csv"},
                                    FormatPart{"", "displacements.csv"},
                                    FormatPart{"", "images.csv", see_triangulated},
                                    FormatPart{"", "surfaces", see_points}};

void refuse_part(const FormatPart& part, bool is_first_format, const std::string& where, const std::string& name) {
    if (is_first_format)
        throw InvalidInput(
            fmt::format("{}: '{}' belongs to the second format of a set, and this one says '{}'. Say 'format: {}'.",
                        where, name, first_format_name, second_format_name));
    if (part.instead)
        throw InvalidInput(fmt::format("{}: '{}' belongs to the format, and this version cannot fit it yet. {}", where,
                                       name, part.instead));
}

}  // namespace

void check_parts(const mesh::YamlFields& set, bool is_first_format, const fs::path& folder) {
    for (const FormatPart& part : parts_of_yaml) {
        const std::string mapping = part.mapping;
        if (!mapping.empty() && !set.has(mapping)) continue;
        const mesh::YamlFields around = mapping.empty() ? set : set.mapping(mapping);
        if (around.has(part.name)) refuse_part(part, is_first_format, around.where(part.name), part.name);
    }
    for (const FormatPart& part : parts_in_files)
        if (fs::exists(folder / part.name))
            refuse_part(part, is_first_format, (folder / part.name).string(), part.name);
}

}  // namespace palpate::identify
