// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/refined_surface_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "files/file_hash.hpp"
#include "files/input_registry.hpp"
#include "files/streamed_file.hpp"
#include "geometry/steps/stop.hpp"
#include "scene/surfaces/material_map.hpp"
#include "scene/tiled_scene.hpp"

// This file writes, reads and hashes refined seabeds as binary PLY files. A file lists its faces in the
// order of their parent facets, so that the parts of some facets can be found by binary search.

namespace tubefoot {
namespace {

static_assert(std::endian::native == std::endian::little, "the file is little-endian");

constexpr std::size_t vertex_bytes = 3 * sizeof(double), face_bytes = 1 + 3 * 4 + 2 * 2 + 4;

template <class T>
void put(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

template <class T>
T take(const char*& at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  at += sizeof value;
  return value;
}

std::string hash_line(const std::string& hash) { return "comment refined bed " + hash; }

std::string header(const std::string& hash, std::size_t vertices, std::size_t facets) {
  return fmt::format(
      "ply\nformat binary_little_endian 1.0\n{}\ncomment east, north, up in metres (tubefoot refine)\n"
      "element vertex {}\nproperty double x\nproperty double y\nproperty double z\n"
      "element face {}\nproperty list uchar int vertex_indices\nproperty ushort material\n"
      "property ushort component\nproperty uint base_facet\nend_header\n",
      hash_line(hash), vertices, facets);
}

/// Calls `use` with the corners on the grid and the material of each facet before relief, in the order of
/// facet numbers.
template <class Use>
void for_base_facets(const Scene& scene, const Use& use) {
  FacetId next = 0;
  const auto use_mesh = [&](std::size_t component) {
    for (; next < scene.mesh.facets.size() && scene.mesh.component[next] == component; ++next) {
      const auto& [a, b, c] = scene.mesh.facets[next];
      use(std::array{scene.mesh.vertices[a], scene.mesh.vertices[b], scene.mesh.vertices[c]},
          scene.mesh.material[next]);
    }
  };
  for (std::size_t i = 0; i < scene.report.components.size(); ++i) {
    if (scene.tiled.empty() || !scene.tiled[i].tiles) {
      use_mesh(i);
      continue;
    }
    const TerrainTiles& tiles = *scene.tiled[i].tiles;
    for (std::size_t row = 0; row < tiles.rows(); ++row) {
      stop_if_wanted();
      std::vector<std::uint32_t> chosen;
      for (std::size_t k = row * tiles.columns(); k < (row + 1) * tiles.columns(); ++k)
        if (tiles.tiles()[k].facets > 0) chosen.push_back(static_cast<std::uint32_t>(k));
      ComponentMesh mesh = tiles.read(chosen);
      if (scene.tiled[i].map)
        scene.tiled[i].map->apply(mesh);
      else
        mesh.materials.assign(mesh.triangles.size(), scene.tiled[i].material);
      std::vector<GridPoint> points;
      for (const glm::dvec3& p : mesh.points_m) points.push_back(scene.grid.snap(p));
      for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
        const auto& [a, b, c] = mesh.triangles[f];
        use(std::array{points[a], points[b], points[c]}, mesh.materials[f]);
      }
    }
  }
}

/// Selects the places at which the relief's heights enter the hash: some thousands in total. A scene of few
/// facets has many places per facet.
class HashedPlaces {
 public:
  explicit HashedPlaces(const Scene& scene) {
    // Counts facets as the files contain them, so that the hash does not depend on how terrain is read.
    std::uint64_t facets = 0;
    for (const ComponentReport& component : scene.report.components) facets += component.facets_in_file;
    constexpr std::uint64_t wanted = 4096;
    a_facet_ = facets < wanted ? wanted / std::max<std::uint64_t>(facets, 1) : 1;
    stride_ = std::max<std::uint64_t>(facets / wanted, 1);
  }
  std::uint64_t on(std::uint64_t facet) const { return facet % stride_ == 0 ? a_facet_ : 0; }
  /// Returns the weights of two corners at the k-th place, uniformly over the facet. They are multiples of
  /// the first two powers of the inverse plastic number (Roberts 2018), folded into the triangle.
  static std::pair<double, double> weights(std::uint64_t k) {
    const auto part = [k](double step) {
      const double at = 0.5 + static_cast<double>(k) * step;
      return at - std::floor(at);
    };
    const double u = part(0.7548776662466927), v = part(0.5698402909980532);
    return u + v > 1 ? std::pair(1 - u, 1 - v) : std::pair(u, v);
  }

