// SPDX-License-Identifier: GPL-3.0-or-later

// Writes files and result folders atomically and durably. The output is written into a Staging in the
// folder of the target, synchronised with the disk, and renamed. Constructors test whether the target can
// be replaced.

#include "files/atomic_output.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <set>

#include "files/absolute_path.hpp"
#include "files/durable.hpp"
#include "files/usage_error.hpp"

namespace tubefoot {
namespace fs = std::filesystem;
namespace {

UsageError is_an_input(const fs::path& target) {
  return UsageError(
      fmt::format("'{}' is an input or contains one: choose another place for the output", target.string()));
}

UsageError dangling(const fs::path& target) {
  return UsageError(fmt::format("'{}' is a link to a missing file: choose another -o, or remove the link",
                                target.string()));
}

/// Returns whether a name refers to an open file of a process, as /dev/stdout does.
bool is_of_open_files(fs::path name) {
  std::error_code error;
  for (int links = 0; links < 40 && fs::is_symlink(fs::symlink_status(name, error)); ++links) {
    const fs::path folder = fs::weakly_canonical(absolute_path(name).parent_path(), error);
    if (folder.native().starts_with("/proc/")) return true;
    name = folder / fs::read_symlink(name, error);
    if (error) return false;
  }
  return false;
}

bool is_mount_point(const fs::path& place) {
  struct statx status {};
  return statx(AT_FDCWD, place.c_str(), AT_SYMLINK_NOFOLLOW, STATX_BASIC_STATS, &status) == 0 &&
         (status.stx_attributes & STATX_ATTR_MOUNT_ROOT) != 0;
}

/// Tests whether an earlier file or folder can be replaced, without replacing it. The test requests an
/// operation that must fail: replacing a file, or a folder that is not empty, by a folder. The system
/// checks rights, mounts and layers before it rejects this operation.
void rehearse(const fs::path& target, const Staging& staging) {
  const auto refused = [&](const std::string& why) {
    return UsageError(fmt::format("'{}' cannot be replaced: {}: choose another -o", target.string(), why));
  };
  if (is_mount_point(target)) throw refused("something is mounted there");
  const bool folder = fs::is_directory(target);
  if (folder && faccessat(AT_FDCWD, target.c_str(), W_OK | X_OK, AT_EACCESS) != 0)
    throw refused(std::strerror(errno));
  const int status = folder ? std::rename(target.c_str(), staging.path().c_str())
                            : std::rename(staging.path().c_str(), target.c_str());
  if (status == 0) {
    if (folder) std::rename(staging.path().c_str(), target.c_str());
    throw refused("the file system does not protect files from being overwritten");
  }
  static const std::set<int> expected{ENOTEMPTY, EEXIST, ENOTDIR, EISDIR};
  if (!expected.contains(errno)) throw refused(std::strerror(errno));
}

/// Returns the names in the list of a result folder. A list that is not a regular file does not count.
std::set<std::string> listed_in(const fs::path& folder) {
  std::set<std::string> names{list_name};
  if (!fs::is_regular_file(fs::symlink_status(folder / list_name))) return names;
  std::ifstream list(folder / list_name);
  for (std::string line; std::getline(list, line);) names.insert(line);
  return names;
}

void refuse_strangers(const fs::path& target) {
  if (!fs::is_directory(target))
    throw UsageError(fmt::format("'{}' exists and is not a folder: choose another -o", target.string()));
  const std::set<std::string> known = listed_in(target);
  for (const fs::directory_entry& entry : fs::directory_iterator(target)) {
    const std::string name = entry.path().filename().string();
    // An output with subfolders (a pack) never replaces an earlier one.
    if (!known.contains(name) || fs::is_directory(entry.symlink_status()))
      throw UsageError(fmt::format(
          "'{}' holds '{}', which tubefoot did not write: choose another -o, or move that entry away",
          target.string(), name));
  }
}

}  // namespace

bool same_file(const fs::path& a, const fs::path& b) {
  std::error_code ignored;
  return fs::equivalent(a, b, ignored) ||
         fs::weakly_canonical(absolute_path(a), ignored) == fs::weakly_canonical(absolute_path(b), ignored);
}

OutputFile::OutputFile(const fs::path& target, const Inputs& inputs) {
  if (!target.has_filename())
    throw UsageError(
        fmt::format("'{}' does not name a file: give the name of a file to write", target.string()));
  std::error_code error;
  const fs::file_status status = fs::status(target, error);
  if (fs::is_directory(status))
    throw UsageError(fmt::format("'{}' is a folder: give the name of a file to write", target.string()));
  if (!fs::exists(status) && fs::is_symlink(fs::symlink_status(target, error))) throw dangling(target);
  for (const fs::path& input : inputs)
    if (same_file(target, input)) throw is_an_input(target);
  direct_ = fs::exists(status) && (!fs::is_regular_file(status) || is_of_open_files(target));
  target_ = path_ = direct_ ? target : fs::weakly_canonical(absolute_path(target), error);
  if (direct_) return;
  if (error) throw UsageError(fmt::format("cannot write '{}': {}", target.string(), error.message()));
  if (target_.filename() == list_name)
    throw UsageError(fmt::format(
        "tubefoot needs the name '{}' for its list of written files: give another name", target.string()));
  // The trial is removed at once and the staging folder is made again in path(), so that an interrupted
  // program leaves nothing behind.
  const Staging trial(target_, 0700);
  if (fs::exists(status)) rehearse(target_, trial);
}

const fs::path& OutputFile::path() {
  if (!direct_ && !staging_) {
    staging_.emplace(target_, 0700);
    path_ = staging_->path() / target_.filename();
  }
  return path_;
}

void OutputFile::commit() {
  if (direct_) return;
  sync_files_in(staging_->path());
  publish(path_, target_);
  staging_.reset();
}

OutputFolder::OutputFolder(const fs::path& target, const Inputs& inputs) {
  if (target.empty()) throw UsageError("-o is empty: name a folder to write");
  std::error_code error;
  target_ = fs::weakly_canonical(absolute_path(target), error);
  if (!target_.has_filename()) target_ = target_.parent_path();
  if (error || !target_.has_filename())
    throw UsageError(fmt::format("'{}' cannot be a result folder{}: choose another -o", target.string(),
                                 error ? " (" + error.message() + ")" : ""));
  if (fs::is_symlink(fs::symlink_status(target_, error))) throw dangling(target);
  const bool replaces = fs::exists(target_);
  if (replaces) refuse_strangers(target_);
  for (const fs::path& input : inputs) {
    const fs::path place = fs::weakly_canonical(absolute_path(input), error);
    if (std::mismatch(target_.begin(), target_.end(), place.begin(), place.end()).first == target_.end())
      throw is_an_input(target);
  }
  try {
    make_parents();
    staging_.emplace(target_, 0777);
    if (replaces) rehearse(target_, *staging_);
  } catch (...) {
    staging_.reset();
    remove_parents();
    throw;
  }
}

OutputFolder::~OutputFolder() {
  staging_.reset();
  remove_parents();
}

void OutputFolder::make_parents() {
  std::vector<fs::path> missing;
  for (fs::path parent = target_.parent_path(); !fs::exists(parent); parent = parent.parent_path())
    missing.push_back(parent);
  for (auto parent = missing.rbegin(); parent != missing.rend(); ++parent) {
    if (mkdir(parent->c_str(), 0777) == 0)
      made_parents_.push_back(*parent);
    else if (errno != EEXIST)
      throw UsageError(fmt::format("cannot write into '{}': {}: choose another -o", parent->string(),
                                   std::strerror(errno)));
  }
}

/// Removes only empty parents, because nothing was committed.
void OutputFolder::remove_parents() {
  for (; !made_parents_.empty(); made_parents_.pop_back()) rmdir(made_parents_.back().c_str());
}

void OutputFolder::commit() {
  staging_->write_list();
  if (fs::exists(target_))
    refuse_strangers(target_);  // another program may have put a file there in the meantime
  sync_files_in(staging_->path());
  for (const fs::path& parent : made_parents_) sync_names_in(parent.parent_path());
  publish(staging_->path(), target_);
  made_parents_.clear();
  staging_.reset();
}

}  // namespace tubefoot
