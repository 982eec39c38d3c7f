// SPDX-License-Identifier: GPL-3.0-or-later
// Fuzzes worlds of other engines, SDF or Stonefish, next to a mesh, and a model that they may include. A
// world is rejected, or gives objects and sonars at finite positions.
#include <algorithm>
#include <cmath>

#include "exchange/readers/scene_readers.hpp"
#include "files/shown.hpp"
#include "fuzz.hpp"

namespace tubefoot::fuzz {
namespace {

void check(const Placement& placed) {
  for (int c = 0; c < 3; ++c)
    if (!std::isfinite(placed.position_m[c]) || !(std::abs(glm::length(placed.turn[c]) - 1) < 1e-6))
      finding("a place that is none");
}

}  // namespace
}  // namespace tubefoot::fuzz

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  using namespace tubefoot::fuzz;
  scratch_file("rock.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  std::filesystem::create_directories(scratch_folder() / "other");
  scratch_file("other/model.config", "<model><sdf version='1.6'>../model.sdf</sdf></model>");
  return 0;
}

/// The text of the world and, after a byte 0, the text of the model that model://other and model.sdf name.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tubefoot;
  const fuzz::TimeLimit limit;
  const std::string_view text = fuzz::Bytes(data, size).rest();
  const std::size_t end = std::min(text.find('\0'), text.size());
  const auto file = fuzz::scratch_file("world.sdf", text.substr(0, end));
  fuzz::scratch_file("model.sdf", text.substr(std::min(end + 1, text.size())));
  fuzz::may_refuse([&] {
    const ImportedScene scene = read_world(file, {fuzz::scratch_folder()});
    for (const ImportedObject& object : scene.objects) fuzz::check(object.placed);
    for (const ImportedSensor& sensor : scene.sensors) fuzz::check(sensor.own);
    for (const std::string& line : scene.noticed) fuzz::check_message(shown(line));
    scene_text(scene);
  });
  return 0;
}
