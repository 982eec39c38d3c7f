// SPDX-License-Identifier: GPL-3.0-or-later
// Repeats the findings of fuzzing for files that tubefoot resumes from (validation/fuzzing.md), minimised.
// The test names state the findings.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "files/usage_error.hpp"
#include "fixtures/program.hpp"
#include "run/partial_run.hpp"

namespace tubefoot {
namespace {

using nlohmann::ordered_json;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(FuzzedKeptRuns, KeptRunThatSaysNothingOfItselfIsInTheWay) {
  const TestFolder folder;
  StoreLayout layout;
  layout.sensors = {{2, {{"energy", 3}}}};
  layout.groups = {{{0}, 2}};
  {
    PingStore store(layout, std::make_unique<PingFile>(folder / "results.partial"), "{");
    PingValues silent;
    silent.clear(layout, 0);
    store.finish(0, 1, {}, silent);
  }
  for (const bool resume : {true, false})
    EXPECT_THAT([&] { PartialRun(folder / "results", resume); },
                ThrowsMessage<UsageError>(
                    AllOf(HasSubstr("results.partial' is damaged"), HasSubstr("move or delete it"))));
}

TEST(FuzzedKeptRuns, KeptRunOfOtherWordsIsRefused) {
  const ordered_json requested{{"scene_hash", "12"}};
  const ordered_json good{{"asked", requested}, {"run", json_of(RunRequest())}};
  EXPECT_EQ(resumed(good, requested, {}).visibility.arithmetic, Arithmetic::fixed);
  ordered_json without_seed = good, odd_seed = good, odd_word = good, without_requested = good;
  without_seed["run"].erase("seed");
  odd_seed["run"]["seed"] = "\xff";
  odd_word["run"]["binning"] = "fast";
  without_requested.erase("asked");
  for (const ordered_json& kept :
       {without_seed, odd_seed, odd_word, without_requested, ordered_json(7), ordered_json()})
    EXPECT_THAT(
        [&] { resumed(kept, requested, {}); },
        ThrowsMessage<UsageError>(AllOf(HasSubstr("is damaged"), HasSubstr("delete the .partial file"))));
}

}  // namespace
}  // namespace tubefoot
