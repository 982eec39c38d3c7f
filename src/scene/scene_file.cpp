// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <system_error>

#include "files/file_hash.hpp"
#include "files/limits.hpp"
#include "geometry/stop.hpp"
#include "scene/named_files.hpp"
#include "scene/scene_description.hpp"
#include "scene/scene_file_sections.hpp"
#include "scene/scene_file_words.hpp"
#include "scene/sensor_presets.hpp"
#include "scene/vrt_sources.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// A file's bytes in pieces, to `use`; throws InputError at `place` when reading fails midway.
template <class Use>
void for_each_piece(const fs::path& file, const SourcePlace& place, const Use& use) {
  std::ifstream in(file, std::ios::binary);
  std::string piece(std::size_t{1} << 20, '\0');
  while (in) {
    stop_if_wanted();
    in.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    use(std::string_view(piece).substr(0, static_cast<std::size_t>(in.gcount())));
  }
  if (!in.eof()) throw InputError(place, fmt::format("reading '{}' failed", file.string()));
}

std::string scene_text(const fs::path& file) {
  const SourcePlace place{file.string()};
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (status.type() == fs::file_type::not_found) throw InputError(place, "there is no such scene file");
  if (status.type() == fs::file_type::none) throw InputError(place, "cannot look at it: " + error.message());
  if (status.type() != fs::file_type::regular) {
    throw InputError(place, "not a regular file, expected a scene file (TOML text)");
  }
  std::string text;
  for_each_piece(file, place, [&](std::string_view piece) {
    text += piece;
    if (text.size() > limits::scene_file_bytes) {
      throw InputError(place, fmt::format("larger than {} bytes, expected a scene file (TOML text)",
                                          limits::scene_file_bytes));
    }
  });
  return text;
}

/// toml++ nests a table for every dot of a key and overflows the stack somewhere above 20000 of them; inside
/// brackets it nests at most 256 deep. So a line's dots bound the depth. Dots in a row are text, not keys.
void check_dots(std::string_view text, const fs::path& file) {
  constexpr int most_dots = 64;
  SourcePlace place{file.string(), 1, 0};
  int dots = 0;
  char previous = '\n';
  for (const char c : text) {
    ++place.column;
    if (c == '\n') {
      ++place.line;
      place.column = dots = 0;
    } else if (c == '.' && previous != '.' && ++dots > most_dots) {
      throw InputError(place, fmt::format("more than {} dots on one line: break the line", most_dots));
    }
    previous = c;
  }
}

toml::table parse(std::string_view text, const TomlSource& source) {
  check_dots(text, source.file);
  try {
    return toml::parse(text);
  } catch (const toml::parse_error& error) {
    throw InputError(source.place(error.source()), fmt::format("not valid TOML: {}", error.description()));
  }
}

/// Every text in the file that names a file outside of its folder.
void note_outsiders(const toml::node& node, const TomlSource& source, std::vector<std::string>& notes) {
  if (const toml::table* table = node.as_table()) {
    for (const TomlEntry& entry : entries_in_file_order(*table, source))
      note_outsiders(*entry.node, source, notes);
  } else if (const toml::array* array = node.as_array()) {
    for (const toml::node& one : *array) note_outsiders(one, source, notes);
  } else if (const auto text = node.value<std::string>(); text && node.is_string()) {
    const fs::path folder = source.file.parent_path(), named = folder / *text;
    std::error_code ignored;
    if (!fs::is_regular_file(named, ignored)) return;
    if (const auto real = place_outside(folder, named))
      notes.push_back(fmt::format("{}: \"{}\" leaves the scene's folder: it is '{}'",
                                  to_string(source.place(node.source())), *text, real->string()));
    for (const fs::path& companion : companions_of(named))
      if (const auto real = place_outside(folder, companion); real && !place_outside(folder, named))
        notes.push_back(fmt::format(
            "{}: '{}', which is read along with \"{}\", leaves the scene's folder: it "
            "is '{}'",
            to_string(source.place(node.source())), companion.filename().string(), *text, real->string()));
  }
}

