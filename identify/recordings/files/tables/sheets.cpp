#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "identify/recordings/files/conversion.h"
#include "identify/recordings/files/tables/table_recording.h"
#include "identify/recordings/files/text/decoding/open_text.h"
#include "mesh/errors.h"

namespace palpate::identify {
namespace {

/// A row a point, a column a frame.
Eigen::MatrixXd read_sheet(const std::filesystem::path& file, const FileMap& map, bool frames_in_rows) {
    FileMap plain;
    plain.encoding = map.encoding;
    plain.delimiter = map.delimiter;
    plain.decimal = map.decimal;
    plain.header_lines = map.header_lines;
    plain.names_line = 0;
    const auto text = open_text(file, plain);
    const NumberTable table = read_number_table(*text, plain);
    Eigen::MatrixXd sheet(table.rows(), static_cast<Eigen::Index>(table.columns.size()));
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
        if (table.columns[c].is_text)
            throw InvalidInput(
                fmt::format("{}: column {} holds texts; a sheet has numbers only.", file.filename().string(), c + 1));
        sheet.col(static_cast<Eigen::Index>(c)) = table.columns[c].values;
    }
    if (frames_in_rows) sheet.transposeInPlace();
    return sheet;
}

std::vector<Eigen::MatrixXd> read_all(const std::filesystem::path& file, const FileMap& map,
                                      const std::vector<std::string>& names) {
    std::vector<Eigen::MatrixXd> sheets;
    for (const std::string& name : names) {
        sheets.push_back(read_sheet(file_beside(file, name), map, map.sheets->frames_in_rows));
        if (sheets.back().rows() != sheets[0].rows() || sheets.back().cols() != sheets[0].cols())
            throw InvalidInput(fmt::format(
                "{} holds {} points and {} frames, {} holds {} and {}. Sheets of one recording "
                "are of one size.",
                name, sheets.back().rows(), sheets.back().cols(), names[0], sheets[0].rows(), sheets[0].cols()));
    }
    return sheets;
}

}  // namespace

Recording read_sheets(const std::filesystem::path& file, const FileMap& map) {
    const MappedSheets& told = *map.sheets;
    std::vector<Eigen::MatrixXd> sheets = read_all(file, map, told.at);
    std::vector<Eigen::MatrixXd> rest = read_all(file, map, told.rest);
    const Eigen::Index points = sheets[0].rows();
    for (Eigen::MatrixXd& sheet : rest)
        if (sheet.rows() == 1) sheet.transposeInPlace();
    for (const Eigen::MatrixXd& sheet : rest)
        if (sheet.cols() != 1 || sheet.rows() != points)
            throw InvalidInput(
                fmt::format("{}: {} points in {} frames, but the sheets of rest hold {} x {} numbers; one for "
                            "each point is needed. Is 'frames_in: rows' the other way round?",
                            file.filename().string(), points, sheets[0].cols(), sheet.rows(), sheet.cols()));

    const Eigen::Index before = rest.empty() ? 0 : 1, frames = sheets[0].cols() + before;
    Recording recording = begun(file.filename().string(), "matrices of coordinates");
    const double factor = position_factor(map, "", recording.source, recording);
    if (!map.names.empty() && static_cast<Eigen::Index>(map.names.size()) != points)
        throw InvalidInput(fmt::format("{}: the map gives {} names, but there are {} points. Name them all, or none.",
                                       recording.source, map.names.size(), points));
    for (Eigen::Index p = 0; p < points; ++p) {
        RecordedPoint point{
            .name = map.names.empty() ? fmt::format("{}", p + 1) : map.names[static_cast<std::size_t>(p)],
            .at = Eigen::Matrix3Xd::Zero(3, frames),
            .displacement = {}};
        for (std::size_t k = 0; k < sheets.size(); ++k) {
            const auto row = static_cast<Eigen::Index>(k);
            if (before) point.at(row, 0) = factor * rest[k](p, 0);
            point.at.row(row).tail(frames - before) = factor * sheets[k].row(p);
        }
        drop_partly_seen(point.at);
        recording.points.push_back(std::move(point));
    }
    if (map.rate)
        set_rate(*map.rate, frames, 0, recording);
    else
        set_no_clock(frames, recording);
    recording.notes.push_back(fmt::format("{} x {} numbers a sheet, points in {}", sheets[0].rows(), sheets[0].cols(),
                                          told.frames_in_rows ? "columns" : "rows"));
    if (before) recording.notes.emplace_back("the first frame is that of the sheets of rest");
    if (!map.rate) recording.notes.emplace_back("no clock is found: 'rate' in a map tells it");
    return recording;
}

}  // namespace palpate::identify
