// SPDX-License-Identifier: GPL-3.0-or-later

// Reads a scene file (TOML, docs/scene-keys.md). It parses the text, replaces former names of keys and
// applies presets. Then it reads all sections, resolves references between them, and computes the scene hash.
// The hash is the SHA-256 of the text and of the hashes of all named files.

#include <toml++/toml.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <system_error>

#include "files/companions.hpp"
#include "files/file_format.hpp"
#include "files/file_hash.hpp"
#include "files/grid_words.hpp"
#include "files/input_registry.hpp"
#include "files/limits.hpp"
#include "files/words.hpp"
#include "geometry/steps/stop.hpp"
#include "scene/description/scene_description.hpp"
#include "scene/file/scene_file_sections.hpp"
#include "scene/file/scene_file_tables.hpp"
#include "scene/file/sensor_presets.hpp"
#include "scene/file/toml_text.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

std::string scene_text(const fs::path& file) {
  const SourcePlace place{file.string()};
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (status.type() == fs::file_type::not_found) throw InputError(place, "there is no such scene file");
  if (status.type() == fs::file_type::none) throw InputError(place, "cannot be accessed: " + error.message());
  return read_whole(file, place, limits::scene_file_bytes, "a scene file (TOML text)");
}

/// Computes the scene hash and records every hashed file. A scene consists of these files, and no other
/// file is read.
class InputHash {
 public:
  InputHash(SceneDescription& scene, const std::string& text)
      : scene_(scene), folder_(scene.file.parent_path()) {
    hash_.update(text);
    // The text of a description need not be in a file.
    if (std::error_code ignored; fs::is_regular_file(scene.file, ignored)) scene.inputs.push_back(scene.file);
  }

  void add(const TomlSource::NamedFile& named) {
    refuse_or_note(named.file, named.place, fmt::format("\"{}\"", named.name));
    const auto admit = [&](const fs::path& companion) {
      refuse_or_note(
          companion, named.place,
          fmt::format("'{}', which belongs to \"{}\",", companion.filename().string(), named.name));
    };
    try {
      const bool through_gdal = gdal_driver_of(format_of(named.file)) != nullptr;
      take(named.file, named.place, through_gdal);
      for (const fs::path& companion : companions_of(named.file, admit))
        take(companion, named.place, through_gdal);
    } catch (const InputError& error) {
      if (error.place.file == named.place.file) throw;
      throw InputError(named.place, error.what());
    }
  }

  std::string hash() const { return hash_.hex_digest(); }

 private:
  /// Rejects or records a file outside of the scene's folder.
  void refuse_or_note(const fs::path& file, const SourcePlace& place, const std::string& who) {
    const auto real = place_outside(folder_, file);
    if (!real) return;
    const std::string what =
        fmt::format("{} lies outside of the scene's folder, at '{}'", who, real->string());
    if (scene_.confined)
      throw InputError(place, what +
                                  ", and --confined permits only files inside: copy the file into the "
                                  "folder, or omit --confined");
    scene_.warnings.push_back(fmt::format("{}: {}", to_string(place), what));
  }

  void take(const fs::path& file, const SourcePlace& place, bool through_gdal) {
    Sha256 own;
    GridWords words;
    InputFile input(file, place);
    input.for_each_piece([&](std::string_view piece) {
      own.update(piece);
      if (through_gdal) words.feed(piece);
    });
    if (!words.met().empty()) throw InputError({file.string(), 0, 0}, names_grids(words.met()));
    // The hash covers each file's own digest instead of its bytes, so that bytes cannot move to the next
    // file unnoticed. It also covers the name, by which the file is read. The format is that of sha256sum.
    hash_.update(fmt::format("{}  {}\n", own.hex_digest(), file.filename().string()));
    scene_.inputs.push_back(file);
  }

  SceneDescription& scene_;
  fs::path folder_;
  Sha256 hash_;
};

void refuse_preset_as_kind(const toml::table& sensor, const TomlSource& source) {
  const auto kind = sensor["kind"].value<std::string>();
  if (kind && std::ranges::any_of(sensor_presets(), [&](const SensorPreset& p) { return p.name == *kind; }))
    throw InputError(source.place(sensor.get("kind")->source()),
                     fmt::format("\"{0}\" is a preset, not a kind: write preset = \"{0}\" instead", *kind));
}

