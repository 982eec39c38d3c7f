// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>
#include <type_traits>
#include <utility>

#include "geometry/steps/stop.hpp"

namespace tubefoot {

/// Returns the result of one call into a library that does not check for requests to stop. The call runs on a
/// thread of its own. The waiting thread throws Interrupted as soon as a stop is requested. The call then
/// continues unobserved until its end or the end of the process, so it must own all data that it uses.
template <class Call>
std::invoke_result_t<Call&> long_call(Call call) {
  using Result = std::invoke_result_t<Call&>;
  struct State {
    explicit State(Call its_call) : call(std::move(its_call)) {}
    Call call;
    std::mutex mutex;
    std::condition_variable ended;
    bool over = false;
    std::optional<Result> result;
    std::exception_ptr error;
  };
  stop_if_wanted();
  const auto state = std::make_shared<State>(std::move(call));
  const auto run = [](State& its) {
    std::optional<Result> result;
    std::exception_ptr error;
    try {
      result.emplace(its.call());
    } catch (...) {
      error = std::current_exception();
    }
    const std::lock_guard lock(its.mutex);
    its.result = std::move(result);
    its.error = error;
    its.over = true;
    its.ended.notify_one();
  };
  try {
    std::thread([state, run] { run(*state); }).detach();
  } catch (const std::system_error&) {  // no thread is available
    run(*state);
  }
  constexpr std::chrono::milliseconds between_looks(50);
  std::unique_lock lock(state->mutex);
  while (!state->ended.wait_for(lock, between_looks, [&] { return state->over; })) stop_if_wanted();
  if (state->error) std::rethrow_exception(state->error);
  return std::move(*state->result);
}

}  // namespace tubefoot
