#pragma once

#include <string>

namespace palpate::identify {

/// How a file's clock became that of its probe.
struct ClockReport {
    std::string file, how;
    int probe = 0;
    double offset = 0, rate = 1, sd = 0;  // t = offset + rate t_file [s], sd in the middle
};

}  // namespace palpate::identify
