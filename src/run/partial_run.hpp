// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <stdexcept>
#include <string>

#include "geometry/steps/stop.hpp"
#include "run/checkpoint/ping_store.hpp"
#include "run/run_request.hpp"

namespace tubefoot {

/// A file beside a run's result, under the result's name and `suffix`.
std::filesystem::path beside(const std::filesystem::path& output, const std::string& suffix);

/// Does a piece of the work of a run that keeps its pings; who stops it, or what stops it, is reported
/// together with `advice`.
void keep_through(const std::function<std::string()>& advice, const std::function<void()>& work);

/// How to speak of a run whose pings are kept, and of what to do where they are not what is asked for.
struct CheckpointMessages {
  std::string run = "the run that --resume would go on with";
  std::string anew = "delete the .partial file to begin anew";
};

/// The pings of a run on their way to a result: the file '<output>.partial', which stays when the run is
/// interrupted or killed, and which a later run goes on with.
class PartialRun {
 public:
  /// Looks at what is there. Throws UsageError if it is in the way: finished pings without `resume`, a file
  /// of something else, one that another run is writing.
  PartialRun(const std::filesystem::path& output, bool resume);
  /// Takes the file away if no ping was finished.
  ~PartialRun();
  PartialRun(const PartialRun&) = delete;
  PartialRun& operator=(const PartialRun&) = delete;

  /// What the run that is gone on with said of itself in open(); nothing if there is none.
  const std::optional<nlohmann::ordered_json>& kept() const;
  /// Goes on with the file or makes a new one.
  std::shared_ptr<PingStore> open(const StoreLayout& layout, const nlohmann::ordered_json& identity);
  /// What to tell somebody whose run stopped. What it says is kept is on the disk.
  std::string advice() const;
  /// Does a part of the run; who stops it is reported advice().
  template <typename Work>
  auto unless_interrupted(const Work& work) const {
    try {
      return work();
    } catch (const Interrupted&) {
      throw std::runtime_error("interrupted: " + advice());
    }
  }
  /// The same, and what stops it is reported together with advice().
  void keep_through(const std::function<void()>& work) const {
    tubefoot::keep_through([this] { return advice(); }, work);
  }
  /// Takes the file away: the result is complete.
  void remove();

 private:
  std::filesystem::path file_;
  Descriptor taken_;  ///< the file that was there, until open(): no other run gets it
  std::unique_ptr<const std::optional<nlohmann::ordered_json>> kept_;
  std::shared_ptr<PingStore> store_;
  std::size_t units_ = 0, kept_done_ = 0;
};

/// Throws UsageError naming the first thing that differs between what a kept run was asked and what this one
/// is.
void refuse_other_request(const nlohmann::ordered_json& kept, const nlohmann::ordered_json& requested,
                          const CheckpointMessages& words = {});

/// The settings of a kept run, if it was asked what this one is. Throws UsageError naming the first thing
/// that differs, or saying that what was kept is damaged.
RunRequest resumed(const nlohmann::ordered_json& kept, const nlohmann::ordered_json& requested,
                   RunRequest otherwise);

}  // namespace tubefoot
