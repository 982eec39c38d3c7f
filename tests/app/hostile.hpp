// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "app/program.hpp"
#include "app/small_scene.hpp"

namespace tubefoot {

/// Input that wants to do harm: the program is run on it with little memory and a small stack.
struct Hostile : testing::Test {
  TestFolder folder;
  Hostile() { folder.write("thing.obj", tetrahedron); }

  static Outcome run(const std::vector<std::string>& words) {
    Surroundings meagre;
#ifndef TUBEFOOT_SANITIZED  // sanitizers set aside terabytes of addresses, and fill stacks
    meagre.largest_memory_bytes = std::size_t{1500} << 20;
    meagre.stack_bytes = std::size_t{1} << 20;
#endif
    return run_program(words, meagre);
  }

  Outcome check(const std::string& scene) const {
    return run({"check", folder.write("scene.toml", scene).string()});
  }

  /// Ended of itself, with little memory taken.
  static void expect_harmless(const Outcome& outcome, double most_mb = 500) {
    EXPECT_EQ(outcome.signal, 0) << outcome.err;
#ifdef TUBEFOOT_SANITIZED
    most_mb = 3 * most_mb + 500;  // of shadows, and of what was freed but is kept to be watched
#endif
    EXPECT_LT(outcome.peak_memory_mb, most_mb);
    EXPECT_LT(outcome.err.size(), 5000u);
  }

  /// Refused as wrong input, in words that hold all of `parts`.
  void expect_refused(const std::string& scene, const std::vector<std::string>& parts,
                      double most_mb = 500) const {
    const Outcome outcome = check(scene);
    expect_harmless(outcome, most_mb);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    for (const std::string& part : parts) EXPECT_THAT(outcome.err, testing::HasSubstr(part));
  }
};

}  // namespace tubefoot
