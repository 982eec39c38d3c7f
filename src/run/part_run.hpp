// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "run/checkpoint/part_file.hpp"
#include "run/options.hpp"
#include "run/run_request.hpp"
#include "run/survey.hpp"

// One run in parts that know nothing of each other, and what joins them (docs/cluster.md).
namespace tubefoot {

/// Part `number` of `of`, counted from 1.
struct PartNumber {
  int number = 1, of = 1;
};
inline constexpr int most_parts = 10000;

/// "2/8". Throws UsageError.
PartNumber parse_part(const std::string& text);
/// "part 2 of 8".
std::string in_words(const PartNumber& part);
/// The file of a part: '<output>.part-2-of-8'.
std::filesystem::path part_file(const std::filesystem::path& output, const PartNumber& part);

/// Whose pings are whose: by turns, so that dear and cheap stretches of a survey fall to all; where terrain
/// is read by tiles neighbours stay together, so that no part loads all tiles.
class PartDeal {
 public:
  /// The survey outlives it.
  PartDeal(const Survey& survey, StoreLayout layout, int parts);
  /// The part, counted from 1, that computes a ping.
  int part_of(const PingUnit& unit) const;
  std::vector<PingUnit> units_of(int part) const;
  const StoreLayout& layout() const { return layout_; }
  /// "ping 7 of 'camera', 'sidescan'".
  std::string in_words(const PingUnit& unit) const;

 private:
  const Survey& survey_;
  StoreLayout layout_;
  std::size_t parts_;
  std::vector<std::size_t> first_unit_;  ///< by group
};

/// A part of a run, on its way into its file.
class RunPart {
 public:
  /// Takes the file, or makes it. `scene_request`: of request_json(); `options`: the words that asked for it.
  /// Throws UsageError if something is in the way: finished pings without `options.resume`, pings of another
  /// run, a file of something else, one that another process is writing.
  RunPart(const RunOptions& options, const nlohmann::ordered_json& scene_request);
  /// Takes the file away if no ping was finished.
  ~RunPart();
  RunPart(const RunPart&) = delete;
  RunPart& operator=(const RunPart&) = delete;

  /// Computes the pings that are not there yet. Throws Interrupted when somebody wants to stop.
  void compute(const Survey& survey, const RunRequest& request);
  /// What to tell somebody whose part stopped. What it says is kept is on the disk.
  std::string advice() const;
  const std::filesystem::path& path() const { return file_.path(); }
  std::size_t pings() const { return pings_; }
  std::uint64_t bytes() const { return file_.bytes(); }

 private:
  bool quiet_;
  PartNumber part_;
  PartFile file_;
  std::size_t pings_ = 0;                 ///< that fall to it
  std::atomic<std::size_t> done_{0};      ///< of these
  bool complete_ = false, kept_ = false;  ///< kept: of a run before
};

/// All parts of a run, to be joined.
class RunParts {
 public:
  /// Finds them beside an output. Throws UsageError: there are none, or of two runs, or some are missing.
  explicit RunParts(const std::filesystem::path& output);

  int count() const { return count_; }
  /// What the first part was asked for, in place of what `options` say of it.
  RunOptions options_of_run(RunOptions options) const;
  /// Throws UsageError naming the first part that was asked for something else.
  void require(const nlohmann::ordered_json& scene_request) const;
  /// Throws UsageError naming the parts that have not all of their pings, and those that are damaged.
  void require_whole(const PartDeal& deal) const;
  /// Puts all pings where they belong. Throws UsageError for one that is damaged, and Interrupted.
  void hand_over(const PartDeal& deal, PingStore& store, bool quiet) const;
  /// Takes the files away.
  void remove() const;

 private:
  /// Throws UsageError, also while somebody computes it.
  std::unique_ptr<PartFile> opened(int number) const;
  std::filesystem::path path_of(int number) const;

  std::filesystem::path output_;
  int count_ = 0;
};

}  // namespace tubefoot
