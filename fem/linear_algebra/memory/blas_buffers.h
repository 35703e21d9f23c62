#pragma once

namespace palpate::fem {

/// Lets BLAS take the buffers of so many threads at once (128 MB of address space each). It takes them once and keeps
/// them, but tries for ever where there is no room: where memory is limited, call this before the body fills it.
void take_blas_buffers(int threads);

}  // namespace palpate::fem
