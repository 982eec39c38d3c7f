// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/checkpoint/build_identity.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <gdal.h>
#include <proj.h>

#include <bit>
#include <nlohmann/json.hpp>

namespace tubefoot {

// Defined in a generated file that is written again whenever they change (cmake/built_from.cmake).
extern const char built_from_sources[], built_from_revision[], built_with[];

namespace {

using Json = nlohmann::ordered_json;

/// Returns a function of a library; null if the library is not loaded.
template <class Function>
Function* if_loaded(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_DEFAULT, name));
}

std::string in_words(const Json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

}  // namespace

Json build_identity() {
  Json identity;
  identity["sources"] = std::string(built_from_sources);
  identity.update(Json::parse(built_with));
  // Loaded libraries may differ from those at build time. A program that has not loaded one has not used it.
  if (const auto version = if_loaded<decltype(GDALVersionInfo)>("GDALVersionInfo"))
    identity["gdal"] = version("RELEASE_NAME");
  if (const auto version = if_loaded<decltype(proj_info)>("proj_info")) {
    const PJ_INFO info = version();
    identity["proj"] = fmt::format("{}.{}.{}", info.major, info.minor, info.patch);
  }
  identity["byte_order"] = std::endian::native == std::endian::little ? "little" : "big";
  return identity;
}

std::string build_revision() { return built_from_revision; }

std::string difference_of_builds(const Json& theirs, const Json& ours) {
  std::string words;
  for (const auto& [key, value] : ours.items()) {
    const Json other = theirs.is_object() && theirs.contains(key) ? theirs.at(key) : Json("unknown");
    if (other == value) continue;
    words +=
        fmt::format("{}{} {}, here {}", words.empty() ? "" : "; ", key, in_words(other), in_words(value));
  }
  return words.empty() ? "it names libraries that this build does not have" : words;
}

std::string build_in_words() {
  const Json identity = build_identity();
  std::string words;
  for (const auto& [key, value] : identity.items())
    words += fmt::format("{}{}: {}", words.empty() ? "" : "\n", key, in_words(value));
  if (const std::string revision = build_revision(); !revision.empty()) words += "\nrevision: " + revision;
  return words;
}

}  // namespace tubefoot