/// Adds the keys of a sensor's preset that the sensor does not give itself. A pattern that it gives replaces
/// all that the preset says of that pattern.
void apply_preset(toml::table& sensor, const TomlSource& source) {
  const toml::node* named = sensor.get("preset");
  if (named == nullptr || !named->is_string()) return;  // the section's reader refuses what is no text
  const std::string name = **named->as_string();
  for (const SensorPreset& preset : sensor_presets()) {
    if (preset.name != name) continue;
    const toml::table keys = toml::parse(preset.keys);
    if (const auto kind = sensor["kind"].value<std::string>();
        kind && kind != keys["kind"].value<std::string>())
      throw InputError(source.place(sensor.get("kind")->source()),
                       fmt::format("the preset \"{}\" is of {}: remove 'kind', or the preset", name,
                                   fmt::format("kind = \"{}\"", *keys["kind"].value<std::string>())));
    for (const auto& [key, value] : keys) {
      bool replaced = sensor.contains(key);
      for (const std::string_view side : {"transmit_", "receive_"})
        replaced =
            replaced || (key.str().starts_with(side) && sensor.contains(std::string(side) + "pattern"));
      replaced = replaced || (key.str() == "samples" && sensor.contains("sampling_frequency_khz"));
      if (!replaced) sensor.insert(key, value);
    }
    return;
  }
}

void apply_presets(toml::table& root, const TomlSource& source) {
  toml::array* sensors = root["sensors"].as_array();
  if (sensors == nullptr) return;
  for (toml::node& sensor : *sensors)
    if (toml::table* table = sensor.as_table()) apply_preset(*table, source);
}

/// A description and the table it comes from, for what is checked across tables.
template <class S>
struct Entry {
  S description;
  TomlTable table;
};

template <class S>
void read_section(const TomlEntry& entry, const TomlSection<S>& section, TomlSource& source,
                  std::vector<Entry<S>>& entries) {
  const bool many = section.name().starts_with("[[");
  const auto read_table = [&](const toml::node& node) {
    if (!node.is_table()) {
      throw InputError(source.place(node.source()),
                       fmt::format("'{}' must be {}: write {}{}", entry.key, many ? "tables" : "one table",
                                   section.name(), many ? "" : ", once"));
    }
    const TomlTable table{node.as_table(), source.place(node.source()), &source};
    entries.push_back({section.read(table, source), table});
  };
  if (const toml::array* tables = entry.node->as_array(); tables != nullptr && many) {
    for (const toml::node& node : *tables) read_table(node);
  } else {
    read_table(*entry.node);
  }
}

struct SceneEntries {
  SceneDescription scene;  ///< what stands above all sections
  std::vector<Entry<GeoreferenceDescription>> georeference;
  std::vector<Entry<WaterDescription>> water;
  std::vector<Entry<SeaSurfaceDescription>> sea_surface;
  std::vector<Entry<PathsDescription>> paths;
  std::vector<Entry<MaterialDescription>> materials;
  std::vector<Entry<TerrainDescription>> terrains;
  std::vector<Entry<ObjectDescription>> objects;
  std::vector<Entry<TrajectoryDescription>> trajectories;
  std::vector<Entry<SensorDescription>> sensors;
  std::vector<Entry<RefinementDescription>> refinement;
  std::vector<Entry<RunDescription>> run;
};

