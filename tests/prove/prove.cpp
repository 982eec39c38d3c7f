// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <fstream>
#include <mutex>
#include <numeric>
#include <thread>
#include <vector>

#include "prove/laws.hpp"

// Checks the laws on a chosen number of tubes: `make prove`. The laws are in docs/notes/visibility.md,
// 'Laws'. It prints one line per law and kind of scene.
namespace {

using namespace tubefoot::prove;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Checks scenes 0..count-1 with `threads` threads. The assignment of scenes to threads does not matter,
/// because ledgers add up.
Ledger prove(std::uint64_t seed, std::uint64_t count, int threads) {
  constexpr std::uint64_t batch = 64;
  std::atomic<std::uint64_t> next{0};
  std::mutex mutex;
  Ledger total;
  std::uint64_t done = 0, announced = 0;
  const Clock::time_point start = Clock::now();
  const auto work = [&] {
    Prover prover;
    for (;;) {
      const std::uint64_t begin = next.fetch_add(batch), end = std::min(begin + batch, count);
      if (begin >= count) return;
      Ledger ledger;
      for (std::uint64_t scene = begin; scene < end; ++scene) prover.check(seed, scene, ledger);
      const std::lock_guard lock(mutex);
      total.add(ledger);
      done += end - begin;
      if (const std::uint64_t twentieth = done * 20 / count; twentieth > announced) {
        announced = twentieth;
        const double elapsed = seconds_since(start),
                     share = static_cast<double>(done) / static_cast<double>(count);
        fmt::print(stderr, "{:3d} %  {} tubes, {} failures, {:.0f} s, {:.0f} s to go\n", 5 * twentieth,
                   done * tubes_per_scene, total.failures(), elapsed, elapsed * (1 / share - 1));
      }
    }
  };
  std::vector<std::thread> pool;
  for (int k = 0; k < threads; ++k) pool.emplace_back(work);
  for (std::thread& thread : pool) thread.join();
  return total;
}

std::uint64_t sum(const auto& numbers) {
  return std::accumulate(numbers.begin(), numbers.end(), std::uint64_t{0});
}

std::string table(const Ledger& ledger) {
  std::string text = "| kind of scene | facets seen by a tube |";
  for (const auto& law : law_names) text += fmt::format(" {} |", law);
  text += " failures |\n|---|---:|";
  for (std::size_t l = 0; l <= law_names.size(); ++l) text += "---:|";
  const auto row = [&](std::string_view name, std::uint64_t facets, const auto& entry_of) {
    text += fmt::format(
        "\n| {} | {:.2f} |", name,
        static_cast<double>(facets) / static_cast<double>(std::max<std::uint64_t>(1, entry_of(0).tubes)));
    std::uint64_t failures = 0;
    for (std::size_t l = 0; l < law_names.size(); ++l) {
      const Ledger::Entry entry = entry_of(l);
      text += fmt::format(" {} |", entry.tubes);
      failures += entry.failures;
    }
    text += fmt::format(" {} |", failures);
  };
  for (std::size_t g = 0; g < generator_names.size(); ++g)
    row(generator_names[g], ledger.facets_seen[g], [&](std::size_t l) { return ledger.entries[l][g]; });
  row("**all**", sum(ledger.facets_seen), [&](std::size_t l) { return ledger.total(static_cast<Law>(l)); });
  return text + "\n";
}

/// One line for each law and kind of scene that failed, with the options that reproduce the failure.
std::string failures(const Ledger& ledger, std::uint64_t seed) {
  std::string text;
  for (std::size_t l = 0; l < law_names.size(); ++l)
    for (std::size_t g = 0; g < generator_names.size(); ++g)
      if (const Ledger::Entry& entry = ledger.entries[l][g]; entry.failures > 0)
        text += fmt::format(
            "- {} on {}: {} of {} tubes fail; the first with `tubefoot_prove --seed {} --scene {}`\n",
            law_names[l], generator_names[g], entry.failures, entry.tubes, seed, entry.first_failure);
  return text;
}

std::string report(const Ledger& ledger, std::uint64_t seed, int threads, double seconds) {
  const std::uint64_t tubes = ledger.total(Law::closure).tubes, failed = ledger.failures();
  return fmt::format(
      "# Laws of visibility, checked\n\n"
      "Written by `make prove` (`tests/prove/`). Each number counts tubes on which a law was checked, as an\n"
      "equality of rationals or of signs; every tube is checked for closure, and for the one other law "
      "whose\n"
      "turn it is. What each law says: `tests/prove/laws.hpp`; what each kind of scene is: "
      "`tests/prove/small_scenes.cpp`.\n\n"
      "- tubes: {}, of which {} see a facet\n"
      "- failures: **{}**\n"
      "- seed: {}\n"
      "- topology hash of everything seen: `{}`\n"
      "- time: {:.0f} s with {} thread{}\n\n"
      "{}\n{}",
      tubes, sum(ledger.tubes_with_facets), failed, seed, ledger.hash.hex(), seconds, threads,
      threads == 1 ? "" : "s", table(ledger), failed > 0 ? "\n" + failures(ledger, seed) : "");
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Checks the laws of visibility on seeded random and adversarial scenes, in rationals");
  std::uint64_t tubes = 100'000, seed = 1, scene = Ledger::none;
  int threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  std::string path;
  app.add_option("--tubes", tubes, "How many, at least")->capture_default_str();
  app.add_option("--seed", seed, "Seed of all scenes")->capture_default_str();
  app.add_option("--threads", threads, "How many")->check(CLI::Range(1, 256))->capture_default_str();
  app.add_option("--scene", scene, "Only the scene of this number, and every law on it");
  app.add_option("--report", path, "File for the result, in Markdown");
  CLI11_PARSE(app, argc, argv);

  const Clock::time_point start = Clock::now();
  Ledger ledger;
  if (scene != Ledger::none)
    Prover().check(seed, scene, ledger, true);
  else
    ledger = prove(seed, (tubes + tubes_per_scene - 1) / tubes_per_scene, threads);
  const std::string text = report(ledger, seed, threads, seconds_since(start));
  fmt::print("{}", text);
  if (!path.empty() && !(std::ofstream(path) << text).flush()) {
    fmt::print(stderr, "tubefoot_prove: cannot write '{}'\n", path);
    return 2;
  }
  return ledger.failures() > 0 ? 1 : 0;
}