 private:
  std::uint64_t a_facet_, stride_;
};

}  // namespace

std::string seabed_hash(const Scene& scene, double cell_m) {
  Sha256 hash;
  const glm::dvec3 origin = scene.grid.origin_m();
  hash.update(fmt::format("bed 3, grid {} {} {} {}, cell {}, {}\n", scene.grid.exponent(), origin.x, origin.y,
                          origin.z, cell_m, scene.description.refinement.displace));
  const HashedPlaces hashed(scene);
  std::uint64_t number = 0;
  std::string bytes;
  for_base_facets(scene, [&](const std::array<GridPoint, 3>& corners, std::uint16_t material) {
    for (const GridPoint& p : corners) put(bytes, p);
    put(bytes, material);
    // Relief fields are functions, which their values identify.
    const std::uint64_t places = hashed.on(number);
    const auto& field = scene.relief[material];
    if (places > 0) put(bytes, field ? 1 : 0);
    for (std::uint64_t k = number; field && k < number + places; ++k) {
      const auto [u, v] = HashedPlaces::weights(k);
      const auto at = [&](std::size_t c) { return scene.grid.to_metres(corners[c]); };
      put(bytes, field->height_m((1 - u - v) * at(0) + u * at(1) + v * at(2)));
    }
    ++number;
    if (bytes.size() < 1 << 16) return;
    stop_if_wanted();
    hash.update(bytes);
    bytes.clear();
  });
  hash.update(bytes);
  hash.update(fmt::format("{} facets\n", number));
  return hash.hex_digest();
}

void write_refined_seabed(const std::filesystem::path& file, const RefinedMesh& seabed, const Scene& scene,
                          const SurfaceMesh& surface_mesh) {
  StreamedFile stream(file);
  std::string bytes = header(seabed_hash(scene, surface_mesh.settings().cell_m), seabed.mesh.vertices.size(),
                             seabed.mesh.facets.size());
  const auto flush = [&](std::size_t above) {
    if (bytes.size() <= above) return;
    stream.append(bytes);
    bytes.clear();
  };
  constexpr std::size_t piece = 1 << 20;
  for (const GridPoint& p : seabed.mesh.vertices) {
    stop_if_wanted();
    const glm::dvec3 m = scene.grid.to_metres(p);
    for (int k = 0; k < 3; ++k) put(bytes, m[k]);
    flush(piece);
  }
  for (std::size_t f = 0; f < seabed.mesh.facets.size(); ++f) {
    stop_if_wanted();
    put(bytes, std::uint8_t{3});
    for (const VertexId v : seabed.mesh.facets[f]) put(bytes, v);
    put(bytes, seabed.mesh.material[f]);
    put(bytes, seabed.mesh.component[f]);
    put(bytes, seabed.parent[f]);
    flush(piece);
  }
  flush(0);
  stream.close();
}

InputError RefinedSurfaceFile::refused(const std::string& why) const {
  return InputError(place_, fmt::format("'{}' {}: create it with 'tubefoot refine {} -o {}'", file_.string(),
                                        why, scene_file_.string(), file_.string()));
}

RefinedSurfaceFile::RefinedSurfaceFile(std::filesystem::path file, const SourcePlace& place,
                                       const Scene& scene, double cell_m)
    : file_(std::move(file)),
      scene_file_(scene.description.file),
      place_(place),
      grid_(scene.grid),
      materials_(scene.relief.size()),
      components_(scene.report.components.size()) {
  std::error_code error;
  if (!std::filesystem::exists(file_, error)) throw refused("is not there");
  InputFile input(file_, place_);
  std::istream& stream = input.stream();
  std::string head;
  const auto number_after = [&](std::string_view words) {
    const std::size_t at = head.find(words);
    std::uint64_t value = 0;
    if (at != std::string::npos)
      for (std::size_t k = at + words.size(); k < head.size() && head[k] >= '0' && head[k] <= '9'; ++k)
        value = std::min<std::uint64_t>(10 * value + static_cast<std::uint64_t>(head[k] - '0'), 1ull << 40);
    return value;
  };
  for (std::string line; head.size() < 4096 && std::getline(stream, line);) {
    head += line + '\n';
    if (line == "end_header") break;
  }
  vertices_ = number_after("element vertex ");
  facets_ = number_after("element face ");
  const std::string hash = seabed_hash(scene, cell_m);
  if (head.find("\ncomment refined bed ") == std::string::npos) throw refused("is not a refined seabed");
  if (head.find("\n" + hash_line(hash) + "\n") == std::string::npos)
    throw refused("is the refined seabed of another scene, or was refined with other keys in [relief]");
  if (head != header(hash, vertices_, facets_))
    throw refused("is a refined seabed of another version of tubefoot");
  first_byte_ = head.size();
  if (input.size() != first_byte_ + vertices_ * vertex_bytes + facets_ * face_bytes)
    throw refused("is shorter or longer than its header states");
}

/// Reads records of the open file.
class RefinedSurfaceFile::Reader {
 public:
  explicit Reader(const RefinedSurfaceFile& of)
      : of_(of), input_(of.file_, of.place_), faces_at_(of.first_byte_ + of.vertices_ * vertex_bytes) {}

