// SPDX-License-Identifier: GPL-3.0-or-later

// Creates and removes staging folders. A lock on the list of files shows whether the program that made a
// staging folder still runs. Leftovers of killed programs are removed.

#include "files/staging.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <random>
#include <system_error>
#include <vector>

#include "files/checked_file.hpp"
#include "files/durable.hpp"
#include "files/usage_error.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view mark = ".tubefoot-", letters = "abcdefghijklmnopqrstuvwxyz0123456789";
constexpr std::size_t random_letters = 8;

std::string random_word() {
  std::random_device random;
  std::string word;
  for (std::size_t k = 0; k < random_letters; ++k) word += letters[random() % letters.size()];
  return word;
}

/// Returns the target of a staging folder's name: "out" of ".out.tubefoot-xxxxxxxx"; empty for any other
/// name.
std::string_view target_of(std::string_view name) {
  const std::size_t tail = mark.size() + random_letters;
  if (name.size() < tail + 2 || name.front() != '.') return {};
  const std::string_view end = name.substr(name.size() - tail);
  if (!end.starts_with(mark) || end.find_first_not_of(letters, mark.size()) != std::string_view::npos)
    return {};
  return name.substr(1, name.size() - tail - 1);
}

/// Returns whether no program is writing this folder any more. `lock` then keeps others from using it.
bool is_dead(const fs::path& folder, Descriptor& lock) {
  lock = open_own(folder / list_name, O_RDWR);
  try {
    return lock && take_lock(lock);
  } catch (const std::system_error&) {
    return false;
  }
}

/// Removes a folder and its list last, so that the folder stays recognisable if the program is interrupted.
void remove_folder(const fs::path& folder) {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored))
    if (entry.path().filename() != list_name) fs::remove_all(entry.path(), ignored);
  fs::remove_all(folder, ignored);
}

/// Removes leftovers of killed runs in the folder of the target. It restores an earlier result that such a
/// run had renamed.
void clear_leftovers(const fs::path& target) {
  std::error_code ignored;
  std::vector<fs::path> folders;
  for (const fs::directory_entry& entry : fs::directory_iterator(target.parent_path(), ignored)) {
    std::string name = entry.path().filename().string();
    if (name.ends_with(earlier_suffix)) name.resize(name.size() - std::strlen(earlier_suffix));
    if (target_of(name) == target.filename().string() && fs::is_directory(entry.symlink_status(ignored)))
      folders.push_back(entry.path());
  }
  for (const fs::path& folder : folders) {
    Descriptor lock, of_maker;
    if (folder.extension() == earlier_suffix) {
      const fs::path staged = fs::path(folder).replace_extension();
      if (fs::exists(staged, ignored) && !is_dead(staged, of_maker)) continue;
      if (!fs::exists(target, ignored)) {
        fs::rename(folder, target, ignored);
        continue;
      }
    }
    if (is_dead(folder, lock))
      remove_folder(folder);
    else if (lock)
      continue;
    lock.close();                 // an open file would stay in a folder of NFS under another name
    fs::remove(folder, ignored);  // removes an empty folder of a run that was killed before it wrote its list
  }
}

}  // namespace

Staging::Staging(const fs::path& target, mode_t mode) : target_(target) {
  const std::string folder = target.parent_path().string();
  const auto refused = [&](const std::string& why) {
    if (list_) remove_folder(path_);
    return UsageError(fmt::format("'{}': {}: choose another -o", target.string(), why));
  };
  // Another program that clears leftovers may remove a folder without a list. The loop then tries another
  // name.
  constexpr int most_trials = 100;
  bool made = false;
  for (int trial = 0; trial < most_trials && !made; ++trial) {
    path_ = target.parent_path() / fmt::format(".{}{}{}", target.filename().string(), mark, random_word());
    if (mkdir(path_.c_str(), mode) != 0) {
      if (errno == EEXIST) continue;
      throw refused(fmt::format("cannot write into '{}': {}", folder, std::strerror(errno)));
    }
    list_ = open_own(path_ / list_name, O_RDWR | O_CREAT | O_EXCL);
    if (!list_ && errno != ENOENT) {
      const int cause = errno;
      rmdir(path_.c_str());
      throw refused(fmt::format("cannot write into '{}': {}", folder, std::strerror(cause)));
    }
    try {
      made = list_ && take_lock(list_) && is_still_at(path_ / list_name, list_);
    } catch (const std::system_error& error) {
      throw refused(fmt::format("files in '{}' cannot be locked: {}", folder, error.code().message()));
    }
  }
  if (!made) throw refused(fmt::format("cannot write into '{}': no temporary name is free", folder));
  clear_leftovers(target);
}

Staging::~Staging() {
  // If the list is at one of these places, the folder holds files of this run, or the replaced result.
  // Otherwise it holds a result that could not be restored.
  const bool ours = is_still_at(path_ / list_name, list_) || is_still_at(target_ / list_name, list_);
  list_.close();
  if (ours) remove_folder(path_);
}

void Staging::write_list() const {
  std::string list;
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(path_))
    if (entry.path().filename() != list_name) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  for (const std::string& name : names) list += name + "\n";
  // The list is written through the descriptor with the lock. Opening the file again could fail and lose
  // the lock.
  errno = ENOSPC;
  if (pwrite(list_.number(), list.data(), list.size(), 0) != static_cast<ssize_t>(list.size()))
    throw write_error(path_ / list_name, errno);
}

fs::path final_name(const fs::path& file) {
  const std::string name = file.parent_path().filename().string();
  const std::string_view target = target_of(name);
  if (target.empty()) return file;
  const fs::path its = file.parent_path().parent_path() / target;
  return file.filename() == target ? its : its / file.filename();
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw write_error(folder, error.value());
}

void rename_file(const fs::path& file, const fs::path& name) {
  std::error_code error;
  fs::rename(file, name, error);
  if (error) throw write_error(name, error.value());
}

}  // namespace tubefoot
