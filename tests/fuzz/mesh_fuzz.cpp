// SPDX-License-Identifier: GPL-3.0-or-later
// Fuzzes mesh files of all formats: a file is rejected, or gives facets of finite points that are all used.
// For glTF, the fuzzer covers the parts that tubefoot reads before Assimp.
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <vector>

#include "files/gltf_file.hpp"
#include "files/shown.hpp"
#include "fuzz.hpp"
#include "geometry/mesh/facet_mesh.hpp"
#include "scene/meshes/mesh_file.hpp"

namespace tubefoot::fuzz {
namespace {

void check(const ComponentMesh& mesh) {
  if (mesh.triangles.empty()) finding("a mesh without a facet");
  std::vector<char> used(mesh.points_m.size(), 0);
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t corner : triangle) {
      if (corner >= mesh.points_m.size()) finding("a corner out of range");
      used[corner] = 1;
    }
  if (std::find(used.begin(), used.end(), 0) != used.end()) finding("a point that no facet uses");
  for (const glm::dvec3& p : mesh.points_m)
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) finding("a point at no place");
  for (const std::string& warning : mesh.warnings) check_message(shown(warning));
}

/// Builds the mesh on the grid, as load_scene() does.
void build(const ComponentMesh& mesh) {
  glm::dvec3 lo = mesh.points_m.front(), hi = lo;
  for (const glm::dvec3& p : mesh.points_m) lo = glm::min(lo, p), hi = glm::max(hi, p);
  try {
    MeshBuilder builder(WorldGrid::fitting(lo, hi));
    builder.add(mesh.points_m, mesh.triangles, 0, 0);
    MeshReport report;
    const FacetMesh built = builder.finish(report);
    if (built.facets.size() != mesh.triangles.size()) finding("a facet was lost");
    const auto facets = static_cast<FacetId>(built.facets.size());
    if (facets_outside_halfedge(built, 0, facets) > facets) finding("more facets refused than there are");
  } catch (const GridRangeError&) {
  }
}

}  // namespace
}  // namespace tubefoot::fuzz

/// A byte for the format, then the file.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tubefoot;
  const fuzz::TimeLimit limit;
  fuzz::Bytes bytes(data, size);
  constexpr std::array names{"m.obj", "m.ply", "m.stl", "m.off", "m.gltf"};
  const std::uint32_t format = bytes.below(names.size());
  const auto file = fuzz::scratch_file(names[format], bytes.rest());
  fuzz::may_refuse([&] {
    if (format + 1 == names.size()) {
      gltf_buffers(file);
      return;
    }
    const ComponentMesh mesh = read_mesh_file(file);
    fuzz::check(mesh);
    fuzz::build(mesh);
  });
  return 0;
}
