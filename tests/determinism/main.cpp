// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/core.h>

#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include "geometry/visibility/closure.hpp"
#include "geometry/visibility/visibility.hpp"
#include "prove/small_scenes.hpp"

// Prints the topology hash of fixed scenes, with one thread and with four, and compares it with the known
// hash. The scenes come from integers alone, so that they are the same on each build platform.
namespace {

using namespace tubefoot;

constexpr std::uint64_t seed = 3;

/// Computes all tubes of a scene, distributed over `threads` threads.
TopologyHash hash_of(const prove::SmallScene& scene, std::uint64_t label, Arithmetic arithmetic,
                     std::uint32_t threads) {
  const SceneTree tree(scene.mesh);
  std::vector<TopologyHash> sums(threads);
  const auto count = static_cast<std::uint32_t>(scene.tubes.tubes.size());
  const auto work = [&](std::uint32_t thread) {
    VisibilityOptions options;
    options.arithmetic = arithmetic;
    options.open_water = true;
    VisibilityScratch scratch;
    TubeVisibility seen;
    for (std::uint32_t t = thread; t < count; t += threads) {
      see(scene.mesh, tree, scene.tubes, t, options, scratch, seen);
      sums[thread] += audit(scene.mesh, scene.tubes, t, seen, label + t).hash;
    }
  };
  std::vector<std::thread> pool;
  for (std::uint32_t k = 0; k < threads; ++k) pool.emplace_back(work, k);
  for (std::thread& thread : pool) thread.join();
  TopologyHash total;
  for (const TopologyHash& sum : sums) total += sum;
  return total;
}

std::string report(Arithmetic arithmetic, std::uint32_t threads) {
  TopologyHash small;
  for (std::uint64_t k = 0; k < 24 * prove::generator_names.size(); ++k)
    small += hash_of(prove::make_scene(seed, k), k * prove::tubes_per_scene, arithmetic, threads);
  const TopologyHash large = hash_of(prove::make_large_scene(seed, 24), 0, arithmetic, threads);
  return fmt::format("small scenes {}\nlarge scene {}\n", small.hex(), large.hex());
}

}  // namespace

int main(int argc, char** argv) {
  std::ifstream file(argc == 2 ? argv[1] : "");
  if (!file) {
    fmt::print(stderr, "usage: tubefoot_determinism FILE_OF_KNOWN_HASHES\n");
    return 2;
  }
  const std::string known{std::istreambuf_iterator<char>(file), {}};
  bool same = true;
  for (const Arithmetic arithmetic : {Arithmetic::fixed, Arithmetic::filtered})
    for (const std::uint32_t threads : {1u, 4u}) {
      const std::string found = report(arithmetic, threads);
      const bool equal = found == known;
      same = same && equal;
      fmt::print("{}, {} thread{}: {}\n{}", name_of(arithmetic), threads, threads == 1 ? "" : "s",
                 equal ? "as known" : "NOT as known", found);
    }
  return same ? 0 : 1;
}
