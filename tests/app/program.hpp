// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <csignal>
#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

// tubefoot seen from outside: the program is run as a child process on files in a folder of the test's own.
namespace tubefoot {

/// A folder of its own for a test, removed at the end.
class TestFolder {
 public:
  TestFolder();
  ~TestFolder();
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(std::string_view name) const { return path_ / name; }
  std::filesystem::path write(const std::string& name, std::string_view text) const;

 private:
  std::filesystem::path path_;
};

/// How a child process ended and what it said.
struct Outcome {
  int exit_code = -1;  ///< -1 if a signal ended it
  int signal = 0;      ///< the signal that ended it; SIGALRM: it took longer than two minutes
  std::string out, err;
  double peak_memory_mb = 0;   ///< resident
  double seconds_to_stop = 0;  ///< from its signal to its end
};

/// What the child process lives with.
struct Surroundings {
  std::optional<std::size_t> largest_file_bytes;    ///< writing beyond fails, as on a full disk
  std::optional<std::size_t> largest_memory_bytes;  ///< address space: `ulimit -v`
  std::optional<std::size_t> stack_bytes;           ///< `ulimit -s`
  bool as_nobody = false;                           ///< gives up root's right to write everywhere
  /// Asked a hundred times a second while the child runs; once it says true, the child gets `signal`.
  std::function<bool()> interrupt_when;
  /// The same, asked of what the child has said on standard error so far.
  std::function<bool(const std::string& err)> interrupt_once_said;
  int signal = SIGINT;              ///< 0: none
  std::vector<int> ignored;         ///< signals that it finds ignored; all others have their default
  std::set<int> unread;             ///< standard streams that nobody reads: pipes without a reader
  std::vector<std::string> before;  ///< a program, with its arguments, that starts tubefoot
  std::string program;              ///< in place of tubefoot
};

Outcome run_program(const std::vector<std::string>& arguments, const Surroundings& surroundings = {});

/// Whether somebody without rights can run the program at all (it may lie in a private folder).
bool nobody_can_run_program();

/// Every file and folder below `folder`, relative to it, hidden ones included.
std::set<std::string> names_below(const std::filesystem::path& folder);

std::string bytes_of(const std::filesystem::path& file);

/// The scene with its only occurrence of `from` replaced.
std::string replaced(std::string_view scene, std::string_view from, std::string_view to);

}  // namespace tubefoot
