// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/refined_bed_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <stdexcept>

#include "files/file_hash.hpp"
#include "files/inlet.hpp"
#include "files/streamed_file.hpp"
#include "geometry/steps/stop.hpp"

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

/// Bytes that come in large pieces.
class Reader {
 public:
  Reader(std::istream& stream, std::size_t record) : stream_(stream), record_(record) {}
  /// Null at the end of what the file holds.
  const char* next() {
    if (at_ == buffer_.size()) {
      buffer_.resize(record_ * 65536);
      stream_.read(buffer_.data(), static_cast<std::streamsize>(std::min(buffer_.size(), left)));
      buffer_.resize(static_cast<std::size_t>(stream_.gcount()) / record_ * record_);
      left -= buffer_.size();
      at_ = 0;
      if (buffer_.empty()) return nullptr;
    }
    at_ += record_;
    return buffer_.data() + at_ - record_;
  }
  std::size_t left = 0;

 private:
  std::istream& stream_;
  std::size_t record_, at_ = 0;
  std::string buffer_;
};

}  // namespace

std::string bed_hash(const Scene& scene, const Ground& ground) {
  const FacetMesh& base = ground.base();
  Sha256 hash;
  const auto add = [&hash](const auto& values) {
    hash.update({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(values[0])});
  };
  const glm::dvec3 origin = scene.grid.origin_m();
  hash.update(fmt::format("bed 1, grid {} {} {} {}, cell {}, {}, {} {}\n", scene.grid.exponent(), origin.x,
                          origin.y, origin.z, ground.settings().cell_m, scene.description.refinement.displace,
                          base.vertices.size(), base.facets.size()));
  add(base.vertices);
  add(base.facets);
  add(base.material);
  // Fields are functions: what they are is what they say.
  constexpr std::size_t places = 4096;
  const std::size_t step = std::max<std::size_t>(1, base.facets.size() / places);
  for (std::size_t k = 0; k < std::max(places, base.facets.size()); k += step) {
    const std::size_t f = k % base.facets.size();
    const auto& field = scene.relief[base.material[f]];
    std::string text;
    put(text, field ? 1 : 0);
    if (field) {
      // Facets may be few: then more places on each.
      const double u = static_cast<double>(k % 61) / 61, v = (1 - u) * static_cast<double>(k % 53) / 53;
      const auto at = [&](int c) { return scene.grid.to_metres(base.vertices[base.facets[f][c]]); };
      put(text, field->height_m((1 - u - v) * at(0) + u * at(1) + v * at(2)));
    }
    hash.update(text);
  }
  return hash.hex_digest();
}

void write_refined_bed(const std::filesystem::path& file, const RefinedMesh& bed, const Scene& scene,
                       const Ground& ground) {
  StreamedFile stream(file);
  std::string bytes = header(bed_hash(scene, ground), bed.mesh.vertices.size(), bed.mesh.facets.size());
  const auto flush = [&](std::size_t above) {
    if (bytes.size() <= above) return;
    stream.append(bytes);
    bytes.clear();
  };
  constexpr std::size_t piece = 1 << 20;
  for (const GridPoint& p : bed.mesh.vertices) {
    stop_if_wanted();
    const glm::dvec3 m = scene.grid.to_metres(p);
    for (int k = 0; k < 3; ++k) put(bytes, m[k]);
    flush(piece);
  }
  for (std::size_t f = 0; f < bed.mesh.facets.size(); ++f) {
    stop_if_wanted();
    put(bytes, std::uint8_t{3});
    for (const VertexId v : bed.mesh.facets[f]) put(bytes, v);
    put(bytes, bed.mesh.material[f]);
    put(bytes, bed.mesh.component[f]);
    put(bytes, bed.parent[f]);
    flush(piece);
  }
  flush(0);
  stream.close();
}

RefinedMesh read_refined_bed(const std::filesystem::path& file, const SourcePlace& place, const Scene& scene,
                             const Ground& ground) {
  const auto refused = [&](const std::string& why) {
    return InputError(place, fmt::format("'{}' {}: make it with 'tubefoot refine {} -o {}'", file.string(),
                                         why, scene.description.file.string(), file.string()));
  };
  std::error_code error;
  if (!std::filesystem::exists(file, error)) throw refused("is not there");
  InputFile input(file, place);
  std::istream& stream = input.stream();
  std::string head;
  std::size_t vertices = 0, facets = 0;
  const auto number_after = [&](std::string_view words) {
    const std::size_t at = head.find(words);
    std::size_t value = 0;
    if (at != std::string::npos)
      for (std::size_t k = at + words.size(); k < head.size() && head[k] >= '0' && head[k] <= '9'; ++k)
        value = std::min<std::size_t>(10 * value + static_cast<std::size_t>(head[k] - '0'), 1ull << 40);
    return value;
  };
  for (std::string line; head.size() < 4096 && std::getline(stream, line);) {
    head += line + '\n';
    if (line == "end_header") break;
  }
  vertices = number_after("element vertex ");
  facets = number_after("element face ");
  const std::string hash = bed_hash(scene, ground);
  if (head.find("\ncomment refined bed ") == std::string::npos) throw refused("is no refined bed");
  if (head.find("\n" + hash_line(hash) + "\n") == std::string::npos)
    throw refused("is the refined bed of another scene, or of other keys in [relief]");
  if (head != header(hash, vertices, facets)) throw refused("is no refined bed of this version");
  const auto here = stream.tellg();
  stream.seekg(0, std::ios::end);
  if (static_cast<std::size_t>(stream.tellg() - here) != vertices * vertex_bytes + facets * face_bytes)
    throw refused("is cut short or longer than it says");
  stream.seekg(here);

  RefinedMesh bed;
  bed.mesh.vertices.reserve(vertices);
  bed.mesh.facets.reserve(facets);
  bed.mesh.material.reserve(facets);
  bed.mesh.component.reserve(facets);
  bed.parent.reserve(facets);
  Reader points(stream, vertex_bytes);
  points.left = vertices * vertex_bytes;
  while (const char* at = points.next()) {
    stop_if_wanted();
    glm::dvec3 p;
    for (int k = 0; k < 3; ++k) p[k] = take<double>(at);
    try {
      bed.mesh.vertices.push_back(scene.grid.snap(p));
    } catch (const GridRangeError&) {
      throw refused("has a vertex that is not in the scene");
    }
  }
  Reader faces(stream, face_bytes);
  faces.left = facets * face_bytes;
  while (const char* at = faces.next()) {
    stop_if_wanted();
    const auto corners = take<std::uint8_t>(at);
    std::array<VertexId, 3> facet;
    for (VertexId& v : facet) v = take<VertexId>(at);
    const auto material = take<std::uint16_t>(at), component = take<std::uint16_t>(at);
    const auto parent = take<FacetId>(at);
    if (corners != 3 || *std::max_element(facet.begin(), facet.end()) >= vertices ||
        material >= scene.relief.size() || component >= scene.report.components.size() ||
        parent >= scene.mesh.facets.size())
      throw refused("is damaged");
    bed.mesh.facets.push_back(facet);
    bed.mesh.material.push_back(material);
    bed.mesh.component.push_back(component);
    bed.parent.push_back(parent);
  }
  return bed;
}

}  // namespace tubefoot
