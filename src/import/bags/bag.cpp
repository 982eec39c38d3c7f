// SPDX-License-Identifier: GPL-3.0-or-later
// Reads recordings of ROS 2: folders with metadata.yaml, .db3 and .mcap files, single serialized messages
// (.cdr) and messages as text (.yaml). It chooses the topic, orders messages by time and converts them to
// frames.
#include "import/bags/bag.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <tuple>

#include "files/input_registry.hpp"
#include "files/memory_at_hand.hpp"
#include "files/shown.hpp"
#include "files/usage_error.hpp"
#include "geometry/steps/steps.hpp"
#include "import/bags/bag_limits.hpp"
#include "import/bags/bag_metadata.hpp"
#include "import/bags/cdr.hpp"
#include "import/bags/definitions.hpp"
#include "import/bags/mcap_store.hpp"
#include "import/bags/message_error.hpp"
#include "import/bags/message_frames.hpp"
#include "import/bags/sqlite_store.hpp"
#include "import/bags/text_messages.hpp"
#include "import/bags/unpacking.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view sqlite_magic{"SQLite format 3\0", 16};
constexpr std::array text_endings{".yaml", ".yml"};
constexpr std::array bag_endings{".db3", ".mcap", ".db3.zstd", ".mcap.zstd", ".cdr", ".yaml", ".yml"};

bool ends_in(const fs::path& path, std::string_view ending) {
  return path.filename().string().ends_with(ending);
}

/// Frames in the order of their arrival, with a check of the memory that they need.
class Gathered {
 public:
  explicit Gathered(const fs::path& path) : place_{path.string(), 0, 0} {}

  /// `place`: number of the message in the order of recording, if messages arrive in another order. Throws
  /// MessageError for a message without a picture.
  void add(const ros::Message& message, std::optional<double> recorded_s,
           std::optional<std::size_t> place = {}) {
    ForeignFrame frame = frame_of(message, notices_);
    if (!frame.time_s) frame.time_s = recorded_s;
    constexpr double look_every = 64 << 20;
    bytes_ += static_cast<double>(frame.values.size() * sizeof(double));
    if (bytes_ - looked_ > look_every) {
      require_memory(bytes_, place_, "its pictures", "split the recording with ros2 bag convert");
      looked_ = bytes_;
    }
    places_.push_back(place.value_or(places_.size()));
    data_.frames.push_back(std::move(frame));
  }

  void note(const std::string& what) { data_.noticed.push_back(what); }

  ForeignData done() {
    if (data_.frames.empty()) throw InputError(place_, "has no messages");
    std::vector<ForeignFrame> ordered(data_.frames.size());
    for (std::size_t k = 0; k < ordered.size(); ++k) ordered[places_[k]] = std::move(data_.frames[k]);
    data_.frames = std::move(ordered);
    const ForeignFrame& first = data_.frames.front();
    for (const ForeignFrame& frame : data_.frames)
      if (frame.rows != first.rows || frame.columns != first.columns)
        notices_.add("sizes",
                     fmt::format("pictures differ in size: the first has {} x {}, another has {} x {}",
                                 first.rows, first.columns, frame.rows, frame.columns));
    for (std::string& each : notices_.told(data_.frames.size())) data_.noticed.push_back(std::move(each));
    return std::move(data_);
  }

 private:
  SourcePlace place_;
  Notices notices_;
  ForeignData data_;
  std::vector<std::size_t> places_;  ///< position of each frame among all frames
  double bytes_ = 0, looked_ = 0;
};

std::unique_ptr<MessageStore> open_store(const fs::path& file, UnpackedBytes& in_all) {
  const SourcePlace place{file.string(), 0, 0};
  InputFile input(file);
  const std::string head = input.head(sqlite_magic.size());
  const auto bytes = [](const std::string& text) {
    return std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  };
  const auto begins = [](std::span<const std::uint8_t> with, std::string_view magic) {
    return with.size() >= magic.size() &&
           std::equal(magic.begin(), magic.end(), with.begin(),
                      [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; });
  };
  if (begins(bytes(head), sqlite_magic)) return open_sqlite_store(file);
  if (begins(bytes(head), mcap_magic)) return open_mcap_store(ByteSource(file), in_all);
  if (is_zstd(bytes(head))) {
    require_memory(static_cast<double>(input.size()), place, "the recording", "unpack it with zstd -d");
    std::vector<std::uint8_t> packed(input.size());
    ByteSource(file).read(0, packed);
    const std::uint64_t most = std::min(limits::unpacked_bytes, in_all.left());
    std::vector<std::uint8_t> unpacked = unpack_zstd(packed, most, place, "the recording");
    in_all.add(unpacked.size(), place, "the recording");
    packed = {};
    if (begins(unpacked, sqlite_magic)) return open_sqlite_store(file, std::move(unpacked));
    if (begins(unpacked, mcap_magic)) return open_mcap_store(ByteSource(file, std::move(unpacked)), in_all);
  }
  throw InputError(place,
                   "is not a ROS 2 recording: expected SQLite (.db3) or MCAP (.mcap), either of them plain "
                   "or compressed with zstd");
}

