// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>

#include <array>
#include <concepts>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "files/input_error.hpp"
#include "files/limits.hpp"
#include "scene/file/scene_file_keys.hpp"
#include "scene/file/toml_names.hpp"

// A section of a scene file as a table of keys. Each key knows its struct member, type, unit, default and
// range. The same table reads the file, creates the messages and checks the documentation.
namespace tubefoot {

/// Permitted interval of a number, with its ends unless they are excluded.
struct ValueRange {
  double lo = -std::numeric_limits<double>::infinity();
  double hi = std::numeric_limits<double>::infinity();
  bool lo_excluded = false, hi_excluded = false;
  const char* if_below = "";  ///< reason of the bound, if the numbers do not explain it
  const char* if_above = "";

  bool contains(double value) const;
};
/// Returns "0 to 14", "> 0, <= 170", or an empty text for an unrestricted range.
std::string to_string(const ValueRange& range);

/// Conditions on the value of a key. A single range holds for every element of an array; otherwise there is
/// one range per element.
struct KeyRule {
  std::string meaning{};  ///< see SceneKey
  std::vector<ValueRange> ranges{};
  std::vector<std::string> choices{};
  bool required = false;
  std::size_t longest = limits::text_bytes;  ///< largest length of a text
  std::string default_value{};  ///< for the documentation, if the struct's default does not show it
  std::string former_name{};    ///< see SceneKey
};

/// A key with its rule.
struct TomlKey : SceneKey, KeyRule {
  using SceneKey::default_value;
  using SceneKey::former_name;
  using SceneKey::meaning;

  // Not inline, because every key of every section creates and copies some.
  TomlKey();
  TomlKey(const TomlKey&);
  TomlKey(TomlKey&&) noexcept;
  TomlKey& operator=(const TomlKey&);
  TomlKey& operator=(TomlKey&&) noexcept;
  ~TomlKey();

  /// Returns "a number in metres (0 to 10000)", for "expected ...".
  std::string expected() const;
};

/// The file that is being read.
struct TomlSource {
  /// The name of a file in the text, resolved against the scene file's folder.
  struct NamedFile {
    std::filesystem::path file;
    std::string name;  ///< as written in the text
    SourcePlace place;
  };
  std::filesystem::path file;          ///< as the user gave it
  std::vector<NamedFile> named_files;  ///< files found up to now
  std::vector<std::string> warnings;   ///< messages about valid but deprecated content

  SourcePlace place(const toml::source_region& region) const;
  SourcePlace place(const toml::node& value) const;
};

/// One table of the file with its place.
struct TomlTable {
  const toml::table* table;
  SourcePlace place;
  const TomlSource* source;

