// SPDX-License-Identifier: GPL-3.0-or-later
// Prints what the C library's own functions make of some arguments, so that a test sees whether it takes
// another path when it is told that the processor has fewer instructions. Loaded, not linked: ours would come
// first.
#include <dlfcn.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

typedef double (*function)(double);

int main(void) {
  void* library = dlopen("libm.so.6", RTLD_NOW);
  function sine = library ? (function)dlsym(library, "sin") : NULL;
  function exponential = library ? (function)dlsym(library, "exp") : NULL;
  if (!sine || !exponential) return 1;
  uint64_t hash = 0;
  for (int k = 1; k < 1000000; ++k) {
    const double values[] = {sine(1e-5 * k), exponential(-1e-5 * k)};
    uint64_t bits[2];
    memcpy(bits, values, sizeof bits);
    hash = 31 * (31 * hash + bits[0]) + bits[1];
  }
  printf("%" PRIx64 "\n", hash);
  return 0;
}