/// A topic over all files of a recording.
struct WholeTopic {
  BagTopic topic;
  std::vector<std::pair<std::size_t, std::size_t>> parts;  ///< store and number of the topic in it
};

std::vector<WholeTopic> all_topics(const std::vector<std::unique_ptr<MessageStore>>& stores) {
  std::vector<WholeTopic> all;
  std::map<std::array<std::string, 3>, std::size_t> number;  // by name, type and format
  for (std::size_t store = 0; store < stores.size(); ++store)
    for (std::size_t k = 0; k < stores[store]->topics().size(); ++k) {
      const BagTopic& topic = stores[store]->topics()[k];
      const auto [same, is_new] = number.try_emplace({topic.name, topic.type, topic.format}, all.size());
      if (is_new)
        all.push_back({topic, {}});
      else
        all[same->second].topic.messages += topic.messages;
      all[same->second].parts.emplace_back(store, k);
    }
  return all;
}

std::string list_of(const std::vector<WholeTopic>& topics) {
  constexpr std::size_t most = 50;
  std::string list;
  for (std::size_t k = 0; k < std::min(most, topics.size()); ++k)
    list += fmt::format("\n  {}  {}  {} messages", shown_line(topics[k].topic.name),
                        shown_line(topics[k].topic.type), topics[k].topic.messages);
  if (topics.size() > most) list += fmt::format("\n  and {} more", topics.size() - most);
  return list;
}

const WholeTopic& chosen(const std::vector<WholeTopic>& topics, const std::optional<std::string>& name,
                         const fs::path& path) {
  const std::string here = shown_line(path.string());
  std::vector<const WholeTopic*> fitting;
  for (const WholeTopic& each : topics)
    if (name ? each.topic.name == *name : ros::is_known_type(each.topic.type) && each.topic.messages > 0)
      fitting.push_back(&each);
  const auto has_no_picture = [](const WholeTopic* each) {
    return ros::is_type(each->topic.type, ros::ImagingSonar::name);
  };
  if (!name && !std::ranges::all_of(fitting, has_no_picture)) std::erase_if(fitting, has_no_picture);
  const bool one_name = std::ranges::all_of(
      fitting, [&](const WholeTopic* each) { return each->topic.name == fitting.front()->topic.name; });
  if (fitting.size() > 1 && one_name) {  // the topic has two types, of which one may be readable
    std::erase_if(fitting, [](const WholeTopic* each) { return !ros::is_known_type(each->topic.type); });
    if (fitting.size() > 1)
      throw InputError({path.string(), 0, 0},
                       fmt::format("topic '{}' has messages of more than one type:{}",
                                   shown_line(fitting.front()->topic.name), list_of(topics)));
  }
  if (fitting.empty() && name)
    throw UsageError(fmt::format("{}: has no topic '{}'; it has{}", here, shown_line(*name),
                                 topics.empty() ? " none" : ":" + list_of(topics)));
  if (fitting.empty())
    throw InputError({path.string(), 0, 0}, fmt::format("has no topic with sonar pictures ({}); it has{}",
                                                        fmt::join(std::span(ros::known_types).first(3), ", "),
                                                        topics.empty() ? " none" : ":" + list_of(topics)));
  if (fitting.size() > 1)
    throw UsageError(
        fmt::format("{}: several topics have pictures; choose one with --topic:{}", here, list_of(topics)));
  const BagTopic& topic = fitting.front()->topic;
  if (!ros::is_known_type(topic.type))
    throw InputError({path.string(), 0, 0},
                     fmt::format("topic '{}' has type {}, which tubefoot does not read: expected {}",
                                 shown_line(topic.name), shown_line(topic.type),
                                 fmt::join(std::span(ros::known_types).first(3), ", ")));
  if (topic.format != "cdr")
    throw InputError(
        {path.string(), 0, 0},
        fmt::format("topic '{}' is serialized as '{}', which tubefoot does not read: expected cdr",
                    shown_line(topic.name), shown_line(topic.format)));
  if (const std::string difference =
          topic.definition.empty() ? "" : difference_of_definition(topic.type, topic.definition);
      !difference.empty())
    throw InputError({path.string(), 0, 0},
                     fmt::format("topic '{}': the recording has another definition of {}: {}",
                                 shown_line(topic.name), shown_line(topic.type), difference));
  return *fitting.front();
}