SceneEntries read_entries(const toml::table& root, TomlSource& source) {
  SceneEntries all;
  using Read = std::function<void(const TomlEntry&)>;
  const auto into = [&source](const auto& section, auto& entries) -> Read {
    return [&](const TomlEntry& entry) { read_section(entry, section, source, entries); };
  };
  const std::map<std::string, Read, std::less<>> readers{
      {"title", [&](const TomlEntry& entry) { title_field().read(*entry.node, source, all.scene); }},
      {"georeference", into(georeference_section(), all.georeference)},
      {"water", into(water_section(), all.water)},
      {"sea_surface", into(sea_surface_section(), all.sea_surface)},
      {"paths", into(paths_section(), all.paths)},
      {"materials", into(material_section(), all.materials)},
      {"terrain", into(terrain_section(), all.terrains)},
      {"objects", into(object_section(), all.objects)},
      {"trajectories", into(trajectory_section(), all.trajectories)},
      {"trajectory", into(trajectory_section(), all.trajectories)},
      {"sensors", into(sensor_section(), all.sensors)},
      {"relief", into(refinement_section(), all.refinement)},
      {"run", into(run_section(), all.run)},
  };
  for (const TomlEntry& entry : entries_in_file_order(root, source)) {
    const auto reader = readers.find(entry.key);
    if (reader == readers.end()) {
      std::vector<std::string> names;
      for (const auto& [name, read] : readers) names.push_back(name);
      const std::string_view meant = nearest(entry.key, names);
      throw InputError(entry.place, fmt::format("unknown section or key '{}': {}", entry.key,
                                                meant.empty() ? "expected " + one_of(names, '\'')
                                                              : fmt::format("did you mean '{}'?", meant)));
    }
    reader->second(entry);
  }
  return all;
}

/// Names of a section's entries, and the place of each. They refer to the entries.
using Names = std::map<std::string_view, SourcePlace>;

template <class S>
Names unique_names(const std::vector<Entry<S>>& entries, const TomlSection<S>& section) {
  Names taken;
  for (const Entry<S>& entry : entries) {
    const SourcePlace place = entry.table.place_of("name");
    const auto [first, is_new] = taken.emplace(entry.description.name, place);
    if (!is_new) {
      throw InputError(place,
                       fmt::format("the name \"{}\" is taken at {} already: every entry of {} needs its own "
                                   "'name'",
                                   entry.description.name, to_string(first->second), section.name()));
    }
  }
  return taken;
}

/// Resolves a key that names an entry of another section; left out, it means the only entry there is.
void resolve(std::string& name, SourcePlace& place, const TomlTable& table, std::string_view key,
             const Names& names, std::string_view section) {
  place = table.place_of(key);
  if (names.empty()) {
    throw InputError(place, fmt::format("no '{}' to refer to: the scene has no {} section", key, section));
  }
  if (name.empty() && names.size() == 1) name = names.begin()->first;
  if (names.contains(name)) return;
  std::vector<std::string> known;
  for (const auto& [known_name, known_place] : names) known.emplace_back(known_name);
  if (name.empty()) throw InputError(place, fmt::format("needs the key '{}': {}", key, one_of(known, '"')));
  const std::string_view meant = nearest(name, known);
  throw InputError(place, fmt::format("no entry of {} is named \"{}\": {}", section, name,
                                      meant.empty() ? "expected " + one_of(known, '"')
                                                    : fmt::format("did you mean \"{}\"?", meant)));
}

void check_scene(SceneEntries& all, const fs::path& file) {
  const SourcePlace whole{file.string()};
  if (all.terrains.empty() && all.objects.empty()) {
    throw InputError(whole, "the scene has no terrain and no object: add [[terrain]] or [[objects]]");
  }
  if (all.sensors.empty()) throw InputError(whole, "the scene has no sensor: add [[sensors]]");
  if (all.trajectories.empty()) {
    throw InputError(whole, "the scene has no trajectory for its sensors: add [[trajectories]]");
  }
  unique_names(all.terrains, terrain_section());
  unique_names(all.objects, object_section());
  unique_names(all.sensors, sensor_section());
  const auto resolve_material = [names = unique_names(all.materials, material_section())](auto& entry) {
    resolve(entry.description.material, entry.description.material_place, entry.table, "material", names,
            material_section().name());
  };
  for (auto& entry : all.terrains) {
    resolve_material(entry);
    if (!entry.description.material_map) continue;
    std::vector<std::string> known;
    for (const auto& material : all.materials) known.push_back(material.description.name);
    check_materials(*entry.description.material_map, known);
  }
  for (auto& entry : all.objects) {
    resolve_material(entry);
    if (entry.description.position_lat_lon_deg && all.georeference.empty()) {
      throw InputError(entry.table.place_of("position_lat_lon_deg"),
                       "'position_lat_lon_deg' needs to know where the frame lies: add [georeference]");
    }
    if (entry.description.on_terrain_m && all.terrains.empty()) {
      throw InputError(entry.table.place_of("on_terrain_m"),
                       "'on_terrain_m' needs a terrain: add [[terrain]]");
    }
  }
  const Names trajectories = unique_names(all.trajectories, trajectory_section());
  for (auto& [sensor, table] : all.sensors) {
    resolve(sensor.trajectory, sensor.trajectory_place, table, "trajectory", trajectories,
            trajectory_section().name());
  }
}

