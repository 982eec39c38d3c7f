// SPDX-License-Identifier: GPL-3.0-or-later
#include "run_apart.hpp"

#include <hdf5.h>
#include <tbb/task_arena.h>
#include <tbb/task_scheduler_observer.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

#include "geometry/steps/stop.hpp"

namespace tubefoot::python {
namespace py = pybind11;
namespace {

/// Tells whoever takes part in an arena's work what may stop it.
class StopTeller : public tbb::task_scheduler_observer {
 public:
  StopTeller(tbb::task_arena& arena, const std::atomic<bool>& stop)
      : tbb::task_scheduler_observer(arena), stop_(stop) {
    observe(true);
  }
  ~StopTeller() override { observe(false); }
  void on_scheduler_entry(bool) override { stop_requested_of_thread = &stop_; }
  void on_scheduler_exit(bool) override { stop_requested_of_thread = nullptr; }

 private:
  const std::atomic<bool>& stop_;
};

/// Lets `stop` stop what this thread does, and what others do for it.
class Stoppable {
 public:
  explicit Stoppable(const std::atomic<bool>& stop) : teller_(arena_, stop) {
    stop_requested_of_thread = &stop;
  }
  ~Stoppable() { stop_requested_of_thread = nullptr; }
  Stoppable(const Stoppable&) = delete;
  Stoppable& operator=(const Stoppable&) = delete;

 private:
  tbb::task_arena arena_{tbb::task_arena::attach{}};
  StopTeller teller_;
};

}  // namespace

void run_apart(RunWatch& watch, const py::object& progress, const std::function<void()>& work,
               const std::function<void()>& look) {
  constexpr std::chrono::milliseconds between_looks{50};
  std::exception_ptr failure, stopped;
  std::atomic<bool> stop = false;
  std::mutex mutex;
  std::condition_variable ended;
  bool done = false;
  std::size_t told = 0;
  const auto tell = [&] {
    if (progress.is_none() || watch.pings == told) return;
    told = watch.pings;
    progress(told, watch.total.load());
  };
  const auto look_about = [&] {
    const py::gil_scoped_acquire held;
    try {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      look();
      tell();
    } catch (...) {
      stopped = std::current_exception();
      stop = true;
    }
  };
  {
    const py::gil_scoped_release released;
    std::thread worker([&] {
      // HDF5 tells each thread's errors on stderr by itself; netCDF, which looks for things that may be
      // missing, hushes it in the thread that used it first, which may be Python's.
      H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
      try {
        const Stoppable stoppable(stop);
        work();
      } catch (...) {
        failure = std::current_exception();
      }
      // What HDF5 keeps of them goes with the thread otherwise, and it looks for it as the process ends.
      H5Eclear2(H5E_DEFAULT);
      const std::scoped_lock lock(mutex);
      done = true;
      ended.notify_one();
    });
    std::unique_lock lock(mutex);
    while (!ended.wait_for(lock, between_looks, [&] { return done; })) {
      lock.unlock();
      if (!stopped) look_about();
      lock.lock();
    }
    lock.unlock();
    worker.join();
  }
  if (stopped) std::rethrow_exception(stopped);
  look();
  if (failure) std::rethrow_exception(failure);
  tell();
}

}  // namespace tubefoot::python
