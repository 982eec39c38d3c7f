// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/part_run.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "files/absolute_path.hpp"
#include "files/durable.hpp"
#include "files/usage_error.hpp"
#include "geometry/steps/stop.hpp"
#include "run/console/progress.hpp"
#include "run/console/say.hpp"
#include "run/partial_run.hpp"
#include "run/simulation.hpp"

// This file computes one shard of a run into its file, and joins the files of all shards. It checks that all
// shards belong to the same request and are complete (docs/large-jobs.md).

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Parses "2/8" with the separator "/", or "2-of-8" with "-of-". Returns nothing for any other text.
std::optional<PartNumber> part_in(std::string_view text, std::string_view between) {
  const std::size_t at = text.find(between);
  if (at == std::string_view::npos) return std::nullopt;
  PartNumber part;
  const auto read = [](std::string_view word, int& number) {
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    return error == std::errc() && end == word.data() + word.size() && std::to_string(number) == word;
  };
  if (!read(text.substr(0, at), part.number) || !read(text.substr(at + between.size()), part.of) ||
      part.number < 1 || part.number > part.of || part.of > most_parts)
    return std::nullopt;
  return part;
}

std::string file_ending(const PartNumber& part) {
  return fmt::format(".part-{}-of-{}", part.number, part.of);
}

/// Returns "2", "2 and 5", or "2, 3 and 5". A long list ends with the number of further elements.
std::string listed(const std::vector<int>& numbers) {
  constexpr std::size_t most = 10;
  std::string words;
  const std::size_t shown = std::min(most, numbers.size());
  for (std::size_t k = 0; k < shown; ++k)
    words += fmt::format("{}{}", k == 0 ? "" : k + 1 == numbers.size() ? " and " : ", ", numbers[k]);
  if (numbers.size() > shown) words += fmt::format(" and {} more", numbers.size() - shown);
  return words;
}

template <class Value>
void put(Json& json, const char* key, const std::optional<Value>& value) {
  if (value) json[key] = *value;
}

template <class Value>
void take(const Json& json, const char* key, std::optional<Value>& value) {
  value.reset();
  if (json.contains(key)) value = json.at(key).get<Value>();
}

void put(Json& json, const char* key, bool value) { json[key] = value; }
void take(const Json& json, const char* key, bool& value) { value = json.at(key); }

/// Calls `each` with the name and the value of each option that affects the energies of a run, and with the
/// omitted files.
void each_word(auto& options, const auto& each) {
  each("arithmetic", options.arithmetic);
  each("sensor", options.selection.sensor);
  each("pings", options.selection.pings);
  each("beams", options.selection.beams);
  each("engine", options.engine);
  each("binning", options.binning);
  each("sampling", options.sampling);
  each("rays", options.rays);
  each("rays_per_beam", options.rays_per_beam);
  each("seed", options.seed);
  each("tolerance", options.tolerance);
  each("coarsen", options.coarsen);
  each("reference", options.reference);
  each("labels", options.labels);
  each("label_level_db", options.label_level_db);
  each("gradient", options.gradient);
  each("gradient_steps", options.gradient_steps);
  each("without", options.without);
}

Json words_of(const RunOptions& options) {
  Json json = Json::object();
  each_word(options, [&](const char* key, const auto& value) { put(json, key, value); });
  return json;
}

RunOptions options_of(const Json& json, RunOptions options) {
  each_word(options, [&](const char* key, auto& value) { take(json, key, value); });
  return options;
}

UsageError damaged_identity(const fs::path& file) {
  return UsageError(fmt::format("'{}' is damaged: delete it, and compute this shard again", file.string()));
}

}  // namespace

PartNumber parse_part(const std::string& text) {
  if (const std::optional<PartNumber> part = part_in(text, "/")) return *part;
  throw UsageError(
      fmt::format("--shard '{}': expected the number of the shard and the number of shards, for example 1/8 "
                  "to 8/8, with at most {} shards",
                  text, most_parts));
}

std::string in_words(const PartNumber& part) { return fmt::format("shard {} of {}", part.number, part.of); }

fs::path part_file(const fs::path& output, const PartNumber& part) {
  return beside(output, file_ending(part));
}

PartDeal::PartDeal(const Survey& survey, StoreLayout layout, int parts)
    : survey_(survey), layout_(std::move(layout)), parts_(static_cast<std::size_t>(parts)) {}

int PartDeal::part_of(const PingUnit& unit) const {
  const std::size_t part = survey_.loaded_scene->is_tiled()
                               ? unit.ping * parts_ / layout_.groups[unit.group].pings
                               : layout_.number_of(unit) % parts_;
  return static_cast<int>(part) + 1;
}

std::vector<PingUnit> PartDeal::units_of(int part) const {
  std::vector<PingUnit> units;
  for (std::size_t group = 0; group < layout_.groups.size(); ++group)
    for (std::size_t ping = 0; ping < layout_.groups[group].pings; ++ping)
      if (part_of({group, ping}) == part) units.push_back({group, ping});
  return units;
}

