#pragma once

#include <cstddef>

namespace palpate::fem {

/// Asks for huge pages where memory is about to be written for the first time: fewer interruptions, and faster ways
/// from page to page. Large blocks only; nothing happens where the system does not have them.
void use_huge_pages(void* memory, std::size_t bytes);

}  // namespace palpate::fem
