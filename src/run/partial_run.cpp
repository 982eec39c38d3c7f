// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/partial_run.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string_view>

#include "files/absolute_path.hpp"
#include "files/durable.hpp"
#include "files/input_error.hpp"
#include "files/usage_error.hpp"
#include "geometry/steps/stop.hpp"
#include "run/checkpoint/build_identity.hpp"
#include "run/console/exhausted.hpp"

// This file implements the checkpoint of a run: the file '<output>.partial' next to the result. It compares
// the stored request with the current one before it continues the file.

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

}  // namespace

fs::path beside(const fs::path& output, const std::string& suffix) {
  std::error_code ignored;
  fs::path file = fs::weakly_canonical(absolute_path(output), ignored);
  if (!file.has_filename()) file = file.parent_path();
  return file += suffix;
}

void refuse_other_request(const Json& kept, const Json& requested, const CheckpointMessages& words) {
  for (const auto& [key, value] : requested.items()) {
    const Json before = kept.contains(key) ? kept.at(key) : Json();
    if (before == value) continue;
    if (key == "build")
      throw UsageError(
          fmt::format("{} was computed by another build of tubefoot ({}), whose energies can differ: "
                      "continue with that build, or {}",
                      words.run, difference_of_builds(before, value), words.anew));
    if (key == "scene_hash")
      throw UsageError(
          fmt::format("the scene, or a file that it names, has changed since {}: restore it, or {}",
                      words.run, words.anew));
    if (value.is_object() && before.is_object()) refuse_other_request(before, value, words);
    throw UsageError(fmt::format("{} had {} = {}, not {}: use the same value, or {}", words.run, key,
                                 before.dump(), value.dump(), words.anew));
  }
}

void keep_through(const std::function<std::string()>& advice, const std::function<void()>& work) {
  try {
    work();
  } catch (const Interrupted&) {
    throw std::runtime_error("interrupted: " + advice());
  } catch (const std::exception& error) {
    if (dynamic_cast<const InputError*>(&error) != nullptr ||
        dynamic_cast<const UsageError*>(&error) != nullptr ||
        dynamic_cast<const UnusableStore*>(&error) != nullptr)
      throw;
    if (const std::string_view words = exhaustion_in_words(error); !words.empty())
      throw std::runtime_error(fmt::format("{}; {}", words, advice()));
    if (dynamic_cast<const std::runtime_error*>(&error) == nullptr) throw;
    throw std::runtime_error(fmt::format("{}; {}", error.what(), advice()));
  }
}

PartialRun::PartialRun(const fs::path& output, bool resume)
    : file_(beside(output, ".partial")), kept_(std::make_unique<std::optional<Json>>()) {
  std::optional<Json> identity;
  const auto in_the_way = [](const std::string& what) {
    return UsageError(
        fmt::format("{}: move or delete it, because this path is needed for the pings of the run", what));
  };
  try {
    taken_ = std::make_unique<PingFile>(file_);
    kept_done_ = taken_->pings();
    if (kept_done_ > 0) {
      identity = Json::parse(taken_->identity());
      units_ = identity->at("pings").get<std::size_t>();
    } else {
      taken_->forget();
    }
  } catch (const Json::exception&) {
    throw in_the_way(fmt::format("'{}' is damaged", file_.string()));
  } catch (const StoreInUse& error) {
    throw UsageError(error.what());
  } catch (const UnusableStore& error) {
    throw in_the_way(error.what());
  }
  if (kept_done_ == 0) return;
  if (!resume)
    throw UsageError(
        fmt::format("'{}' contains {} of {} pings of an unfinished run: add --resume to continue, or delete "
                    "it to start again",
                    file_.string(), kept_done_, units_));
  kept_ = std::make_unique<std::optional<Json>>(std::move(identity));
}

PartialRun::~PartialRun() {
  std::error_code ignored;
  if (store_ && store_->done_units() == 0) fs::remove(file_, ignored);
}

const std::optional<Json>& PartialRun::kept() const { return *kept_; }

std::shared_ptr<PingStore> PartialRun::open(const StoreLayout& layout, const Json& identity) {
  units_ = layout.units();
  Json described = identity;
  described["pings"] = units_;
  try {
    keep_through([&] { store_ = std::make_shared<PingStore>(layout, std::move(taken_), described.dump()); });
  } catch (const StoreInUse& error) {
    throw UsageError(error.what());
  } catch (const UnusableStore& error) {
    throw UsageError(fmt::format("{}: delete it to start again", error.what()));
  }
  return store_;
}

std::string PartialRun::advice() const {
  const std::size_t done = store_ ? store_->done_units() : kept_done_;
  if (done == 0)
    return stop_wanted()
               ? "nothing was written"
               : "nothing was written: correct this, or choose another -o, and run the command again";
  std::string ambiguous;
  try {
    if (store_) store_->sync();
  } catch (const std::runtime_error& error) {
    ambiguous = fmt::format(" (not on the disk yet: {})", error.what());
  }
  return fmt::format("{} of {} pings are stored in '{}'{}: run the same command with --resume to continue",
                     done, units_, file_.string(), ambiguous);
}

void PartialRun::remove() {
  fs::remove(file_);  // before another run can obtain the lock
  store_.reset();
  try {
    // otherwise the file might reappear next to the result after a power failure
    sync_names_in(file_.parent_path());
  } catch (const std::runtime_error&) {  // harmless
  }
}

RunRequest resumed(const Json& kept, const Json& requested, RunRequest otherwise) {
  const auto damaged = [](const std::exception& error) {
    return UsageError(
        fmt::format("the description of the run that --resume would continue is damaged ({}): delete the "
                    ".partial file to start again",
                    error.what()));
  };
  Json run;
  try {
    refuse_other_request(kept.at("asked"), requested);
    run = kept.at("run");
  } catch (const Json::exception& error) {
    throw damaged(error);
  }
  try {
    return request_of(run, std::move(otherwise));
  } catch (const Json::exception& error) {
    throw damaged(error);
  } catch (const UsageError& error) {
    throw damaged(error);
  }
}

}  // namespace tubefoot
