#pragma once

namespace palpate::fem {

/// Memory that this process can still take [GB]: what the machine has available, or less where a limit is set for the
/// process (ulimit -v) or its control group. Infinite where none of that can be read.
double free_memory();

}  // namespace palpate::fem
