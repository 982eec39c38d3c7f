// SPDX-License-Identifier: GPL-3.0-or-later
// Runs work on a separate thread while the calling thread of Python handles signals, progress and warnings.
// A stop request reaches all threads that take part in the work.
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

/// Passes a stop flag on to every thread that enters an arena.
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

/// Makes the work of this thread, and of threads that help it, stop on request of `stop`.
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
      // HDF5 prints errors of each thread on stderr by default. The library netCDF probes for optional
      // objects and disables these messages. It does so only in the thread that used it first, which may
      // belong to Python.
      H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
      try {
        const Stoppable stoppable(stop);
        work();
      } catch (...) {
        failure = std::current_exception();
      }
      // Clears the errors that HDF5 stores for this thread. Otherwise they are freed with the thread, and
      // HDF5 accesses them at the end of the process.
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
