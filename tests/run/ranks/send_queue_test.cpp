// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the send queue of a worker process: results that wait for a slow rank 0 take no more memory than
// their limit.
#include "run/ranks/send_queue.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <deque>
#include <nlohmann/json.hpp>
#include <thread>

#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"
#include "run/partial_run.hpp"
#include "run/ranks/ping_workers.hpp"
#include "run/ranks/rank_notes.hpp"
#include "run/ranks/run_ranks.hpp"
#include "run/run_steps.hpp"
#include "run/settings.hpp"

namespace tubefoot {
namespace {

TEST(ASendQueue, HasThreadsWaitForRoom) {
  SendQueue send_queue(10);
  send_queue.put("0123456789");
  std::atomic<bool> put{false};
  std::thread thread([&] {
    send_queue.put("more");
    put = true;
  });
  // The message is taken from the queue, but still in the link.
  EXPECT_EQ(send_queue.take(0).size(), 1u);
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_FALSE(put);
  EXPECT_TRUE(send_queue.take(10).empty());
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_FALSE(put);
  send_queue.take(9);
  thread.join();
  EXPECT_EQ(send_queue.take(9), std::vector<std::string>{"more"});
}

TEST(ASendQueue, LetsGoWhoWaitsOnceItIsOpen) {
  SendQueue send_queue(1);
  send_queue.put("full");
  std::thread thread([&] { send_queue.put("more"); });
  send_queue.open();
  thread.join();
  EXPECT_EQ(send_queue.take(0).size(), 2u);
}

/// Rank 0, as seen by a worker. It takes nothing before the worker has stopped sending.
class SlowLead : public RankLink {
 public:
  /// Results of the test, because the link itself ends with the worker.
  struct Figures {
    std::size_t most_unsent = 0, taken = 0, taken_bytes = 0;
    std::string failure;
    bool left = false;
  };
  SlowLead(std::deque<std::string> notes, Figures& figures) : notes_(std::move(notes)), figures_(figures) {}
  int rank() const override { return 1; }
  int ranks() const override { return 2; }
  int local_ranks() const override { return 2; }
  std::string host() const override { return "here"; }
  void send(int, std::string bytes) override {
    if (note_of(bytes) == Note::failed) figures_.failure = bytes;
    unsent_ += bytes.size();
    figures_.most_unsent = std::max(figures_.most_unsent, unsent_);
    queue_.push_back(std::move(bytes));
    last_sent_ = std::chrono::steady_clock::now();
  }
  std::optional<RankMessage> receive() override {
    if (std::chrono::steady_clock::now() - last_sent_ > std::chrono::milliseconds(300))
      while (!queue_.empty()) take();
    if (notes_.empty()) return std::nullopt;
    RankMessage message{0, notes_.front()};
    notes_.pop_front();
    return message;
  }
  std::size_t unsent() const override { return unsent_; }
  bool moving() const override { return !queue_.empty(); }
  void leave() override { figures_.left = true; }

 private:
  void take() {
    const std::string& bytes = queue_.front();
    unsent_ -= bytes.size();
    if (note_of(bytes) == Note::result) ++figures_.taken, figures_.taken_bytes += bytes.size();
    if (note_of(bytes) == Note::done || note_of(bytes) == Note::failed) notes_.push_back(note(Note::stop));
    queue_.pop_front();
  }

  std::deque<std::string> notes_, queue_;
  Figures& figures_;
  std::size_t unsent_ = 0;
  std::chrono::steady_clock::time_point last_sent_;
};

TEST(AHelper, DoesNotRunAheadOfItsLink) {
  constexpr std::size_t pings = 60, cells = 2 * 65536;
  constexpr std::size_t mebibyte = std::size_t{1} << 20;
  TestFolder folder;
  RunOptions options;
  options.scene =
      folder.write("scene.toml", lambert_material("sand", -27) + flat_terrain(20, 30) + fixed_at(0, 0, 2) +
                                     replaced(short_pings(pings), "samples = 40", "samples = 65536"));
  options.engine = "ray";
  options.rays = 100000;  // enough rays to fill the range bins, so that packed pings stay long
  options.threads = 2;
  SceneDescription description = described(options);
  const RunRequest request = requested(options, description);
  const nlohmann::ordered_json start{{"asked", request_json(description, request)},
                                     {"run", json_of(request)}};
  std::vector<PingUnit> all;
  for (std::size_t ping = 0; ping < pings; ++ping) all.push_back({0, ping});
  SlowLead::Figures figures;
  EXPECT_EQ(
      help_run(options, std::make_unique<SlowLead>(std::deque<std::string>{note(Note::start, start.dump()),
                                                                           pings_note(all), pings_note({})},
                                                   figures)),
      0);
  EXPECT_EQ(figures.failure, "");
  EXPECT_TRUE(figures.left);
  EXPECT_EQ(figures.taken, pings);
  // 8 MiB, and one result per thread.
  constexpr std::size_t may_wait = 8 * mebibyte + 2 * (cells * sizeof(double) + 4096);
  EXPECT_GT(figures.taken_bytes, may_wait + 2 * mebibyte);
  EXPECT_LE(figures.most_unsent, may_wait);
}

}  // namespace
}  // namespace tubefoot