std::string PartDeal::in_words(const PingUnit& unit) const {
  std::string names;
  for (const std::size_t s : layout_.groups[unit.group].sensors)
    names += fmt::format("{}'{}'", names.empty() ? "" : ", ", survey_.sensors[s].sensor->description().name);
  return fmt::format("ping {} of {}", unit.ping, names);
}

RunPart::RunPart(const RunOptions& options, const Json& scene_request)
    : quiet_(options.quiet), part_(parse_part(*options.part)), file_([&] {
        const fs::path path = part_file(options.output, part_);
        try {
          return PingFile(path, "shard");
        } catch (const StoreInUse&) {
          throw UsageError(fmt::format("another process is computing {} ('{}'): wait until it is finished",
                                       in_words(part_), path.string()));
        } catch (const UnusableStore& error) {
          throw UsageError(fmt::format("{}: move or delete it, because this path is needed for {}",
                                       error.what(), in_words(part_)));
        }
      }()) {
  kept_ = file_.pings() > 0;
  if (!kept_) file_.forget();
  if (kept_ && !options.resume)
    throw UsageError(fmt::format(
        "'{}' contains finished pings of {}: add --resume to continue, or delete it to start again",
        path().string(), in_words(part_)));
  if (kept_) {
    try {
      refuse_other_request(Json::parse(file_.identity()).at("asked"), scene_request,
                           {"the shard that --resume would continue",
                            fmt::format("delete '{}' to start again", path().string())});
    } catch (const Json::exception&) {
      throw damaged_identity(path());
    }
  }
  const Json identity{
      {"part", part_.number}, {"parts", part_.of}, {"asked", scene_request}, {"options", words_of(options)}};
  if (!kept_) file_.begin(identity.dump());
}

RunPart::~RunPart() {
  std::error_code ignored;
  if (done_ == 0 && !complete_ && !kept_) fs::remove(path(), ignored);
}

void RunPart::compute(const Survey& survey, const RunRequest& request) {
  const PartDeal deal(survey, layout_of(survey, request), part_.of);
  const StoreLayout& layout = deal.layout();
  file_.look_through(layout);
  for (const PingUnit& unit : deal.units_of(part_.number)) {
    ++pings_;
    done_ += file_.has(unit);
  }
  if (done_ > 0 && !quiet_) say("continuing after {} finished pings\n", done_.load());
  file_.begin(file_.identity());
  const PingSimulation simulation(survey, request);
  PingBufferPool spare;
  for_each_ping(
      survey, layout,
      [&](std::size_t group, std::size_t ping) {
        return deal.part_of({group, ping}) == part_.number && !file_.has({group, ping});
      },
      [&](std::size_t group, std::size_t ping) {
        file_.append(spare.with([&](PingValues& values) {
          const PingCounts counts = simulation.run({group, ping}, values);
          return packed_ping(layout, {group, ping}, counts, values);
        }));
        ++done_;
      },
      {quiet_});
  stop_if_wanted();
  file_.sync();
  complete_ = true;
}

std::string RunPart::advice() const {
  if (kept_ && pings_ == 0)
    return fmt::format("'{}' still contains the finished pings of {}: run the same command again",
                       path().string(), in_words(part_));
  if (done_ == 0)
    return stop_wanted()
               ? "nothing was written"
               : "nothing was written: correct this, or choose another -o, and run the command again";
  std::string ambiguous;
  try {
    file_.sync();
  } catch (const std::runtime_error& error) {
    ambiguous = fmt::format(" (not on the disk yet: {})", error.what());
  }
  return fmt::format(
      "{} of {} pings of {} are stored in '{}'{}: run the same command with --resume to continue",
      done_.load(), pings_, in_words(part_), path().string(), ambiguous);
}

RunParts::RunParts(const fs::path& output) : output_(output) {
  const fs::path any = beside(output, ".part-");
  const std::string begin = any.filename().string();
  std::map<int, std::vector<int>> found;  // by number of shards
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(any.parent_path(), ignored)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(begin)) continue;
    if (const auto part = part_in(std::string_view(name).substr(begin.size()), "-of-"))
      found[part->of].push_back(part->number);
  }
  if (found.empty())
    throw UsageError(
        fmt::format("there are no shards for '{}' ('{}1-of-...'): compute them first (tubefoot run SCENE -o "
                    "{} --shard 1/8)",
                    output.string(), any.string(), output.string()));
  if (found.size() > 1)
    throw UsageError(
        fmt::format("there are shards of a run with {} shards and of a run with {} shards for '{}': delete "
                    "the shards of one of the runs",
                    found.begin()->first, found.rbegin()->first, output.string()));
  count_ = found.begin()->first;
  std::vector<int>& there = found.begin()->second;
  std::sort(there.begin(), there.end());
  std::vector<int> missing;
  for (int number = 1; number <= count_; ++number)
    if (!std::binary_search(there.begin(), there.end(), number)) missing.push_back(number);
  if (!missing.empty())
    throw UsageError(fmt::format("of {} shards, {} {} missing (no '{}'): compute {} with --shard {}/{}{}",
                                 count_, listed(missing), missing.size() == 1 ? "is" : "are",
                                 path_of(missing[0]).string(), missing.size() == 1 ? "it" : "them",
                                 missing[0], count_, missing.size() == 1 ? "" : " and so on"));
}