template <class S>
std::vector<S> descriptions(std::vector<Entry<S>>& entries) {
  std::vector<S> result;
  for (Entry<S>& entry : entries) result.push_back(std::move(entry.description));
  return result;
}

/// The one description there is, or the default one, placed at the whole file.
template <class S>
S only(const std::vector<Entry<S>>& entries, const fs::path& file) {
  if (!entries.empty()) return entries.front().description;
  S s;
  s.place.file = file.string();
  return s;
}

template <class S>
void append_keys(const TomlSection<S>& section, std::vector<SceneKey>& keys) {
  const std::vector<TomlKey> own = section.all_keys();
  keys.insert(keys.end(), own.begin(), own.end());
}

}  // namespace

std::vector<SceneKey> scene_file_keys() {
  std::vector<SceneKey> keys{title_field().key};
  append_keys(georeference_section(), keys);
  append_keys(water_section(), keys);
  append_keys(sea_surface_section(), keys);
  append_keys(material_section(), keys);
  append_keys(reflectivity_section(), keys);
  append_keys(relief_section(), keys);
  append_keys(terrain_section(), keys);
  append_keys(material_map_section(), keys);
  append_keys(object_section(), keys);
  append_keys(trajectory_section(), keys);
  append_keys(sensor_section(), keys);
  append_keys(refinement_section(), keys);
  append_keys(paths_section(), keys);
  append_keys(run_section(), keys);
  return keys;
}

SceneDescription read_scene_file(const fs::path& file) { return read_scene_text(scene_text(file), file); }

std::vector<std::string> names_that_leave_the_folder(const fs::path& file) {
  const TomlSource source{file, {}};
  std::vector<std::string> notes;
  note_outsiders(parse(scene_text(file), source), source, notes);
  return notes;
}

SceneDescription read_scene_text(const std::string& text, const fs::path& file) {
  TomlSource source{file, {}};
  toml::table root = parse(text, source);
  apply_presets(root, source);
  SceneEntries all = read_entries(root, source);
  check_scene(all, file);

  SceneDescription scene = std::move(all.scene);
  scene.file = file;
  if (!all.georeference.empty()) scene.georeference = all.georeference.front().description;
  scene.water = only(all.water, file);
  if (!all.sea_surface.empty()) scene.sea_surface = all.sea_surface.front().description;
  scene.paths = only(all.paths, file);
  scene.materials = descriptions(all.materials);
  scene.terrains = descriptions(all.terrains);
  scene.objects = descriptions(all.objects);
  scene.trajectories = descriptions(all.trajectories);
  scene.sensors = descriptions(all.sensors);
  scene.refinement = only(all.refinement, file);
  if (!all.refinement.empty()) scene.refinement.file_place = all.refinement.front().table.place_of("file");
  if (auto& bed = scene.refinement.file) bed = (file.parent_path() / *bed).string();
  scene.run = only(all.run, file);

  Sha256 hash;
  hash.update(text);
  const auto add = [&hash](std::string_view piece) { hash.update(piece); };
  for (const fs::path& named : source.named_files) {
    for_each_piece(named, {file.string()}, add);
    for (const fs::path& companion : companions_of(named)) for_each_piece(companion, {file.string()}, add);
  }
  scene.sha256 = hash.hex_digest();
  return scene;
}

}  // namespace tubefoot
