#include "fem/linear_algebra/memory/huge_pages.h"

#include <sys/mman.h>
#include <unistd.h>

#include <memory>

namespace palpate::fem {

void use_huge_pages(void* memory, std::size_t bytes) {
    constexpr std::size_t large = std::size_t(16) << 20;
    const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    if (bytes >= large && std::align(page, bytes - page, memory, bytes)) madvise(memory, bytes, MADV_HUGEPAGE);
}

}  // namespace palpate::fem
