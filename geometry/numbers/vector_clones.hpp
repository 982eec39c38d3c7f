// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// For loops over lanes that do not depend on each other. Of a function so marked the compiler makes several,
// for processors with AVX-512, with AVX2 and with neither, and the program takes at its start the one that
// the processor can run: the same sums and products, eight, four or two at a time. As nothing is contracted
// (-ffp-contract=off), the digits are the same. The file has to be compiled with the flags of
// src/engine/CMakeLists.txt. Builds with sanitizers have one of each: their library is not ready yet when the
// choice is made.
#if defined(__x86_64__) && defined(__ELF__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(TUBEFOOT_SANITIZED)
#if __GNUC__ >= 12
#define TUBEFOOT_VECTOR_CLONES __attribute__((target_clones("arch=x86-64-v4", "avx2", "default")))
#else
#define TUBEFOOT_VECTOR_CLONES __attribute__((target_clones("avx2", "default")))
#endif
#else
#define TUBEFOOT_VECTOR_CLONES
#endif