  /// Returns the place of a key's value, or that of the table if the key has its default.
  SourcePlace place_of(std::string_view key) const;
  bool has(std::string_view key) const { return value(key) != nullptr; }
  const toml::node* value(std::string_view key) const;  ///< null if the table has no such key
};

struct TomlEntry {
  std::string_view key;
  const toml::node* node;
  SourcePlace place;  ///< place of the key
};
/// Returns the entries of a table in the order of the file (toml++ sorts them by name).
std::vector<TomlEntry> entries_in_file_order(const toml::table& table, const TomlSource& source);

/// Replaces the former name of `key` in a table by the present name, with a warning. Throws InputError if
/// the table has both names.
void rename_former_key(toml::table& table, const SceneKey& key, TomlSource& source);

/// Returns one table or the tables of an array. Throws InputError for any other value. `section` is for the
/// message.
std::vector<TomlTable> tables_of(const toml::node& node, const std::string& section,
                                 const TomlSource& source);

/// Read values of each type. They throw InputError at the place of the value.
/// @{
void read_value(const toml::node& node, const TomlKey& key, TomlSource& source, double& value);
void read_value(const toml::node& node, const TomlKey& key, TomlSource& source, std::int64_t& value);
void read_value(const toml::node& node, const TomlKey& key, TomlSource& source, bool& value);
void read_value(const toml::node& node, const TomlKey& key, TomlSource& source, std::string& value);
/// Reads a file that must exist and adds it to `source.named_files`. Relative paths start from the scene
/// file's folder.
void read_value(const toml::node& node, const TomlKey& key, TomlSource& source, std::filesystem::path& value);

/// Reads smaller or unsigned integers. The range of the key keeps the value within the type.
template <std::integral T>
void read_value(const toml::node& node, const TomlKey& key, TomlSource& source, T& value) {
  std::int64_t whole = 0;
  read_value(node, key, source, whole);
  value = static_cast<T>(whole);
}

template <class T>
void read_value(const toml::node& node, const TomlKey& key, TomlSource& source, std::optional<T>& value) {
  read_value(node, key, source, value.emplace());
}

/// Returns the elements of an array that has the length of the key.
std::vector<const toml::node*> array_of_length(const toml::node& node, const TomlKey& key,
                                               const TomlSource& source, std::size_t length);
/// Returns the key for one element of its array.
TomlKey element_key(const TomlKey& key, std::size_t index);

template <class T, std::size_t n>
void read_value(const toml::node& node, const TomlKey& key, TomlSource& source, std::array<T, n>& value) {
  const std::vector<const toml::node*> elements = array_of_length(node, key, source, n);
  for (std::size_t i = 0; i < n; ++i) read_value(*elements[i], element_key(key, i), source, value[i]);
}

/// Returns the elements of a non-empty array.
std::vector<const toml::node*> array_of_any_length(const toml::node& node, const TomlKey& key,
                                                   const TomlSource& source);

template <class T>
void read_value(const toml::node& node, const TomlKey& key, TomlSource& source, std::vector<T>& value) {
  const std::vector<const toml::node*> elements = array_of_any_length(node, key, source);
  value.resize(elements.size());
  for (std::size_t i = 0; i < elements.size(); ++i)
    read_value(*elements[i], element_key(key, i), source, value[i]);
}
/// @}

/// Returns "[0, 1, 2]".
std::string array_text(const std::vector<std::string>& elements);
std::string number_text(double value);

/// The type's name in the documentation, and a default in TOML notation.
template <class T>
struct TomlType;
template <>
struct TomlType<double> {
  static std::string name() { return "number"; }
  static std::string text(double value) { return number_text(value); }
};
template <>
struct TomlType<bool> {
  static std::string name() { return "true or false"; }
  static std::string text(bool value) { return value ? "true" : "false"; }
};
template <std::integral T>
struct TomlType<T> {
  static std::string name() { return "integer"; }
  static std::string text(T value) { return std::to_string(value); }
};
template <>
struct TomlType<std::string> {
  static std::string name() { return "text"; }
  static std::string text(const std::string& value) { return '"' + value + '"'; }
};
template <>
struct TomlType<std::filesystem::path> {
  static std::string name() { return "file"; }
  static std::string text(const std::filesystem::path&) { return "none"; }
};
template <class T, std::size_t n>
struct TomlType<std::array<T, n>> {
  static std::string name() { return std::to_string(n) + ' ' + TomlType<T>::name() + 's'; }
  static std::string text(const std::array<T, n>& value) {
    return TomlType<std::vector<T>>::text({value.begin(), value.end()});
  }
};
template <class T>
struct TomlType<std::vector<T>> {
  static std::string name() { return TomlType<T>::name() + 's'; }
  static std::string text(const std::vector<T>& value) {
    if (value.empty()) return "none";
    std::vector<std::string> elements;
    for (const T& element : value) elements.push_back(TomlType<T>::text(element));
    return array_text(elements);
  }
};
template <class T, std::size_t n>
struct TomlType<std::vector<std::array<T, n>>> {
  static std::string name() { return "lists of " + TomlType<std::array<T, n>>::name(); }
  static std::string text(const std::vector<std::array<T, n>>&) { return "none"; }
};
template <class T>
struct TomlType<std::optional<T>> {
  static std::string name() { return TomlType<T>::name(); }
  static std::string text(const std::optional<T>& value) {
    return value ? TomlType<T>::text(*value) : "none";
  }
};

/// A key of struct S, and the function that reads its value.
template <class S>
struct TomlField {
  TomlKey key;
  std::function<void(const toml::node&, TomlSource&, S&)> read;
};

/// Returns a key with name, type, unit and default. The end of the name determines the unit.
TomlKey make_key(std::string_view name, std::string type, std::string default_value, KeyRule rule);

template <class S, class T>
TomlField<S> field(std::string_view name, T S::*member, KeyRule rule = {}) {
  const TomlKey key = make_key(name, TomlType<T>::name(), TomlType<T>::text(S{}.*member), std::move(rule));
  return {key, [key, member](const toml::node& node, TomlSource& source, S& s) {
            read_value(node, key, source, s.*member);
          }};
}

/// Returns the fields of a base class as fields of Own.
template <class Own, class Base>
std::vector<TomlField<Own>> inherited(const std::vector<TomlField<Base>>& fields) {
  std::vector<TomlField<Own>> own;
  for (const TomlField<Base>& f : fields)
    own.push_back({f.key, [read = f.read](const toml::node& node, TomlSource& source, Own& s) {
                     read(node, source, s);
                   }});
  return own;
}

/// Functions that a section's S::kind needs: set_kind() selects a kind, and kind_as() accesses it. A
/// variant has them here. Other types define their own.
/// @{
template <class K, class... Ks>
void set_kind(std::variant<Ks...>& kind) {
  kind.template emplace<K>();
}
template <class K, class... Ks>
K& kind_as(std::variant<Ks...>& kind) {
  return std::get<K>(kind);
}
/// @}

/// A section: the keys of S, and keys of single kinds (then in S::kind).
template <class S>
class TomlSection {
 public:
  /// `name` is "[water]" for a section that occurs at most once, or "[[terrain]]" for any number of tables.
  TomlSection(std::string name, std::string meaning) : name_(std::move(name)), meaning_(std::move(meaning)) {}

