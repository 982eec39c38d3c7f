// SPDX-License-Identifier: GPL-3.0-or-later
// Fuzzes files that tubefoot writes and resumes from: checkpoints, refined seabeds, and shards of a run,
// each damaged or arbitrary.
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>

#include "files/usage_error.hpp"
#include "fuzz.hpp"
#include "run/checkpoint/ping_file.hpp"
#include "run/partial_run.hpp"
#include "run/refined_surface_file.hpp"
#include "sensors/kinds/scene_file.hpp"

namespace tubefoot::fuzz {
namespace {

StoreLayout layout() {
  StoreLayout made;
  made.sensors = {{5, {{"energy", 70}, {"energy_bound", 70}}},
                  {5, {{"energy", 3}, {"energy_bound", 3}}},
                  {2, {{"energy", 100}, {"energy_bound", 100}}}};
  made.groups = {{{0, 1}, 5}, {{2}, 2}};
  return made;
}

nlohmann::ordered_json requested() { return {{"scene_hash", "0123"}, {"reference", nullptr}}; }

nlohmann::ordered_json identity() {
  return {{"asked", requested()}, {"run", json_of(RunRequest())}, {"pings", layout().units()}};
}

/// A file of pings as the program writes it, with some finished pings, or with another layout or identity.
std::string good_store(std::uint32_t kind) {
  const auto file = scratch_folder() / "made.pings";
  StoreLayout made = layout();
  if (kind == 1)
    for (StoreLayout::Sensor& sensor : made.sensors) sensor.channels.pop_back();
  {
    std::filesystem::remove(file);
    PingStore store(made, std::make_unique<PingFile>(file), kind == 2 ? "{" : identity().dump());
    for (const std::size_t ping : {0, 1, 3}) {
      PingValues values;
      values.clear(made, 0);
      for (const std::size_t sensor : {0, 1})
        std::ranges::fill(values.of(sensor, "energy"), 1e-9 * double(ping + 1));
      store.finish(0, ping, {}, values);
    }
  }
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Changes bytes of a file, truncates it or extends it, according to the input.
std::string damaged(std::string text, Bytes& bytes) {
  while (!bytes.empty()) {
    const std::uint32_t how = bytes.below(8);
    const std::size_t at = bytes.take<std::uint32_t>() % (text.size() + 1);
    if (how == 0)
      text.resize(at);
    else if (how == 1)
      text.append(bytes.below(200), char(bytes.take<std::uint8_t>()));
    else if (how == 2 && at + 8 <= text.size()) {
      const auto word = bytes.take<std::uint64_t>();
      std::memcpy(text.data() + at, &word, sizeof word);
    } else if (how == 3)
      text.insert(at, bytes.text(bytes.below(16)));
    else if (how == 4 && at < 128 && at < text.size())
      text[at] = char(bytes.take<std::uint8_t>());
    else if (at < text.size())
      text[at] = char(text[at] ^ bytes.take<std::uint8_t>());
  }
  return text;
}

template <class Read>
void may_refuse_to_resume(const Read& read) {
  try {
    may_refuse(read);
  } catch (const UsageError& error) {
    check_message(error.what());
  }
}

void pings(Bytes& bytes) {
  static const std::array<std::string, 3> good{good_store(0), good_store(1), good_store(2)};
  const std::uint32_t kind = bytes.below(4);
  const bool resume = bytes.below(2) == 0;
  const auto output = scratch_folder() / "run";
  scratch_file("run.partial", kind == 3 ? std::string(bytes.rest()) : damaged(good[kind], bytes));
  may_refuse_to_resume([&] {
    PartialRun partial(output, resume);
    if (partial.kept()) resumed(*partial.kept(), requested(), {});
    const auto store = partial.open(layout(), identity());
    if (store->done_units() > layout().units()) finding("more pings done than there are");
    PingValues silent;
    for (std::size_t group = 0; group < 2; ++group) {
      silent.clear(layout(), group);
      for (std::size_t ping = 0; ping < layout().groups[group].pings; ++ping)
        if (!store->done(group, ping)) store->finish(group, ping, {}, silent);
    }
    partial.remove();
  });
}

PingValues some_ping(std::size_t group, std::size_t ping) {
  const StoreLayout all = layout();
  PingValues values;
  values.clear(all, group);
  for (const std::size_t sensor : all.groups[group].sensors)
    for (const std::span<double> some : {values.of(sensor, "energy"), values.of(sensor, "energy_bound")})
      for (std::size_t k = ping; k < some.size(); k += 3) some[k] = 1e-9 * double(k + 1);
  return values;
}

std::string good_part() {
  const auto path = scratch_folder() / "made.part";
  std::filesystem::remove(path);
  {
    PingFile file(path, "shard");
    file.begin(identity().dump());
    for (const PingUnit unit : {PingUnit{0, 3}, PingUnit{1, 0}, PingUnit{0, 1}})
      file.append(packed_ping(layout(), unit, {}, some_ping(unit.group, unit.ping)));
  }
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void part_file(Bytes& bytes) {
  static const std::string good = good_part();
  const auto path =
      scratch_file("run.part-1-of-2", bytes.below(8) == 0 ? std::string(bytes.rest()) : damaged(good, bytes));
  try {
    PingFile file(path, "shard");
    file.look_through(layout());
    PingValues values;
    for (std::size_t group = 0; group < 2; ++group)
      for (std::size_t ping = 0; ping < layout().groups[group].pings; ++ping) {
        if (!file.has({group, ping})) continue;
        try {
          unpack_ping(file.read({group, ping}), layout(), values);
        } catch (const DamagedPing& error) {
          check_message(error.what());
        }
      }
    file.begin(identity().dump());
    const PingUnit last{1, 1};
    file.append(packed_ping(layout(), last, {}, some_ping(last.group, last.ping)));
    file.look_through(layout());
    if (!file.has(last)) finding("a ping that was just put there is not found");
  } catch (const UnusableStore& error) {
    check_message(error.what());
  }
}

/// A seabed of four facets with relief.
struct Seabed {
  Scene scene;
  std::optional<SurfaceMesh> surface_mesh;
  std::string text;

  Seabed() : scene(load_scene(description())) {
    SurfaceSettings settings;
    settings.cell_m = 0.5;
    surface_mesh.emplace(scene.mesh, scene.grid, scene.relief, settings);
    const auto file = scratch_folder() / "made.ply";
    write_refined_seabed(file, surface_mesh->everywhere({}), scene, *surface_mesh);
    std::ifstream stream(file, std::ios::binary);
    text.assign(std::istreambuf_iterator<char>(stream), {});
  }

 private:
  static SceneDescription description() {
    return read_scene_text(R"([[materials]]
name = "sand"
[[materials.relief]]
kind = "fbm"
tile_m = 8
resolution_m = 0.5
rms_height_m = 0.1
hurst = 0.8
[[terrain]]
kind = "flat"
width_m = 3
length_m = 3
cell_m = 3
[trajectory]
kind = "fixed"
[[sensors]]
name = "camera"
kind = "didson"
)",
                           scratch_folder() / "scene.toml");
  }
};

void refined_seabed(Bytes& bytes) {
  static const Seabed good;
  const auto file =
      scratch_file("bed.ply", bytes.below(4) == 0 ? std::string(bytes.rest()) : damaged(good.text, bytes));
  may_refuse([&] {
    std::vector<FacetId> all(good.scene.mesh.facets.size());
    std::iota(all.begin(), all.end(), FacetId{0});
    const RefinedMesh seabed =
        RefinedSurfaceFile(file, {"scene.toml", 1, 1}, good.scene, good.surface_mesh->settings().cell_m)
            .read(all);
    for (std::size_t f = 0; f < seabed.mesh.facets.size(); ++f) {
      for (const VertexId v : seabed.mesh.facets[f])
        if (v >= seabed.mesh.vertices.size()) finding("a corner out of range");
      if (seabed.parent.at(f) >= good.scene.mesh.facets.size()) finding("a facet of no facet");
    }
  });
}

}  // namespace
}  // namespace tubefoot::fuzz

/// A byte for the kind of file, one or two bytes for the variant of a good file, then the damage or the
/// file.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tubefoot;
  const fuzz::TimeLimit limit;
  fuzz::Bytes bytes(data, size);
  const std::uint32_t kind = bytes.below(3);
  if (kind == 0)
    fuzz::pings(bytes);
  else if (kind == 1)
    fuzz::refined_seabed(bytes);
  else
    fuzz::part_file(bytes);
  return 0;
}