/// Adds the keys of a sensor's preset that the sensor does not have. If the sensor has a pattern, that
/// pattern replaces all keys of the preset for this side.
void apply_preset(toml::table& sensor, const TomlSource& source) {
  refuse_preset_as_kind(sensor, source);
  const toml::node* named = sensor.get("preset");
  if (named == nullptr || !named->is_string())
    return;  // the section's reader rejects a value that is not text
  const std::string name = **named->as_string();
  for (const SensorPreset& preset : sensor_presets()) {
    if (preset.name != name) continue;
    const toml::table keys = toml::parse(preset.text);
    if (const auto kind = sensor["kind"].value<std::string>();
        kind && kind != keys["kind"].value<std::string>())
      throw InputError(source.place(sensor.get("kind")->source()),
                       fmt::format("the preset \"{}\" has {}: remove 'kind' or the preset", name,
                                   fmt::format("kind = \"{}\"", *keys["kind"].value<std::string>())));
    for (const auto& [key, value] : keys) {
      bool replaced = sensor.contains(key);
      for (const std::string_view side : {"transmit_", "receive_"})
        replaced =
            replaced || (key.str().starts_with(side) && sensor.contains(std::string(side) + "pattern"));
      replaced = replaced || (key.str() == "samples" && sensor.contains("sampling_frequency_khz"));
      for (const std::string_view spread : {"beams", "horizontal_deg", "swath_deg", "spacing"})
        replaced = replaced || (key.str() == spread && sensor.contains("beam_angles_deg"));
      if (!replaced) sensor.insert(key, value);
    }
    return;
  }
  if (name == "none") return;
  const std::vector<std::string> names = sensor_preset_names();
  const std::string_view meant = nearest(name, names);
  throw InputError(source.place(named->source()),
                   fmt::format("there is no preset \"{}\"{}: `tubefoot presets` lists the presets", name,
                               meant.empty() ? "" : fmt::format(" (did you mean \"{}\"?)", meant)));
}

void apply_presets(toml::table& root, const TomlSource& source) {
  toml::array* sensors = root["sensors"].as_array();
  if (sensors == nullptr) return;
  for (toml::node& sensor : *sensors)
    if (toml::table* table = sensor.as_table()) apply_preset(*table, source);
}

/// A description and its table, for checks across tables.
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
                                   section.name(), many ? "" : " once"));
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
  SceneDescription scene;  ///< keys before all sections
  std::vector<Entry<GeoreferenceDescription>> georeference;
  std::vector<Entry<WaterDescription>> water;
  std::vector<Entry<SeaSurfaceDescription>> sea_surface;
  std::vector<Entry<PathsDescription>> paths;
  std::vector<Entry<MaterialDescription>> materials;
  std::vector<Entry<TerrainDescription>> terrains;
  std::vector<Entry<ObjectDescription>> objects;
  std::vector<Entry<WaterTargetDescription>> targets;
  std::vector<Entry<TargetPopulationDescription>> target_populations;
  std::vector<Entry<TrajectoryDescription>> trajectories;
  std::vector<Entry<SensorDescription>> sensors;
  std::vector<Entry<RefinementDescription>> refinement;
  std::vector<Entry<ScatterersDescription>> scatterers;
  std::vector<Entry<ProcessingDescription>> processing;
  std::vector<Entry<RunDescription>> run;
};