fs::path RunParts::path_of(int number) const { return part_file(output_, {number, count_}); }

std::unique_ptr<PingFile> RunParts::opened(int number) const {
  const PartNumber part{number, count_};
  const fs::path path = path_of(number);
  try {
    auto file = std::make_unique<PingFile>(path, "shard");
    if (file->identity().empty())
      throw UsageError(fmt::format("{} has no pings yet ('{}'): compute it with --shard {}/{}",
                                   in_words(part), path.string(), number, count_));
    return file;
  } catch (const StoreInUse&) {
    throw UsageError(fmt::format("another process is computing {} ('{}'): wait until it is finished",
                                 in_words(part), path.string()));
  } catch (const UnusableStore& error) {
    throw UsageError(
        fmt::format("{}: delete it, and compute it again with --shard {}/{}", error.what(), number, count_));
  }
}

RunOptions RunParts::options_of_run(RunOptions options) const {
  const std::unique_ptr<PingFile> first = opened(1);
  try {
    const std::optional<std::string> without = options.without;
    options = options_of(Json::parse(first->identity()).at("options"), std::move(options));
    if (without) options.without = without;
    return options;
  } catch (const Json::exception&) {
    throw damaged_identity(first->path());
  }
}

void RunParts::require(const Json& scene_request) const {
  for (int number = 1; number <= count_; ++number) {
    const std::unique_ptr<PingFile> file = opened(number);
    const std::string part = fmt::format("{} ('{}')", in_words({number, count_}), file->path().string());
    try {
      const Json identity = Json::parse(file->identity());
      if (identity.at("part") != number || identity.at("parts") != count_)
        throw UsageError(fmt::format("{} contains shard {} of {}: restore its original name", part,
                                     identity.at("part").dump(), identity.at("parts").dump()));
      refuse_other_request(
          identity.at("asked"), scene_request,
          {part, fmt::format("delete the shards with other options, and compute them again (--shard {}/{})",
                             number, count_)});
    } catch (const Json::exception&) {
      throw damaged_identity(file->path());
    }
  }
}

void RunParts::require_whole(const PartDeal& deal) const {
  std::vector<int> unfinished;
  std::string example;
  for (int number = 1; number <= count_; ++number) {
    stop_if_wanted();
    const std::unique_ptr<PingFile> file = opened(number);
    file->look_through(deal.layout());
    const std::vector<PingUnit> units = deal.units_of(number);
    const auto whole = static_cast<std::size_t>(
        std::ranges::count_if(units, [&](const PingUnit& unit) { return file->has(unit); }));
    if (whole == units.size()) continue;
    unfinished.push_back(number);
    if (!example.empty()) continue;
    const auto damaged =
        std::ranges::find_if(units, [&](const PingUnit& unit) { return file->may_have_damaged(unit); });
    example = fmt::format("{} ('{}') has {} of its {} pings", in_words({number, count_}),
                          file->path().string(), whole, units.size());
    if (damaged != units.end()) example += fmt::format(", and is damaged at {}", deal.in_words(*damaged));
  }
  if (unfinished.empty()) return;
  throw UsageError(
      fmt::format("{}{}: compute {} with --shard {}/{} --resume", example,
                  unfinished.size() > 1 ? fmt::format("; unfinished shards: {}", listed(unfinished)) : "",
                  unfinished.size() > 1 ? "them" : "the others", unfinished[0], count_));
}

void RunParts::hand_over(const PartDeal& deal, PingStore& store, bool quiet) const {
  Progress progress("joined pings", deal.layout().units(), quiet);
  for (int number = 1; number <= count_; ++number) {
    const std::unique_ptr<PingFile> file = opened(number);
    file->look_through(deal.layout());
    const std::vector<PingUnit> units = deal.units_of(number);
    tbb::parallel_for(std::size_t{0}, units.size(), [&](std::size_t k) {
      const PingUnit& unit = units[k];
      try {
        stop_if_wanted();
        store.keep(file->read(unit));
      } catch (const DamagedPing& error) {
        throw UsageError(
            fmt::format("{} ('{}') is damaged at {} ({}): delete it, and compute it again with "
                        "--shard {}/{}",
                        in_words({number, count_}), file->path().string(), deal.in_words(unit), error.what(),
                        number, count_));
      }
      progress.step();
    });
  }
}

void RunParts::remove() const {
  std::error_code ignored;
  for (int number = 1; number <= count_; ++number) fs::remove(path_of(number), ignored);
  try {
    sync_names_in(absolute_path(path_of(1)).parent_path());
  } catch (const std::runtime_error&) {  // harmless: the shards would only be joined again
  }
}

}  // namespace tubefoot
