// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sys/time.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <type_traits>

#include "files/input_error.hpp"

// Common functions of all fuzz targets (validation/fuzzing.md): input bytes, scratch files, limits on
// processor time, and checks of error messages.
namespace tubefoot::fuzz {

/// An input that is read from the front. It returns zeros after its end.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : left_(reinterpret_cast<const char*>(data), size) {}

  template <class T>
  T take() {
    static_assert(std::is_arithmetic_v<T>);
    T value{};
    const std::size_t count = std::min(sizeof value, left_.size());
    std::memcpy(&value, left_.data(), count);
    left_.remove_prefix(count);
    return value;
  }
  /// 0 to `end` - 1.
  std::uint32_t below(std::uint32_t end) { return take<std::uint8_t>() % end; }
  /// 0 to `end` - 1, from two bytes.
  std::uint32_t below_many(std::uint32_t end) { return take<std::uint16_t>() % end; }
  std::string_view text(std::size_t most) {
    const std::string_view front = left_.substr(0, most);
    left_.remove_prefix(front.size());
    return front;
  }
  bool empty() const { return left_.empty(); }
  std::string_view rest() const { return left_; }

 private:
  std::string_view left_;
};

/// Stops the program, so that libFuzzer reports the input.
[[noreturn]] inline void finding(const std::string& what) {
  std::fprintf(stderr, "finding: %s\n", what.c_str());
  std::abort();
}

/// Limits the processor time of all threads during its lifetime. (libFuzzer's own limit uses the clock,
/// which is not meaningful on a busy machine.)
class TimeLimit {
 public:
  TimeLimit() {
    static const bool ready = [] {
      std::signal(SIGPROF, [](int) { std::abort(); });  // libFuzzer reports the position
      return true;
    }();
    static_cast<void>(ready);
    set(10);
  }
  ~TimeLimit() { set(0); }
  TimeLimit(const TimeLimit&) = delete;
  TimeLimit& operator=(const TimeLimit&) = delete;

 private:
  static void set(int seconds) {
    itimerval limit{};
    limit.it_value.tv_sec = seconds;
    setitimer(ITIMER_PROF, &limit, nullptr);
  }
};

/// A folder of this process, in memory if there is /dev/shm. It is removed at the end.
inline const std::filesystem::path& scratch_folder() {
  static const std::filesystem::path folder = [] {
    const char* const parent = std::filesystem::is_directory("/dev/shm") ? "/dev/shm" : "/tmp";
    std::string name = std::string(parent) + "/tubefoot-fuzz-XXXXXX";
    if (mkdtemp(name.data()) == nullptr) finding("no scratch folder");
    static std::filesystem::path made = name;
    std::atexit([] {
      std::error_code ignored;
      std::filesystem::remove_all(made, ignored);
    });
    return made;
  }();
  return folder;
}

/// Writes a file with these bytes. The next file of that name replaces it.
inline std::filesystem::path scratch_file(std::string_view name, std::string_view content) {
  std::filesystem::path file = scratch_folder() / name;
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  stream.write(content.data(), static_cast<std::streamsize>(content.size()));
  if (!stream.flush()) finding("the scratch folder is full");
  return file;
}

/// Checks an error message: it has a few lines and does not contain the raw bytes of the input.
inline void check_message(const std::string& message) {
  constexpr std::size_t longest = 20000;  // 4000 characters, at worst all of them as \x1b
  if (message.empty()) finding("an error without a word");
  if (message.size() > longest) finding("a message of " + std::to_string(message.size()) + " characters");
  for (const char c : message)
    if (static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t')
      finding("a control character in a message: " + message);
}

/// Runs a reader. The reader may reject the input by InputError, with a position. Other exceptions
/// propagate to std::terminate(), and libFuzzer reports them.
template <class Read>
void may_refuse(const Read& read) {
  try {
    read();
  } catch (const InputError& error) {
    if (error.place.file.empty()) finding(std::string("an error of no file: ") + error.what());
    check_message(error.what());
  }
}

}  // namespace tubefoot::fuzz
