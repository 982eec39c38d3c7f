// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "run/checkpoint/ping_store.hpp"
#include "run/options.hpp"
#include "run/run_request.hpp"
#include "run/survey.hpp"

// This header declares the shards of a run (docs/large-jobs.md). Each process computes one shard without
// knowledge of the others, and `RunParts` joins the shards.
namespace tubefoot {

/// Shard `number` of `of`, counted from 1.
struct PartNumber {
  int number = 1, of = 1;
};
inline constexpr int most_parts = 10000;

/// Parses "2/8". Throws UsageError.
PartNumber parse_part(const std::string& text);
/// Returns "shard 2 of 8".
std::string in_words(const PartNumber& part);
/// Returns the file of a shard: '<output>.part-2-of-8'.
std::filesystem::path part_file(const std::filesystem::path& output, const PartNumber& part);

/// Distribution of the pings over the shards. The shards take turns, so that expensive and cheap stretches
/// of a survey are spread over all of them. If terrain is read by tiles, neighbouring pings stay together,
/// so that no shard loads all tiles.
class PartDeal {
 public:
  /// The survey must outlive this object.
  PartDeal(const Survey& survey, StoreLayout layout, int parts);
  /// Returns the shard, counted from 1, that computes a ping.
  int part_of(const PingUnit& unit) const;
  std::vector<PingUnit> units_of(int part) const;
  const StoreLayout& layout() const { return layout_; }
  /// Returns "ping 7 of 'camera', 'sidescan'".
  std::string in_words(const PingUnit& unit) const;

 private:
  const Survey& survey_;
  StoreLayout layout_;
  std::size_t parts_;
};

/// One shard of a run and its file.
class RunPart {
 public:
  /// Opens the file of the shard, or creates it. `scene_request`: the result of request_json(). `options`:
  /// the options of the command line. Throws UsageError for finished pings without `options.resume`, and for
  /// pings of another run. Also throws UsageError for a file of another kind, or one that another process is
  /// writing.
  RunPart(const RunOptions& options, const nlohmann::ordered_json& scene_request);
  /// Removes the file if no ping was finished.
  ~RunPart();
  RunPart(const RunPart&) = delete;
  RunPart& operator=(const RunPart&) = delete;

  /// Computes the pings that the file does not contain yet. Throws Interrupted after a request to stop.
  void compute(const Survey& survey, const RunRequest& request);
  /// Returns the advice for a shard that stopped. The pings that the advice counts are on the disk.
  std::string advice() const;
  const std::filesystem::path& path() const { return file_.path(); }
  std::size_t pings() const { return pings_; }
  std::uint64_t bytes() const { return file_.bytes(); }

 private:
  bool quiet_;
  PartNumber part_;
  PingFile file_;
  std::size_t pings_ = 0;                 ///< number of pings of this shard
  std::atomic<std::size_t> done_{0};      ///< number of these that are done
  bool complete_ = false, kept_ = false;  ///< kept: the file continues an earlier run
};

/// All shards of a run, to be joined.
class RunParts {
 public:
  /// Finds the shards next to an output. Throws UsageError if there are none, if they belong to two runs, or
  /// if some are missing.
  explicit RunParts(const std::filesystem::path& output);

  int count() const { return count_; }
  /// Returns the options of the first shard in place of those parts of `options` that determine the result.
  RunOptions options_of_run(RunOptions options) const;
  /// Throws UsageError naming the first shard that computed another request.
  void require(const nlohmann::ordered_json& scene_request) const;
  /// Throws UsageError naming the shards with missing pings, and the shards that are damaged.
  void require_whole(const PartDeal& deal) const;
  /// Copies all pings into `store`. Throws UsageError for a damaged ping, and Interrupted.
  void hand_over(const PartDeal& deal, PingStore& store, bool quiet) const;
  /// Removes the files of all shards.
  void remove() const;

 private:
  /// Throws UsageError for an unusable file, also while another process computes the shard.
  std::unique_ptr<PingFile> opened(int number) const;
  std::filesystem::path path_of(int number) const;

  std::filesystem::path output_;
  int count_ = 0;
};

}  // namespace tubefoot