ForeignData read_recording(const fs::path& path, const std::vector<fs::path>& files,
                           std::optional<std::uint64_t> said, const std::optional<std::string>& name) {
  std::uint64_t in_files = 0;
  for (const fs::path& file : files) in_files += InputFile(file).size();
  UnpackedBytes in_all(in_files);
  std::vector<std::unique_ptr<MessageStore>> stores;
  for (const fs::path& file : files) stores.push_back(open_store(file, in_all));
  const std::vector<WholeTopic> topics = all_topics(stores);
  Gathered gathered(path);
  std::uint64_t found = 0;
  for (const WholeTopic& each : topics) found += each.topic.messages;
  if (said && *said != found)
    gathered.note(fmt::format("metadata.yaml lists {} messages, but the files have {}", *said, found));
  const WholeTopic& whole = chosen(topics, name, path);
  if (topics.size() > 1 || name)
    gathered.note(fmt::format("topic {} ({})", shown_line(whole.topic.name), shown_line(whole.topic.type)));

  struct Message {
    MessagePlace place;
    std::size_t store;
    std::size_t number = 0;  ///< number in the order of times
  };
  std::vector<Message> messages;
  for (const auto& [store, number] : whole.parts)
    for (const MessagePlace& place : stores[store]->messages(number)) messages.push_back({place, store});
  std::ranges::stable_sort(messages, {}, [](const Message& message) { return message.place.time_ns; });
  for (std::size_t k = 0; k < messages.size(); ++k) messages[k].number = k;
  // The messages are read in the order of the files, so that each compressed chunk is decompressed once.
  std::ranges::stable_sort(messages, {}, [](const Message& message) {
    return std::tuple(message.store, message.place.outer, message.place.inner);
  });

  Steps steps("messages read", messages.size());
  for (const auto& [message, store, number] : messages) {
    steps.done();
    const SourcePlace place{files[store].string(), 0, 0};
    const std::string what = fmt::format("message {} of '{}' ({})", number + 1, shown_line(whole.topic.name),
                                         shown_line(whole.topic.type));
    std::span<const std::uint8_t> bytes = stores[store]->read(message);
    std::vector<std::uint8_t> unpacked;
    if (is_zstd(bytes)) {
      bytes = unpacked = unpack_zstd(bytes, limits::message_bytes, place, what);
      in_all.add(unpacked.size(), place, what);
    }
    try {
      gathered.add(read_cdr(whole.topic.type, bytes), 1e-9 * static_cast<double>(message.time_ns), number);
    } catch (const MessageError& error) {
      throw InputError(place, fmt::format("{}: {}", what, error.what()));
    }
  }
  return gathered.done();
}

/// Reads a single message of the given type, or of the only type that matches its bytes.
ForeignData read_saved_message(const fs::path& path, const std::optional<std::string>& type) {
  const SourcePlace place{path.string(), 0, 0};
  const std::string text = read_whole(path, place, limits::message_bytes, "one serialized message");
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  Gathered gathered(path);
  std::vector<std::pair<std::string_view, ros::Message>> fitting;
  std::string reasons;
  for (const std::string_view known : ros::known_types) {
    if (type && !ros::is_type(*type, known)) continue;
    try {
      ros::Message message = read_cdr(known, bytes);
      Notices none;
      if (known != ros::ImagingSonar::name) frame_of(message, none);
      fitting.emplace_back(known, std::move(message));
    } catch (const MessageError& error) {
      reasons += fmt::format("\n  {}: {}", known, error.what());
    }
  }
  if (fitting.empty()) throw InputError(place, "is not a message that tubefoot reads:" + reasons);
  if (fitting.size() > 1) {
    std::string types;
    for (const auto& [known, message] : fitting) types += fmt::format("\n  {}", known);
    throw UsageError(fmt::format("{}: the message fits several types; choose one with --topic:{}",
                                 shown_line(path.string()), types));
  }
  if (!type) gathered.note(fmt::format("read as {}, the only type that fits", fitting.front().first));
  try {
    gathered.add(fitting.front().second, std::nullopt);
  } catch (const MessageError& error) {
    throw InputError(place, error.what());
  }
  return gathered.done();
}

}  // namespace

bool is_bag(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) return fs::exists(fs::symlink_status(path / "metadata.yaml", error));
  return std::ranges::any_of(bag_endings, [&](std::string_view ending) { return ends_in(path, ending); });
}

ForeignData read_bag(const fs::path& path, const std::optional<std::string>& topic) {
  std::error_code error;
  if (fs::is_directory(path, error)) {
    if (!fs::exists(fs::symlink_status(path / "metadata.yaml", error)))
      throw InputError(
          {path.string(), 0, 0},
          "is a folder without metadata.yaml: name the .db3 or .mcap file in it, or run ros2 bag reindex");
    const BagMetadata metadata = read_bag_metadata(path);
    return read_recording(path, metadata.files, metadata.messages, topic);
  }
  const bool is_text =
      std::ranges::any_of(text_endings, [&](std::string_view ending) { return ends_in(path, ending); });
  const bool is_saved = ends_in(path, ".cdr");
  if ((is_text || is_saved) && topic && !ros::is_known_type(*topic))
    throw UsageError(fmt::format("{}: for a single message, --topic must give its type, one of {}, not '{}'",
                                 shown_line(path.string()), fmt::join(ros::known_types, ", "),
                                 shown_line(*topic)));
  if (is_saved) return read_saved_message(path, topic);
  if (!is_text) return read_recording(path, {path}, std::nullopt, topic);
  Gathered gathered(path);
  read_message_text(path, topic, [&](const ros::Message& message) { gathered.add(message, std::nullopt); });
  return gathered.done();
}

}  // namespace tubefoot
