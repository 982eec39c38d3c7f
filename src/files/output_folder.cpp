// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/output_folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/types.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <set>

#include "files/usage_error.hpp"

namespace tubefoot {
namespace fs = std::filesystem;
namespace {

/// Names what tubefoot wrote into a folder, so that only those files are ever replaced.
constexpr const char* manifest_name = ".tubefoot-files";

/// Where two folders cannot be exchanged, the earlier result lies under this name for a moment.
constexpr std::string_view earlier_suffix = ".earlier";

/// Everything in a folder, subfolders by name only: tubefoot makes none.
std::set<std::string> names_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    names.insert(entry.path().filename().string());
  return names;
}

std::string staging_prefix(const fs::path& target) { return "." + target.filename().string() + ".partial-"; }

/// Removes what a killed run left beside the target: staging folders of processes that are no more.
void remove_leftovers(const fs::path& target) {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(target.parent_path(), ignored)) {
    const std::string name = entry.path().filename().string(), prefix = staging_prefix(target);
    if (!name.starts_with(prefix)) continue;
    std::string digits = name.substr(prefix.size());
    const bool earlier = digits.ends_with(earlier_suffix);
    if (earlier) digits.resize(digits.size() - earlier_suffix.size());
    if (digits.empty() || digits.find_first_not_of("0123456789") != std::string::npos || digits.size() > 9)
      continue;
    const pid_t process = std::stoi(digits);
    if (process != getpid() && (kill(process, 0) == 0 || errno != ESRCH)) continue;
    if (earlier && !fs::exists(target))
      fs::rename(entry.path(), target, ignored);  // it was about to be replaced
    fs::remove_all(entry.path(), ignored);
  }
}

void refuse_strangers(const fs::path& target) {
  if (!fs::is_directory(target))
    throw UsageError(fmt::format("'{}' exists and is not a folder: choose another -o", target.string()));
  std::set<std::string> known{manifest_name};
  std::ifstream manifest(target / manifest_name);
  for (std::string line; std::getline(manifest, line);) known.insert(line);
  for (const std::string& name : names_in(target))
    if (!known.contains(name))
      throw UsageError(
          fmt::format("'{}' holds '{}', which tubefoot did not write: choose another -o, or move it away",
                      target.string(), name));
}

}  // namespace

void write_file(const fs::path& file, const std::string& bytes) {
  errno = 0;
  std::FILE* stream = std::fopen(file.c_str(), "wb");
  bool good = stream != nullptr;
  if (good) {
    good = std::fwrite(bytes.data(), 1, bytes.size(), stream) == bytes.size();
    good = std::fclose(stream) == 0 && good;
  }
  if (!good)
    throw std::runtime_error(fmt::format("cannot write '{}': {}", file.string(), std::strerror(errno)));
}

OutputFolder::OutputFolder(const fs::path& target) {
  if (target.empty()) throw UsageError("-o is empty: name a folder to write");
  std::error_code error;
  target_ = fs::weakly_canonical(fs::absolute(target), error);  // a link to a folder stays a link
  if (!target_.has_filename()) target_ = target_.parent_path();
  if (error || !target_.has_filename())
    throw UsageError(fmt::format("'{}' cannot be a result folder: choose another -o", target.string()));
  if (fs::exists(target_)) refuse_strangers(target_);
  for (fs::path parent = target_.parent_path(); !fs::exists(parent); parent = parent.parent_path())
    made_parents_.push_back(parent);
  remove_leftovers(target_);
  staging_ = target_.parent_path() / (staging_prefix(target_) + std::to_string(getpid()));
  fs::create_directories(target_.parent_path(), error);
  if (!error) fs::create_directory(staging_, error);
  if (error) {
    clean_up();
    throw UsageError(fmt::format("cannot write into '{}': {}: choose another -o",
                                 target_.parent_path().string(), error.message()));
  }
}

OutputFolder::~OutputFolder() {
  if (!committed_) clean_up();
}

void OutputFolder::clean_up() {
  std::error_code ignored;
  fs::remove_all(staging_, ignored);
  for (const fs::path& parent : made_parents_) fs::remove(parent, ignored);  // only if empty
}

void OutputFolder::commit() {
  std::string manifest;
  for (const std::string& name : names_in(staging_)) manifest += name + "\n";
  write_file(staging_ / manifest_name, manifest);
  std::error_code error;
  const bool replaces = fs::exists(target_);
  if (replaces) refuse_strangers(target_);  // somebody may have put a file there since
  // At no moment is there no result, whenever the program may be killed.
  if (replaces && renameat2(AT_FDCWD, staging_.c_str(), AT_FDCWD, target_.c_str(), RENAME_EXCHANGE) == 0) {
    committed_ = true;
    fs::remove_all(staging_, error);
    return;
  }
  fs::path earlier = staging_;
  earlier += earlier_suffix;
  if (replaces) {
    fs::remove_all(earlier, error);  // of a process of the same number that was killed here
    fs::rename(target_, earlier, error);
    if (error)
      throw std::runtime_error(
          fmt::format("cannot move the earlier result '{}' aside: {}", target_.string(), error.message()));
  }
  fs::rename(staging_, target_, error);
  if (error) {
    const std::string why = error.message();
    if (replaces) fs::rename(earlier, target_, error);
    throw std::runtime_error(fmt::format("cannot move the result to '{}': {}", target_.string(), why));
  }
  committed_ = true;
  if (replaces) fs::remove_all(earlier, error);
}

}  // namespace tubefoot
