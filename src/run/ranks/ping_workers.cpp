// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/ranks/ping_workers.hpp"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

#include "geometry/steps/stop.hpp"

// This file implements the threads of a rank that simulate pings. The size of their stock follows from the
// average duration of a ping.

namespace tubefoot {
namespace {

using Clock = std::chrono::steady_clock;

// Work in stock, in seconds. It is much longer than a request and its answer take, and much shorter than a
// noticeable wait at the end of a run.
constexpr double ahead_s = 0.1;
constexpr std::size_t most_ahead = 1000;

}  // namespace

PingWorkers::PingWorkers(int threads, std::function<void(const PingUnit&)> run)
    : threads_(threads), run_(std::move(run)), thread_([this] { work(); }) {}

PingWorkers::~PingWorkers() {
  stop();
  if (thread_.joinable()) thread_.join();
}

std::size_t PingWorkers::wanted() const {
  const std::lock_guard lock(mutex_);
  if (closed_) return 0;
  std::size_t ahead = 0;
  if (done_pings_ > 0) {
    const double each = std::chrono::duration<double>(Clock::now() - *begun_).count() / double(done_pings_);
    ahead = each * double(most_ahead) < ahead_s ? most_ahead : static_cast<std::size_t>(ahead_s / each);
  }
  return stock_.size() < idle_ + ahead ? idle_ + 2 * ahead - stock_.size() : 0;
}

void PingWorkers::add(std::span<const PingUnit> units) {
  const std::lock_guard lock(mutex_);
  stock_.insert(stock_.end(), units.begin(), units.end());
  if (!begun_) begun_ = Clock::now();
  stocked_.notify_all();
}

void PingWorkers::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  stocked_.notify_all();
}

void PingWorkers::stop() {
  const std::lock_guard lock(mutex_);
  stock_.clear();
  closed_ = true;
  stocked_.notify_all();
}

std::optional<PingUnit> PingWorkers::take() {
  std::unique_lock lock(mutex_);
  ++idle_;
  stocked_.wait(lock, [this] { return closed_ || !stock_.empty(); });
  --idle_;
  if (stock_.empty()) return std::nullopt;
  const PingUnit unit = stock_.front();
  stock_.pop_front();
  return unit;
}

void PingWorkers::work() {
  const auto take_turns = [this](int) {
    while (const std::optional<PingUnit> unit = take()) {
      try {
        // A thread that waits for parts of its ping must not start another ping. Its own ping would then
        // wait until the end of the run.
        tbb::this_task_arena::isolate([&] { run_(*unit); });
      } catch (const Interrupted&) {
        stop();
        return;
      } catch (...) {
        {
          const std::lock_guard lock(mutex_);
          if (!error_) error_ = std::current_exception();
        }
        failed_ = true;
        stop();
      }
      const std::lock_guard lock(mutex_);
      ++done_pings_;
      news_ = true;
      done_.notify_all();
    }
  };
  tbb::parallel_for(0, threads_, take_turns, tbb::simple_partitioner());
  finished_ = true;
}

void PingWorkers::join() {
  if (thread_.joinable()) thread_.join();
  if (error_) std::rethrow_exception(error_);
}

void PingWorkers::rest(std::chrono::microseconds longest) {
  std::unique_lock lock(mutex_);
  done_.wait_for(lock, longest, [this] { return news_; });
  news_ = false;
}

}  // namespace tubefoot
