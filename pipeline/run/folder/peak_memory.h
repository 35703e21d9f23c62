#pragma once

namespace palpate::pipeline {

/// Starts the count of this process's peak memory anew, where the system lets it (Linux: /proc/self/clear_refs).
void reset_peak_memory();

/// Largest resident memory since the last reset [MiB]; 0 where the system does not tell.
double peak_memory_mb();

}  // namespace palpate::pipeline
