#include "identify/recordings/files/mocap/frame_times.h"

#include "identify/recordings/files/conversion.h"

namespace palpate::identify {

void set_frame_times(const TextFile& text, const NumberRows& rows, const FileMap& map, Recording& recording) {
    if (map.rate) return set_rate(*map.rate, rows.values.rows(), 0, recording);
    const NumberColumn time{.name = "Time", .unit = "s", .values = rows.values.col(1), .texts = {}};
    set_times(
        time, map, [&](Eigen::Index r) { return text.where(rows.lines[static_cast<std::size_t>(r)]); }, recording);
}

}  // namespace palpate::identify
