// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/ranks/rank_notes.hpp"

#include <fmt/format.h>

#include <cstring>
#include <new>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "files/input_error.hpp"
#include "files/usage_error.hpp"

// This file encodes and decodes the messages between ranks (docs/large-jobs.md). A letter is followed by
// JSON, by numbers in the byte order of the machine, or by a packed ping.

namespace tubefoot {
namespace {

template <class Value>
void append(std::string& text, const Value* values, std::size_t count) {
  text.append(reinterpret_cast<const char*>(values), count * sizeof(Value));
}

class Reader {
 public:
  explicit Reader(std::string_view message) : rest_(message.substr(1)) {}
  template <class Value>
  void read(Value* values, std::size_t count) {
    const std::size_t bytes = count * sizeof(Value);
    if (rest_.size() < bytes) throw std::runtime_error("a rank sent an incomplete ping");
    if (bytes > 0) std::memcpy(values, rest_.data(), bytes);
    rest_.remove_prefix(bytes);
  }
  std::size_t left() const { return rest_.size(); }

 private:
  std::string_view rest_;
};

}  // namespace

Note note_of(std::string_view message) {
  if (message.empty()) throw std::runtime_error("a rank sent nothing");
  return static_cast<Note>(message.front());
}

std::string note(Note kind, std::string_view text) { return static_cast<char>(kind) + std::string(text); }

std::string wanted_note(std::size_t count) {
  std::string text = note(Note::wanted);
  const std::uint64_t wanted = count;
  append(text, &wanted, 1);
  return text;
}

std::size_t count_in(std::string_view message) {
  std::uint64_t count = 0;
  Reader(message).read(&count, 1);
  return count;
}

std::string pings_note(std::span<const PingUnit> units) {
  std::string text = note(Note::pings);
  append(text, units.data(), units.size());
  return text;
}

std::vector<PingUnit> units_in(std::string_view message) {
  Reader reader(message);
  std::vector<PingUnit> units(reader.left() / sizeof(PingUnit));
  reader.read(units.data(), units.size());
  return units;
}

std::string result_note(const StoreLayout& layout, const PingUnit& unit, const PingCounts& counts,
                        const PingValues& values) {
  return note(Note::result, packed_ping(layout, unit, counts, values));
}

bool take_result(std::string_view message, const StoreLayout& layout, PingStore& store) {
  try {
    const std::string_view packed = message.substr(1);
    const PingUnit unit = head_of_packed(packed, layout).unit;
    if (store.done(unit.group, unit.ping)) return false;
    store.keep(packed);
    return true;
  } catch (const DamagedPing& error) {
    throw std::runtime_error(
        fmt::format("a rank sent a ping that does not belong to this run: {}", error.what()));
  }
}

std::string failed_note(const std::exception& error) {
  nlohmann::json json{{"kind", "error"}, {"text", error.what()}};
  if (const auto* input = dynamic_cast<const InputError*>(&error)) {
    json = {{"kind", "input"},
            {"file", input->place.file},
            {"line", input->place.line},
            {"column", input->place.column},
            {"text", std::string(error.what()).substr(to_string(input->place).size() + 2)}};
  } else if (dynamic_cast<const UsageError*>(&error) != nullptr) {
    json["kind"] = "usage";
  } else if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr) {
    json["kind"] = "memory";
  }
  return note(Note::failed, json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

void rethrow(std::string_view failed_message) {
  const auto json = nlohmann::json::parse(failed_message.substr(1));
  const std::string kind = json.at("kind"), text = json.at("text");
  if (kind == "input") throw InputError({json.at("file"), json.at("line"), json.at("column")}, text);
  if (kind == "usage") throw UsageError(text);
  if (kind == "memory") throw std::bad_alloc();
  throw std::runtime_error(text);
}

}  // namespace tubefoot
