#include "identify/recordings/files/file_map.h"

#include <fmt/format.h>

#include <utility>

#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::identify {
namespace {

using mesh::YamlFields;

constexpr double least_rate = 1e-9, most_rate = 1e9;  // [1/s]: a frame in thirty years, a nanosecond's

char read_sign(const YamlFields& fields, const std::string& key,
               const std::vector<std::pair<std::string, char>>& signs) {
    std::vector<std::string> names;
    names.reserve(signs.size());
    for (const auto& sign : signs) names.push_back(sign.first);
    const std::string chosen = fields.choice(key, names);
    for (const auto& [name, sign] : signs)
        if (name == chosen) return sign;
    return signs[0].second;
}

ColumnPlace as_place(const std::string& text) { return {.column = text, .file = ""}; }

std::vector<ColumnPlace> read_places(const YamlFields& fields, const std::string& key) {
    std::vector<ColumnPlace> places;
    for (const std::string& text : fields.texts(key)) places.push_back(as_place(text));
    if (places.size() < 2 || places.size() > 3)
        throw InvalidInput(fmt::format("{}: {} columns stand here; [x, y, z] are needed, or [x, y] of a plane.",
                                       fields.where(key), places.size()));
    return places;
}

std::vector<MappedPoint> read_mapped_points(const YamlFields& fields) {
    std::vector<MappedPoint> points;
    for (const YamlFields& entry : fields.mappings("points")) {
        MappedPoint point{.name = entry.text("name"), .at = read_places(entry, "at"), .displacement = {}};
        if (entry.has("displacement")) point.displacement = read_places(entry, "displacement");
        if (entry.has("file")) {
            const std::string file = entry.text("file");
            for (ColumnPlace& place : point.at) place.file = file;
            for (ColumnPlace& place : point.displacement) place.file = file;
        }
        entry.finish();
        points.push_back(std::move(point));
    }
    return points;
}

std::vector<MappedChannel> read_mapped_channels(const YamlFields& fields) {
    std::vector<MappedChannel> channels;
    for (const YamlFields& entry : fields.mappings("channels")) {
        MappedChannel channel{.place = as_place(entry.text("column")), .name = {}, .unit = {}};
        if (entry.has("file")) channel.place.file = entry.text("file");
        if (entry.has("name")) channel.name = entry.text("name");
        if (entry.has("unit")) channel.unit = entry.text("unit");
        entry.finish();
        channels.push_back(std::move(channel));
    }
    return channels;
}

MappedSheets read_mapped_sheets(const YamlFields& fields) {
    MappedSheets sheets{.at = fields.texts("at"), .rest = {}};
    if (fields.has("rest")) sheets.rest = fields.texts("rest");
    if (fields.has("frames_in")) sheets.frames_in_rows = fields.choice("frames_in", {"columns", "rows"}) == "rows";
    if (sheets.at.size() < 2 || sheets.at.size() > 3)
        throw InvalidInput(fmt::format("{}: {} files stand here; those of x and y are needed, and of z in space.",
                                       fields.where("at"), sheets.at.size()));
    if (!sheets.rest.empty() && sheets.rest.size() != sheets.at.size())
        throw InvalidInput(fmt::format("{}: {} files stand here, {} in 'at'. Give one for each coordinate.",
                                       fields.where("rest"), sheets.rest.size(), sheets.at.size()));
    fields.finish();
    return sheets;
}

}  // namespace

FileMap read_file_map(const YamlFields& fields) {
    FileMap map;
    constexpr int most_lines = 1000000;  // above a table: a larger number is a slip
    if (fields.has("format")) map.format = fields.choice("format", format_names);
    if (fields.has("encoding")) map.encoding = fields.choice("encoding", {"utf-8", "utf-16", "latin-1"});
    if (fields.has("delimiter"))
        map.delimiter =
            read_sign(fields, "delimiter",
                      {{"comma", ','}, {",", ','}, {"semicolon", ';'}, {";", ';'}, {"tab", '\t'}, {"blanks", ' '}});
    if (fields.has("decimal"))
        map.decimal = read_sign(fields, "decimal", {{"point", '.'}, {".", '.'}, {"comma", ','}, {",", ','}});
    if (fields.has("header_lines")) map.header_lines = fields.integer("header_lines", 0, most_lines);
    if (fields.has("names_line")) map.names_line = fields.integer("names_line", 0, most_lines);
    if (fields.has("time")) map.time = as_place(fields.text("time"));
    if (fields.has("time_unit")) map.time_unit = fields.choice("time_unit", {"s", "ms", "us", "ns", "min", "h"});
    if (fields.has("rate")) map.rate = fields.number("rate", least_rate, most_rate);
    if (fields.has("unit")) map.unit = fields.choice("unit", {"mm", "cm", "m", "um", "in", "pixel"});
    if (fields.has("pixel")) map.pixel = fields.number("pixel", 1e-9, 1e6);  // mm: from below light's to a kilometre
    if (map.unit == "pixel" && map.pixel == 0)
        throw InvalidInput(fmt::format("{}: tell the size of a pixel too, in mm: 'pixel: 0.1'.", fields.where("unit")));
    if (fields.has("names")) map.names = fields.texts("names");
    if (fields.has("points")) map.points = read_mapped_points(fields);
    if (fields.has("channels")) map.channels = read_mapped_channels(fields);
    if (fields.has("point_column")) map.point_column = as_place(fields.text("point_column"));
    if (fields.has("frame_column")) map.frame_column = as_place(fields.text("frame_column"));
    if (fields.has("sheets")) map.sheets = read_mapped_sheets(fields.mapping("sheets"));
    if (fields.has("series")) map.series = fields.boolean("series");
    if (map.format == "sheets" && !map.sheets)
        throw InvalidInput(
            fmt::format("{}: tell which files they are: 'sheets: {{at: [x.dat, y.dat]}}'.", fields.where("format")));
    return map;
}

}  // namespace palpate::identify