  TomlSection& keys(const std::vector<TomlField<S>>& fields) { return add(fields, {}); }

  /// Adds a kind: `kind_key = "name"` selects K, with the keys `own` of K. The keys `more` of S exist only
  /// for this kind.
  template <class K>
  TomlSection& kind(std::string_view kind_key, std::string_view name, std::string_view meaning,
                    const std::vector<TomlField<K>>& own, const std::vector<TomlField<S>>& more = {}) {
    const std::string kind = fmt::format("{} = \"{}\"", kind_key, name);
    kind_key_ = kind_key;
    kinds_.push_back(
        {std::string(name), {name_, kind, std::string(meaning)}, [](S& s) { set_kind<K>(s.kind); }});
    std::vector<TomlField<S>> lifted;
    for (const TomlField<K>& f : own) {
      lifted.push_back({f.key, [read = f.read](const toml::node& node, TomlSource& source, S& s) {
                          read(node, source, kind_as<K>(s.kind));
                        }});
    }
    return add(lifted, kind).add(more, kind);
  }

  /// Adds tables of another section inside this one: [[materials.relief]] for `key` "relief". A single
  /// table may be written as [materials.relief].
  template <class T>
  TomlSection& tables(std::string_view key, std::vector<T> S::*member, const TomlSection<T>& section) {
    TomlKey known;
    known.section = name_;
    known.name = key;
    const auto read = [member, &section](const toml::node& node, TomlSource& source, S& s) {
      for (const TomlTable& table : tables_of(node, section.name(), source))
        (s.*member).push_back(section.read(table, source));
    };
    tables_.push_back({std::move(known), read});
    return *this;
  }

