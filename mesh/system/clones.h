#pragma once

// Kernels, in .cpp files: a function marked so is compiled into a version for each of these processors, and the program
// takes the one that fits. What is to be part of it has to be inlined.

#if defined(__x86_64__) && defined(__gnu_linux__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__)
#define PALPATE_CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define PALPATE_CLONES
#endif
#define PALPATE_INLINE inline __attribute__((always_inline))
