// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Marks functions with loops over independent lanes. The compiler makes several versions of a marked
// function: for processors with AVX-512, with AVX2 and with neither. The program selects at start the version
// that the processor supports. All versions compute the same sums and products, eight, four or two at a time.
// Floating-point contraction is off (-ffp-contract=off), so the digits are the same.
//
// The file must be compiled with the flags of src/engine/CMakeLists.txt. Builds with sanitizers have one
// version only, because the sanitizer library is not initialised when the version is selected.
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
