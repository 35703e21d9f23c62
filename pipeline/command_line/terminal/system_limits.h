#pragma once

namespace palpate::pipeline {

/// Meets the limits that a shell or a batch system has set for this process (`ulimit`). A file that grows past its
/// limit becomes an error of the write, as on a full disk, and no signal that ends the program. In a limited address
/// space BLAS takes its buffers now, as it waits for ever where it gets none later.
/// @throws InvalidInput if less can be addressed than libraries, these buffers and a small body take.
void apply_system_limits(int threads);

}  // namespace palpate::pipeline
