// SPDX-License-Identifier: GPL-3.0-or-later
// Preloaded into the program: no more than TUBEFOOT_MOST_THREADS threads besides the first can be started at a time, as
// under `ulimit -u`, which does not count for root.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <pthread.h>
#include <stdlib.h>

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

static int running;  // changed across threads

struct start {
  void* (*work)(void*);
  void* with;
};

static void gone(void* unused) {
  (void)unused;
  __atomic_fetch_sub(&running, 1, __ATOMIC_SEQ_CST);
}

static void* counted(void* data) {
  const struct start start = *(struct start*)data;
  free(data);
  void* result;
  pthread_cleanup_push(gone, NULL);
  result = start.work(start.with);
  pthread_cleanup_pop(1);
  return result;
}

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*work)(void*), void* with) {
  const char* most = getenv("TUBEFOOT_MOST_THREADS");
  if (__atomic_add_fetch(&running, 1, __ATOMIC_SEQ_CST) > (most ? atoi(most) : 1000000)) {
    gone(NULL);
    return EAGAIN;
  }
  struct start* start = malloc(sizeof *start);
  if (start == NULL) {
    gone(NULL);
    return EAGAIN;
  }
  start->work = work;
  start->with = with;
  const int failed = REAL(pthread_create)(thread, attributes, counted, start);
  if (failed) {
    free(start);
    gone(NULL);
  }
  return failed;
}