  /// Sets a check of conditions between keys, which runs after all keys of a table are read.
  TomlSection& check(std::function<void(const S&, const TomlTable&)> check) {
    check_ = std::move(check);
    return *this;
  }

  const std::string& name() const { return name_; }
  /// Returns the documentation of the section, then of its kinds.
  std::vector<SceneSection> documentation() const;
  /// Returns the keys that have a former name, which must not be the present name of another key.
  std::vector<SceneKey> renamed_keys() const;
  /// Returns the key that selects the kind, then all others.
  std::vector<TomlKey> all_keys() const;
  S read(const TomlTable& table, TomlSource& source) const;

 private:
  TomlSection& add(std::vector<TomlField<S>> fields, const std::string& kind) {
    for (TomlField<S>& f : fields) {
      f.key.section = name_;
      f.key.kind = kind;
      fields_.push_back(std::move(f));
    }
    return *this;
  }

  struct Kind {
    std::string name;
    SceneSection documentation;
    std::function<void(S&)> select;
  };

  std::string name_, meaning_;
  std::string kind_key_;
  std::vector<Kind> kinds_;
  std::vector<TomlField<S>> fields_, tables_;
  std::function<void(const S&, const TomlTable&)> check_;
};

/// Returns the key that selects the kind of a section.
TomlKey make_kind_key(const std::string& section, std::string_view name, std::vector<std::string> kinds);
/// Throws InputError at the first key that no kind of the section has. The message names the most similar
/// key, or the expected unit.
void check_key_names(const TomlTable& table, const std::vector<TomlKey>& keys);
/// Throws InputError for a key of a kind that is not selected, and for a missing required key.
void check_kind_of_keys(const TomlTable& table, const std::vector<TomlKey>& keys, const std::string& kind);

template <class S>
std::vector<SceneSection> TomlSection<S>::documentation() const {
  std::vector<SceneSection> documentation{{name_, {}, meaning_}};
  for (const Kind& k : kinds_) documentation.push_back(k.documentation);
  return documentation;
}

template <class S>
std::vector<SceneKey> TomlSection<S>::renamed_keys() const {
  std::vector<SceneKey> renamed;
  for (const TomlField<S>& f : fields_)
    if (!f.key.former_name.empty()) renamed.push_back(f.key);
  return renamed;
}

template <class S>
std::vector<TomlKey> TomlSection<S>::all_keys() const {
  std::vector<TomlKey> keys;
  if (!kinds_.empty()) {
    std::vector<std::string> names;
    for (const Kind& k : kinds_) names.push_back(k.name);
    keys.push_back(make_kind_key(name_, kind_key_, std::move(names)));
  }
  for (const TomlField<S>& f : fields_) keys.push_back(f.key);
  return keys;
}

template <class S>
S TomlSection<S>::read(const TomlTable& table, TomlSource& source) const {
  S s;
  s.place = table.place;
  std::vector<TomlKey> keys = all_keys();
  for (const TomlField<S>& f : tables_) keys.push_back(f.key);
  check_key_names(table, keys);
  std::string kind;
  if (const toml::node* node = table.value(kind_key_); !kinds_.empty() && node != nullptr) {
    std::string chosen;
    read_value(*node, keys.front(), source, chosen);
    for (const Kind& k : kinds_) {
      if (k.name == chosen) k.select(s);
    }
    kind = fmt::format("{} = \"{}\"", kind_key_, chosen);
  }
  check_kind_of_keys(table, keys, kind);
  for (const TomlEntry& entry : entries_in_file_order(*table.table, source)) {
    for (const TomlField<S>& f : fields_) {
      if (f.key.name == entry.key && (f.key.kind.empty() || f.key.kind == kind))
        f.read(*entry.node, source, s);
    }
    for (const TomlField<S>& f : tables_) {
      if (f.key.name == entry.key) f.read(*entry.node, source, s);
    }
  }
  if (check_) check_(s, table);
  return s;
}

}  // namespace tubefoot
