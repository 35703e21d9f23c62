#include "pipeline/run/folder/peak_memory.h"

#include <fstream>
#include <sstream>
#include <string>

namespace palpate::pipeline {

void reset_peak_memory() { std::ofstream("/proc/self/clear_refs") << "5"; }

double peak_memory_mb() {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);) {
        if (line.rfind("VmHWM:", 0) == 0) {
            double kilobytes = 0;
            std::istringstream(line.substr(6)) >> kilobytes;
            return kilobytes / 1024;
        }
    }
    return 0;
}

}  // namespace palpate::pipeline