  /// Returns the first face that is part of this facet or of a later one.
  std::uint64_t first_face_of(FacetId base) {
    std::uint64_t lo = 0, hi = of_.facets_;
    while (lo < hi) {
      const std::uint64_t middle = lo + (hi - lo) / 2;
      char bytes[sizeof(FacetId)];
      take_bytes(faces_at_ + (middle + 1) * face_bytes - sizeof bytes, bytes, sizeof bytes);
      const char* at = bytes;
      if (take<FacetId>(at) < base)
        lo = middle + 1;
      else
        hi = middle;
    }
    return lo;
  }
  template <class Use>
  void faces(std::uint64_t first, std::uint64_t end, const Use& use) {
    records(faces_at_, face_bytes, first, end, use);
  }
  template <class Use>
  void vertices(std::uint64_t first, std::uint64_t end, const Use& use) {
    records(of_.first_byte_, vertex_bytes, first, end, use);
  }

 private:
  template <class Use>
  void records(std::uint64_t from, std::size_t size, std::uint64_t first, std::uint64_t end, const Use& use) {
    constexpr std::uint64_t at_once = 1 << 16;
    for (; first < end; first += at_once) {
      stop_if_wanted();
      const std::uint64_t count = std::min(at_once, end - first);
      buffer_.resize(count * size);
      take_bytes(from + first * size, buffer_.data(), buffer_.size());
      for (std::uint64_t k = 0; k < count; ++k) use(buffer_.data() + k * size);
    }
  }
  void take_bytes(std::uint64_t at, char* to, std::size_t count) {
    std::istream& stream = input_.stream();
    stream.seekg(static_cast<std::streamoff>(at));
    stream.read(to, static_cast<std::streamsize>(count));
    if (!stream) throw of_.refused("can no longer be read");
  }

  const RefinedSurfaceFile& of_;
  InputFile input_;
  std::uint64_t faces_at_;
  std::string buffer_;
};

RefinedMesh RefinedSurfaceFile::read(std::span<const FacetId> base) const {
  Reader reader(*this);
  RefinedMesh seabed;
  FacetMesh& mesh = seabed.mesh;
  for (std::size_t k = 0; k < base.size();) {
    std::size_t end = k + 1;
    while (end < base.size() && base[end] == base[end - 1] + 1) ++end;
    FacetId next = base[k];  // first facet that has no face so far
    reader.faces(reader.first_face_of(base[k]), reader.first_face_of(base[end - 1] + 1), [&](const char* at) {
      const auto corners = take<std::uint8_t>(at);
      std::array<VertexId, 3> facet;
      for (VertexId& v : facet) v = take<VertexId>(at);
      const auto material = take<std::uint16_t>(at), component = take<std::uint16_t>(at);
      const auto parent = take<FacetId>(at);
      const bool is_in_order = parent == next || (parent + 1 == next && parent >= base[k]);
      if (corners != 3 || *std::ranges::max_element(facet) >= vertices_ || material >= materials_ ||
          component >= components_ || !is_in_order || parent > base[end - 1])
        throw refused("is damaged");
      next = parent + 1;
      mesh.facets.push_back(facet);
      mesh.material.push_back(material);
      mesh.component.push_back(component);
      seabed.parent.push_back(parent);
    });
    if (next != base[end - 1] + 1) throw refused("is damaged");
    k = end;
  }
  // Vertices that are close together in the file are read at once, together with the vertices between them.
  struct Run {
    std::uint64_t first, end;
    std::size_t at;  // index in `points`
  };
  constexpr std::uint64_t near = 64;
  std::vector<VertexId> named;
  for (const auto& facet : mesh.facets) named.insert(named.end(), facet.begin(), facet.end());
  std::ranges::sort(named);
  std::vector<Run> runs;
  for (const VertexId v : named)
    if (!runs.empty() && v < runs.back().end + near)
      runs.back().end = std::max<std::uint64_t>(runs.back().end, v + std::uint64_t{1});
    else
      runs.push_back({v, v + std::uint64_t{1}, 0});
  named = {};
  std::vector<GridPoint> points;
  for (Run& run : runs) {
    run.at = points.size();
    reader.vertices(run.first, run.end, [&](const char* at) {
      glm::dvec3 p;
      for (int k = 0; k < 3; ++k) p[k] = take<double>(at);
      try {
        points.push_back(grid_.snap(p));
      } catch (const GridRangeError&) {
        throw refused("has a vertex that does not belong to the scene");
      }
    });
  }
  // Numbers the vertices in the order in which facets use them, which is their order in the file.
  constexpr VertexId unnamed = std::numeric_limits<VertexId>::max();
  std::vector<VertexId> number(points.size(), unnamed);
  for (auto& facet : mesh.facets)
    for (VertexId& v : facet) {
      const Run& run = *std::prev(std::ranges::upper_bound(runs, std::uint64_t{v}, {}, &Run::first));
      const std::size_t k = run.at + (v - run.first);
      if (number[k] == unnamed) {
        number[k] = static_cast<VertexId>(mesh.vertices.size());
        mesh.vertices.push_back(points[k]);
      }
      v = number[k];
    }
  return seabed;
}

}  // namespace tubefoot
