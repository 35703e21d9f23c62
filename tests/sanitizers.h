#pragma once

// PALPATE_ADDRESS_SANITIZER: compiled with the address sanitizer, which gcc and clang tell in ways of their own.
#if defined(__SANITIZE_ADDRESS__)
#define PALPATE_ADDRESS_SANITIZER
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define PALPATE_ADDRESS_SANITIZER
#endif
#endif
