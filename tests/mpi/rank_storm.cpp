// SPDX-License-Identifier: GPL-3.0-or-later
// Program for mpirun: each rank sends to all ranks before any rank receives. It exits with 1 and a message
// if a message is lost, changed or out of order. It hangs if a send waits for a sending rank.
#include <dlfcn.h>
#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "run/ranks/rank_link.hpp"

namespace {

using namespace tubefoot;
namespace fs = std::filesystem;

constexpr std::uint32_t messages = 300;

/// The message number `number` from one rank to another: nothing, a few bytes, or many portions.
std::string text_of(int from, int to, std::uint32_t number) {
  std::mt19937 random(1000 * (10 * static_cast<unsigned>(from) + static_cast<unsigned>(to)) + number);
  std::string text(number % 3 == 0 ? random() % 4 : random() % 6000, '\0');
  for (char& letter : text) letter = static_cast<char>(random());
  return text;
}

int storm(RankLink& link) {
  for (std::uint32_t number = 0; number < messages; ++number)
    for (int to = 0; to < link.ranks(); ++to)
      if (to != link.rank()) link.send(to, text_of(link.rank(), to, number));
  std::vector<std::uint32_t> received(static_cast<std::size_t>(link.ranks()), 0);
  for (std::uint32_t left = messages * static_cast<std::uint32_t>(link.ranks() - 1); left > 0;) {
    const auto message = link.receive();
    if (!message) {
      std::this_thread::sleep_for(link.pause());
      continue;
    }
    const std::uint32_t number = received[static_cast<std::size_t>(message->from)]++;
    if (message->bytes != text_of(message->from, link.rank(), number)) {
      fmt::print("rank {}: message {} of rank {} is another\n", link.rank(), number, message->from);
      std::_Exit(1);
    }
    --left;
  }
  link.leave();
  if (link.rank() == 0) fmt::print("all {} messages a pair arrived\n", messages);
  return 0;
}

/// Reports whether a message of one byte leaves rank 0 before rank 1 requests it.
int hold(RankLink& link, const fs::path& told) {
  if (link.rank() == 0) {
    link.send(1, "?");
    for (int k = 0; k < 100; ++k) {
      link.receive();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    fmt::print("{}\n", link.unsent() > 0 ? "held until it is received" : "left at once");
    std::ofstream(told) << "told\n";
  } else {
    while (!fs::exists(told)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    while (!link.receive()) std::this_thread::sleep_for(link.pause());
  }
  link.leave();
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    fmt::print(stderr, "usage: rank_storm LIBRARY BYTES_A_PORTION [FILE]\n");
    return 2;
  }
  void* library = dlopen(argv[1], RTLD_NOW | RTLD_GLOBAL);
  using Join = RankLink* (*)(std::size_t);
  const auto join =
      library != nullptr ? reinterpret_cast<Join>(dlsym(library, "tubefoot_link_ranks")) : nullptr;
  if (join == nullptr) {
    fmt::print(stderr, "{}\n", dlerror());
    return 2;
  }
  const std::unique_ptr<RankLink> link(join(std::stoul(argv[2])));
  return argc > 3 ? hold(*link, argv[3]) : storm(*link);
}
