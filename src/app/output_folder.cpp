// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/output_folder.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <set>

#include "app/usage_error.hpp"

namespace tubefoot {
namespace fs = std::filesystem;
namespace {

/// Names what tubefoot wrote into a folder, so that only those files are ever replaced.
constexpr const char* manifest_name = ".tubefoot-files";

std::set<std::string> files_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    if (!entry.is_directory()) names.insert(fs::relative(entry.path(), folder).string());
  return names;
}

void refuse_strangers(const fs::path& target) {
  if (!fs::is_directory(target))
    throw UsageError(fmt::format("'{}' exists and is not a folder: choose another -o", target.string()));
  std::set<std::string> known{manifest_name};
  std::ifstream manifest(target / manifest_name);
  for (std::string line; std::getline(manifest, line);) known.insert(line);
  for (const std::string& name : files_in(target))
    if (!known.contains(name))
      throw UsageError(
          fmt::format("'{}' holds '{}', which tubefoot did not write: choose another -o, or move it away",
                      target.string(), name));
}

}  // namespace

void write_text_file(const fs::path& file, const std::string& text) {
  errno = 0;
  std::FILE* stream = std::fopen(file.c_str(), "wb");
  bool good = stream != nullptr;
  if (good) {
    good = std::fwrite(text.data(), 1, text.size(), stream) == text.size();
    good = std::fclose(stream) == 0 && good;
  }
  if (!good)
    throw std::runtime_error(fmt::format("cannot write '{}': {}", file.string(), std::strerror(errno)));
}

OutputFolder::OutputFolder(fs::path target) : target_(fs::absolute(target).lexically_normal()) {
  if (!target_.has_filename()) target_ = target_.parent_path();
  if (fs::exists(target_)) refuse_strangers(target_);
  staging_ = target_.parent_path() / fmt::format(".{}.partial-{}", target_.filename().string(), getpid());
  std::error_code error;
  fs::create_directories(target_.parent_path(), error);
  if (!error) fs::create_directory(staging_, error);
  if (error)
    throw UsageError(fmt::format("cannot write into '{}': {}: choose another -o",
                                 target_.parent_path().string(), error.message()));
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  if (!committed_) fs::remove_all(staging_, ignored);
}

void OutputFolder::commit() {
  std::string manifest;
  for (const std::string& name : files_in(staging_)) manifest += name + "\n";
  write_text_file(staging_ / manifest_name, manifest);
  const fs::path earlier = staging_.string() + ".earlier";
  const bool replaces = fs::exists(target_);
  if (replaces) {
    refuse_strangers(target_);  // somebody may have put a file there since
    fs::rename(target_, earlier);
  }
  std::error_code error;
  fs::rename(staging_, target_, error);
  if (error) {
    if (replaces) fs::rename(earlier, target_);
    throw std::runtime_error(
        fmt::format("cannot move the result to '{}': {}", target_.string(), error.message()));
  }
  committed_ = true;
  if (replaces) fs::remove_all(earlier);
}

}  // namespace tubefoot
