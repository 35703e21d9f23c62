#include "identify/recordings/files/mat/read_mat.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <utility>

#include "identify/recordings/files/conversion.h"
#include "identify/recordings/files/mat/mat_values.h"
#include "mesh/errors.h"
#include "mesh/text/words.h"

namespace palpate::identify {
namespace {

void set_frames(Eigen::Index frames, const FileMap& map, Recording& recording) {
    if (map.rate) return set_rate(*map.rate, frames, 0, recording);
    set_no_clock(frames, recording);
    recording.notes.emplace_back("no clock is found: 'rate' in a map tells it");
}

/// Of a grid every so-many-th row and column, so that all frames together have this many positions at most.
Eigen::Index stride_of(Eigen::Index positions) {
    constexpr double most = 5e6;
    return static_cast<Eigen::Index>(std::ceil(std::sqrt(std::max(1.0, static_cast<double>(positions) / most))));
}

Recording from_ncorr(const MatCorrelation& data, const std::string& file, const FileMap& map) {
    Recording recording = begun(file, "Ncorr, image correlation");
    const auto frames = static_cast<Eigen::Index>(data.u.size());
    const Eigen::Index rows = data.u[0].rows(), columns = data.u[0].cols();
    for (std::size_t f = 0; f < data.u.size(); ++f)
        if (data.u[f].rows() != rows || data.v[f].rows() != rows || data.u[f].cols() != columns ||
            data.v[f].cols() != columns || data.u[f].size() == 0)
            throw InvalidInput(
                fmt::format("{}: displacements of frame {} are of another size than those of frame 1, or "
                            "missing. Format the displacements in Ncorr and save again.",
                            file, f + 1));
    if (!(data.spacing >= 0) || !(data.unit_per_pixel > 0))
        throw InvalidInput(
            fmt::format("{}: its spacing is {} and a pixel is {} units; 0 or more, and more than 0, are "
                        "allowed. Format the displacements in Ncorr and save again.",
                        file, data.spacing, data.unit_per_pixel));
    const double factor = position_factor(map, data.unit, file, recording);
    const double step = factor * data.unit_per_pixel * (data.spacing + 1);
    const Eigen::Index stride = stride_of(rows * columns * frames);
    const auto is_seen = [&](std::size_t f, Eigen::Index r, Eigen::Index c) {
        const double u = data.u[f](r, c), v = data.v[f](r, c);
        return std::isfinite(u) && std::isfinite(v) && (u != 0 || v != 0);
    };
    for (Eigen::Index c = 0; c < columns; c += stride)
        for (Eigen::Index r = 0; r < rows; r += stride) {
            RecordedPoint point{fmt::format("{} {}", c + 1, r + 1), Eigen::Matrix3Xd::Constant(3, frames, not_seen),
                                Eigen::Matrix3Xd::Constant(3, frames, not_seen)};
            bool is_anywhere = false;
            for (std::size_t f = 0; f < data.u.size(); ++f) {
                if (!is_seen(f, r, c)) continue;
                is_anywhere = true;
                const Eigen::Vector3d moved(factor * data.u[f](r, c), factor * data.v[f](r, c), 0);
                const auto frame = static_cast<Eigen::Index>(f);
                point.displacement.col(frame) = moved;
                point.at.col(frame) =
                    Eigen::Vector3d(step * static_cast<double>(c), step * static_cast<double>(r), 0) + moved;
            }
            if (is_anywhere) recording.points.push_back(std::move(point));
        }
    recording.notes.push_back(
        fmt::format("{} x {} grid, points are named by column and row; y points down, as in the image", rows, columns));
    if (stride > 1) recording.notes.push_back(fmt::format("every {}th row and column is taken", stride));
    set_frames(frames, map, recording);
    return recording;
}

Recording from_multidic(const MatCorrelation& data, const std::string& file, const FileMap& map) {
    Recording recording = begun(file, "MultiDIC, image correlation");
    const auto frames = static_cast<Eigen::Index>(data.points.size());
    const Eigen::Index count = data.points[0].rows();
    const bool has_displacements = data.displacements.size() == data.points.size();
    for (std::size_t f = 0; f < data.points.size(); ++f) {
        const bool fits =
            data.points[f].rows() == count && data.points[f].cols() == 3 &&
            (!has_displacements || (data.displacements[f].rows() == count && data.displacements[f].cols() == 3));
        if (!fits)
            throw InvalidInput(
                fmt::format("{}: frame {} has {} x {} numbers in Points3D, or other displacements; {} x 3 are "
                            "needed, as in frame 1. Save it again.",
                            file, f + 1, data.points[f].rows(), data.points[f].cols(), count));
    }
    const double factor = position_factor(map, "", file, recording);
    for (Eigen::Index p = 0; p < count; ++p) {
        RecordedPoint point{fmt::format("{}", p + 1), Eigen::Matrix3Xd(3, frames), {}};
        if (has_displacements) point.displacement.resize(3, frames);
        for (std::size_t f = 0; f < data.points.size(); ++f) {
            const auto frame = static_cast<Eigen::Index>(f);
            point.at.col(frame) = factor * data.points[f].row(p).transpose();
            if (!point.at.col(frame).allFinite()) point.at.col(frame).setConstant(not_seen);
            if (has_displacements) point.displacement.col(frame) = factor * data.displacements[f].row(p).transpose();
        }
        recording.points.push_back(std::move(point));
    }
    set_frames(frames, map, recording);
    return recording;
}

}  // namespace

bool is_mat(const std::string& bytes) {
    return bytes.starts_with("MATLAB 5.0 MAT-file") || bytes.starts_with("MATLAB 7.3 MAT-file");
}

Recording read_mat(const std::filesystem::path& file, const FileMap& map) {
    const MatCorrelation data = read_mat_correlation(file);
    const std::string name = file.filename().string();
    Recording recording;
    if (!data.u.empty())
        recording = from_ncorr(data, name, map);
    else if (!data.points.empty())
        recording = from_multidic(data, name, map);
    else
        throw InvalidInput(
            fmt::format("{}: a MATLAB file with {}. Read are 'data_dic_save' of Ncorr, with formatted "
                        "displacements, and structures of MultiDIC that have 'Points3D'. Write other arrays as "
                        "CSV (writematrix).",
                        name, data.variables.empty() ? "no variable" : mesh::listed(data.variables)));
    name_points(map, name, recording);
    return recording;
}

}  // namespace palpate::identify
