#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "identify/measurements/measurement_set.h"

namespace palpate::identify {

/// What sensors do wrong from one reading to the next.
class SensorFaults {
public:
    explicit SensorFaults(std::size_t markers) : last_(markers) {}

    /// Why a reading cannot be taken in. Infinite coordinates, and those of markers that stay where they were under
    /// other loads, become missing ones; `mended` says so, and that it came out of order.
    std::optional<std::string> find(LoadState& reading, const std::set<StateName>& seen, std::string& mended);

private:
    struct Stuck {
        Vec3 position;
        Vec3 load;  // the sum of the forces then
        int times = 0;
    };
    std::vector<Stuck> last_;  // of each marker
};

}  // namespace palpate::identify
