// SPDX-License-Identifier: GPL-3.0-or-later

// Counts the attribute names of a GeoJSON and the pairs of consecutive names. A scanner of the JSON text
// finds the names of members before GDAL reads the file.

#include "files/geojson_file.hpp"

#include <fmt/core.h>

#include <cctype>
#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "files/advised_command.hpp"
#include "files/input_registry.hpp"
#include "files/limits.hpp"
#include "geometry/steps/steps.hpp"

namespace tubefoot {
namespace {

/// The names of members in a JSON text, down to features and their properties. The class does not check the
/// syntax. It accepts the extensions that GDAL's reader accepts (comments, single quotes).
class MemberNames {
 public:
  explicit MemberNames(const std::filesystem::path& file) : place_{file.string(), 1, 0} {}

  void take(std::string_view piece) {
    for (const char c : piece) take(c);
  }

 private:
  enum class In { text, string, escape, slash, line_comment, comment, comment_star };

  void take(char c) {
    if (c == '\n') ++place_.line;
    switch (in_) {
      case In::string:
        if (c == '\\')
          in_ = In::escape;
        else if (c == quote_)
          in_ = In::text;
        else if (string_.size() < most_name_bytes)
          string_ += c;
        return;
      case In::escape:
        if (string_.size() < most_name_bytes) (string_ += '\\') += c;
        in_ = In::string;
        return;
      case In::slash:
        in_ = c == '/' ? In::line_comment : c == '*' ? In::comment : In::text;
        return;
      case In::line_comment:
        if (c == '\n') in_ = In::text;
        return;
      case In::comment:
        if (c == '*') in_ = In::comment_star;
        return;
      case In::comment_star:
        in_ = c == '/' ? In::text : c == '*' ? In::comment_star : In::comment;
        return;
      case In::text:
        break;
    }
    if (c == '"' || c == '\'') {
      in_ = In::string;
      quote_ = c;
      string_.clear();
      has_string_ = true;
    } else if (c == '/') {
      in_ = In::slash;
    } else if (c == '{') {
      last_.push_back(none);
    } else if (c == '}') {
      if (!last_.empty()) last_.pop_back();
    } else if (c == ':' && has_string_) {
      name();
    }
    if (c != '"' && c != '\'' && c != '/' && std::isspace(static_cast<unsigned char>(c)) == 0)
      has_string_ = false;
  }

  /// Records the name before a colon. Objects below the properties of a feature in a collection contain
  /// only values.
  void name() {
    constexpr std::size_t deepest = 3;
    if (last_.empty() || last_.size() > deepest) return;
    const auto number =
        numbers_.try_emplace(string_, static_cast<std::uint32_t>(numbers_.size())).first->second;
    if (last_.back() != none) pairs_.insert(std::uint64_t{last_.back()} << 32 | number);
    last_.back() = number;
    if (numbers_.size() > limits::map_attributes)
      fail(fmt::format("has more than {} attributes", limits::map_attributes));
    if (pairs_.size() > limits::map_attribute_pairs)
      fail(
          fmt::format("lists its attributes in too many different orders: more than {} different pairs of "
                      "names follow each other",
                      limits::map_attribute_pairs));
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(place_, what + ": keep only the attribute that names the material, with " +
                                 advised_ogr2ogr("-select NAME", place_.file));
  }

  static constexpr std::uint32_t none = ~std::uint32_t{0};
  static constexpr std::size_t most_name_bytes = 1000;
  SourcePlace place_;
  In in_ = In::text;
  char quote_ = '"';
  bool has_string_ = false;  ///< only blanks follow the string
  std::string string_;
  std::vector<std::uint32_t> last_;  ///< last name in each enclosing object
  std::unordered_map<std::string, std::uint32_t> numbers_;
  std::unordered_set<std::uint64_t> pairs_;
};

}  // namespace

void refuse_many_attributes(const std::filesystem::path& geojson) {
  InputFile file(geojson);
  MemberNames names(geojson);
  Steps steps("MiB read", static_cast<std::size_t>(file.size() >> 20));
  std::size_t bytes = 0;
  file.for_each_piece([&](std::string_view piece) {
    stop_if_wanted();
    names.take(piece);
    for (bytes += piece.size(); bytes >> 20 != 0; bytes -= std::size_t{1} << 20) steps.done();
  });
}

}  // namespace tubefoot