SceneEntries read_entries(const toml::table& root, const TomlSection<SensorDescription>& sensors,
                          TomlSource& source) {
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
      {"targets", into(target_section(), all.targets)},
      {"target_populations", into(target_population_section(), all.target_populations)},
      {"trajectories", into(trajectory_section(), all.trajectories)},
      {"trajectory", into(trajectory_section(), all.trajectories)},
      {"sensors", into(sensors, all.sensors)},
      {"relief", into(refinement_section(), all.refinement)},
      {"scatterers", into(scatterers_section(), all.scatterers)},
      {"processing", into(processing_section(), all.processing)},
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

/// Names of a section's entries with their places. The names refer to the entries.
using Names = std::map<std::string_view, SourcePlace>;

template <class S>
Names unique_names(const std::vector<Entry<S>>& entries, const TomlSection<S>& section) {
  Names taken;
  for (const Entry<S>& entry : entries) {
    const SourcePlace place = entry.table.place_of("name");
    const auto [first, is_new] = taken.emplace(entry.description.name, place);
    if (!is_new) {
      throw InputError(
          place, fmt::format("the name \"{}\" is already used at {}: every entry of {} needs its own 'name'",
                             entry.description.name, to_string(first->second), section.name()));
    }
  }
  return taken;
}

/// Resolves a key that names an entry of another section. Without the key, the only entry is meant.
void resolve(std::string& name, SourcePlace& place, const TomlTable& table, std::string_view key,
             const Names& names, std::string_view section) {
  place = table.place_of(key);
  if (names.empty()) {
    throw InputError(place, fmt::format("'{}' has nothing to refer to, because the scene has no {} section",
                                        key, section));
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

void check_scene(SceneEntries& all, const TomlSection<SensorDescription>& sensors, const fs::path& file) {
  const SourcePlace whole{file.string()};
  const bool has_sea = !all.sea_surface.empty() && all.sea_surface.front().description.has_facets();
  if (all.terrains.empty() && all.objects.empty() && !has_sea) {
    throw InputError(whole, "the scene has no terrain and no object: add [[terrain]] or [[objects]]");
  }
  if (all.sensors.empty()) throw InputError(whole, "the scene has no sensor: add [[sensors]]");
  if (all.trajectories.empty()) {
    throw InputError(whole, "the scene has no trajectory for its sensors: add [[trajectories]]");
  }
  unique_names(all.terrains, terrain_section());
  unique_names(all.objects, object_section());
  unique_names(all.targets, target_section());
  unique_names(all.target_populations, target_population_section());
  for (const auto& [target, table] : all.targets)
    if (target.position_lat_lon_deg && all.georeference.empty())
      throw InputError(table.place_of("position_lat_lon_deg"),
                       "'position_lat_lon_deg' needs the position of the frame on Earth: add [georeference]");
  unique_names(all.sensors, sensors);
  std::vector<std::string> materials;
  for (const auto& material : all.materials) materials.push_back(material.description.name);
  const auto resolve_material = [names = unique_names(all.materials, material_section())](auto& entry) {
    resolve(entry.description.material, entry.description.material_place, entry.table, "material", names,
            material_section().name());
  };
  for (auto& entry : all.terrains) {
    resolve_material(entry);
    if (entry.description.material_map) check_materials(*entry.description.material_map, materials);
  }
  for (auto& entry : all.sea_surface)
    if (!entry.description.material.empty()) resolve_material(entry);
  const Names trajectories = unique_names(all.trajectories, trajectory_section());
  for (auto& [object, table] : all.objects) {
    if (object.trajectory.empty()) continue;
    for (const auto& [key, is_set] :
         {std::pair("position_lat_lon_deg", object.position_lat_lon_deg.has_value()),
          std::pair("on_terrain_m", object.on_terrain_m.has_value())})
      if (is_set)
        throw InputError(
            table.place_of(key),
            fmt::format("'{}' excludes 'trajectory': the position of a moving object is relative "
                        "to the carrier of its trajectory: use 'position_m'",
                        key));
    resolve(object.trajectory, object.trajectory_place, table, "trajectory", trajectories,
            trajectory_section().name());
  }
  for (auto& entry : all.objects) {
    resolve_material(entry);
    if (const auto* mesh = std::get_if<MeshFile>(&entry.description.kind))
      for (const MaterialClass& c : mesh->materials) check_material_name(c.material, c.place, materials);
    if (entry.description.position_lat_lon_deg && all.georeference.empty()) {
      throw InputError(entry.table.place_of("position_lat_lon_deg"),
                       "'position_lat_lon_deg' needs the position of the frame on Earth: add [georeference]");
    }
    if (entry.description.on_terrain_m && all.terrains.empty()) {
      throw InputError(entry.table.place_of("on_terrain_m"),
                       "'on_terrain_m' needs a terrain: add [[terrain]]");
    }
  }
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

/// Returns the only description, or the default one with the whole file as its place.
template <class S>
S only(const std::vector<Entry<S>>& entries, const fs::path& file) {
  if (!entries.empty()) return entries.front().description;
  S s;
  s.place.file = file.string();
  return s;
}

/// Calls `call` with each section, in the order of the documentation.
template <class Call>
void for_each_section(const TomlSection<SensorDescription>& sensors, Call call) {
  call(georeference_section());
  call(water_section());
  call(sea_surface_section());
  call(material_section());
  call(reflectivity_section());
  call(relief_section());
  call(terrain_section());
  call(material_map_section());
  call(object_section());
  call(target_section());
  call(target_population_section());
  call(trajectory_section());
  call(sensors);
  call(assumed_mounting_section());
  call(processing_section());
  call(assumed_water_section());
  call(refinement_section());
  call(paths_section());
  call(scatterers_section());
  call(run_section());
}

/// Calls rename_former_key() for each table of a section. `path` is the name of the section without brackets,
/// such as "materials.relief".
void rename_in_tables(toml::node& node, std::string_view path, const SceneKey& key, TomlSource& source) {
  if (toml::array* tables = node.as_array()) {
    for (toml::node& table : *tables) rename_in_tables(table, path, key, source);
    return;
  }
  toml::table* table = node.as_table();
  if (table == nullptr) return;  // the section's reader rejects other values
  if (path.empty()) return rename_former_key(*table, key, source);
  const std::size_t dot = path.find('.');
  if (toml::node* inner = table->get(path.substr(0, dot)))
    rename_in_tables(*inner, dot == std::string_view::npos ? "" : path.substr(dot + 1), key, source);
}

/// Replaces former names of keys, so that all other functions see the present names only.
void rename_former_keys(toml::table& root, const TomlSection<SensorDescription>& sensors,
                        TomlSource& source) {
  for_each_section(sensors, [&](const auto& section) {
    for (const SceneKey& key : section.renamed_keys()) {
      std::string path;
      std::ranges::copy_if(section.name(), std::back_inserter(path),
                           [](char c) { return c != '[' && c != ']'; });
      rename_in_tables(root, path, key, source);
      if (path == "trajectories") rename_in_tables(root, "trajectory", key, source);
    }
  });
}

}  // namespace

std::vector<SceneKey> scene_file_keys(const SensorSections& kinds) {
  std::vector<SceneKey> keys{title_field().key};
  for_each_section(sensor_section(kinds), [&](const auto& section) {
    const std::vector<TomlKey> own = section.all_keys();
    keys.insert(keys.end(), own.begin(), own.end());
  });
  return keys;
}

std::vector<SceneSection> scene_file_sections(const SensorSections& kinds) {
  std::vector<SceneSection> sections{{{}, {}, "Keys before all sections."}};
  for_each_section(sensor_section(kinds), [&](const auto& section) {
    const std::vector<SceneSection> own = section.documentation();
    sections.insert(sections.end(), own.begin(), own.end());
  });
  return sections;
}

SceneDescription read_scene_file(const fs::path& file, const SensorSections& kinds, bool confined) {
  return read_scene_text(scene_text(file), file, kinds, confined);
}

SceneDescription read_scene_text(const std::string& text, const fs::path& file, const SensorSections& kinds,
                                 bool confined) {
  TomlSource source{file, {}, {}};
  toml::table root = parse_toml(text, source);
  const TomlSection<SensorDescription> sensors = sensor_section(kinds);
  rename_former_keys(root, sensors, source);
  apply_presets(root, source);
  SceneEntries all = read_entries(root, sensors, source);
  check_scene(all, sensors, file);

  SceneDescription scene = std::move(all.scene);
  scene.file = file;
  scene.warnings = std::move(source.warnings);
  if (!all.georeference.empty()) scene.georeference = all.georeference.front().description;
  scene.water = only(all.water, file);
  if (!all.sea_surface.empty()) scene.sea_surface = all.sea_surface.front().description;
  scene.paths = only(all.paths, file);
  scene.materials = descriptions(all.materials);
  scene.terrains = descriptions(all.terrains);
  scene.objects = descriptions(all.objects);
  scene.targets = descriptions(all.targets);
  scene.target_populations = descriptions(all.target_populations);
  scene.trajectories = descriptions(all.trajectories);
  scene.sensors = descriptions(all.sensors);
  scene.refinement = only(all.refinement, file);
  if (!all.refinement.empty()) scene.refinement.file_place = all.refinement.front().table.place_of("file");
  if (auto& seabed = scene.refinement.file) seabed = (file.parent_path() / *seabed).string();
  scene.scatterers = only(all.scatterers, file);
  scene.processing = only(all.processing, file);
  scene.run = only(all.run, file);

  scene.confined = confined;
  InputHash inputs(scene, text);
  for (const TomlSource::NamedFile& named : source.named_files) inputs.add(named);
  // `tubefoot refine` may be about to write this file.
  if (std::error_code ignored; scene.refinement.file && fs::exists(*scene.refinement.file, ignored))
    inputs.add({*scene.refinement.file, *scene.refinement.file, scene.refinement.file_place});
  scene.sha256 = inputs.hash();
  return scene;
}

}  // namespace tubefoot
