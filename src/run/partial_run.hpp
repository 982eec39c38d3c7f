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

/// Returns the path of a file next to a run's result: the result's name with `suffix` appended.
std::filesystem::path beside(const std::filesystem::path& output, const std::string& suffix);

/// Runs a piece of the work of a run that stores its pings. If an interruption or an error stops the work,
/// the message also contains `advice`.
void keep_through(const std::function<std::string()>& advice, const std::function<void()>& work);

/// Words of the messages about a stored run: the name of the run, and the remedy if its request differs.
struct CheckpointMessages {
  std::string run = "the run that --resume would continue";
  std::string anew = "delete the .partial file to start again";
};

/// The checkpoint of a run: the file '<output>.partial' with the finished pings. The file stays if the run
/// is interrupted or killed, and a later run continues it.
class PartialRun {
 public:
  /// Opens the file if it exists. Throws UsageError for finished pings without `resume`, for a file of
  /// another kind, and for a file that another run is writing.
  PartialRun(const std::filesystem::path& output, bool resume);
  /// Removes the file if no ping was finished.
  ~PartialRun();
  PartialRun(const PartialRun&) = delete;
  PartialRun& operator=(const PartialRun&) = delete;

  /// Returns the identity that the continued run passed to open(); empty if there is no such run.
  const std::optional<nlohmann::ordered_json>& kept() const;
  /// Continues the file or creates a new one.
  std::shared_ptr<PingStore> open(const StoreLayout& layout, const nlohmann::ordered_json& identity);
  /// Returns the advice for a run that stopped. The pings that the advice counts are on the disk.
  std::string advice() const;
  /// Runs a piece of the work. An interruption is reported together with advice().
  template <typename Work>
  auto unless_interrupted(const Work& work) const {
    try {
      return work();
    } catch (const Interrupted&) {
      throw std::runtime_error("interrupted: " + advice());
    }
  }
  /// Runs a piece of the work. An interruption or an error is reported together with advice().
  void keep_through(const std::function<void()>& work) const {
    tubefoot::keep_through([this] { return advice(); }, work);
  }
  /// Removes the file, when the result is complete.
  void remove();

 private:
  std::filesystem::path file_;
  std::unique_ptr<PingFile> taken_;  ///< the file until open() is called, so that no other run can open it
  std::unique_ptr<const std::optional<nlohmann::ordered_json>> kept_;
  std::shared_ptr<PingStore> store_;
  std::size_t units_ = 0, kept_done_ = 0;
};

/// Throws UsageError naming the first entry in which the request of a stored run differs from this request.
void refuse_other_request(const nlohmann::ordered_json& kept, const nlohmann::ordered_json& requested,
                          const CheckpointMessages& words = {});

/// Returns the settings of a stored run if its request equals this one. Throws UsageError naming the first
/// entry that differs, or reporting that the stored identity is damaged.
RunRequest resumed(const nlohmann::ordered_json& kept, const nlohmann::ordered_json& requested,
                   RunRequest otherwise);

}  // namespace tubefoot
