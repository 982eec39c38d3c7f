// SPDX-License-Identifier: GPL-3.0-or-later
// Writes a scene as glTF 2.0: a JSON file and a binary buffer with float coordinates about the centre of each
// piece. Each sonar is a node, with a camera if its fan is narrow enough.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "exchange/plain_number.hpp"
#include "exchange/writers/scene_writers.hpp"
#include "files/checked_file.hpp"
#include "files/json_text.hpp"
#include "files/streamed_file.hpp"
#include "sensors/model/angles.hpp"

namespace tubefoot {
namespace {

using Json = nlohmann::ordered_json;
static_assert(std::endian::native == std::endian::little, "glTF's buffers are little-endian");

Json list(glm::dvec3 v) {
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  return {plain(v.x, largest), plain(v.y, largest), plain(v.z, largest)};
}

Json list(const std::array<double, 4>& quaternion) {
  Json values = Json::array();
  for (const double value : quaternion) values.push_back(plain(value, 1));
  return values;
}

/// The minimum range of a sonar is not a clipping plane, because nearer surfaces cast shadows. A ratio of
/// 1e5 leaves a depth buffer of floats with a resolution of a hundredth at the far end.
double camera_near_plane_m(const ExchangedSonar& sonar) {
  constexpr double usual_m = 1e-3, most_ratio = 1e5;
  return plain(std::max(usual_m, sonar.range_max_m / most_ratio));
}

class Gltf {
 public:
  Gltf(const ExchangedScene& scene, const std::filesystem::path& folder)
      : scene_(scene), axes_(axes_of(ExchangeFormat::gltf)), bytes_(folder / "scene.bin") {
    root_["asset"] = {{"version", "2.0"}, {"generator", "tubefoot"}};
    root_["scene"] = 0;
    root_["nodes"] = Json::array();
    for (const ExchangedMaterial& material : scene.materials) {
      const double grey = grey_of(material);
      root_["materials"].push_back(
          {{"name", material.name},
           {"pbrMetallicRoughness",
            {{"baseColorFactor", {grey, grey, grey, 1}}, {"metallicFactor", 0}, {"roughnessFactor", 1}}},
           {"doubleSided", true},
           {"extras", {{"lambert_db", material.lambert_db}}}});
    }
  }

  WrittenScene write(const std::filesystem::path& folder) {
    for (const ExchangedPiece& piece : scene_.pieces) add(piece);
    for (const ExchangedSonar& sonar : scene_.sonars) add(sonar);
    Json nodes = Json::array();
    for (std::size_t k = 0; k < root_["nodes"].size(); ++k) nodes.push_back(k);
    root_["scenes"] =
        Json::array({{{"name", scene_.title.empty() ? "scene" : scene_.title}, {"nodes", nodes}}});
    if (bytes_.size() > 0)
      root_["buffers"] = Json::array({{{"uri", "scene.bin"}, {"byteLength", bytes_.size()}}});
    root_["asset"]["extras"] = {{"axes", axes_words(ExchangeFormat::gltf)},
                                {"largest_rounding_m", largest_rounding_m_},
                                {"sound_speed_m_s", scene_.sound_speed_m_s},
                                {"ping", scene_.ping}};
    bytes_.close();
    write_file(folder / "scene.gltf", std::string_view(text_of(root_) + "\n"));
    return {
        {"scene.gltf", "scene.bin"},
        {fmt::format("glTF stores floats: each piece has its own origin in whole metres, and vertices "
                     "are rounded by up to {:.3g} m in each coordinate",
                     largest_rounding_m_),
         "sonars are nodes with their parameters in 'extras' and, where possible, with a camera that has "
         "the same field of view",
         "'znear' of a camera is its clipping plane, in front of which nothing casts a shadow. The minimum "
         "range of the sonar is 'range_min_m' in 'extras': remove nearer echoes after rendering"}};
  }

 private:
  std::size_t view(std::uint64_t begin, int target) {
    root_["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", begin}, {"byteLength", bytes_.size() - begin}, {"target", target}});
    return root_["bufferViews"].size() - 1;
  }

  void add(const ExchangedPiece& piece) {
    constexpr int floats = 5126, unsigned_ints = 5125, vertices = 34962, indices = 34963;
    glm::dvec3 lo(std::numeric_limits<double>::infinity()), hi = -lo;
    for (const glm::dvec3& p : piece.points_m) lo = glm::min(lo, p), hi = glm::max(hi, p);
    const glm::dvec3 ours = glm::round((lo + hi) / 2.0), centre = axes_.world.to_theirs(ours);
    glm::vec3 least(std::numeric_limits<float>::infinity()), most = -least;
    const std::uint64_t first = bytes_.size();
    std::vector<glm::vec3> points;
    points.reserve(piece.points_m.size());
    for (const glm::dvec3& p : piece.points_m) {
      const glm::dvec3 exact = axes_.world.to_theirs(p) - centre;
      const glm::vec3 rounded(exact);
      const glm::dvec3 off = glm::abs(glm::dvec3(rounded) + centre - axes_.world.to_theirs(p));
      largest_rounding_m_ = std::max({largest_rounding_m_, off.x, off.y, off.z});
      least = glm::min(least, rounded);
      most = glm::max(most, rounded);
      points.push_back(rounded);
    }
    append(points.data(), points.size() * sizeof(glm::vec3));
    root_["accessors"].push_back({{"bufferView", view(first, vertices)},
                                  {"componentType", floats},
                                  {"count", points.size()},
                                  {"type", "VEC3"},
                                  {"min", {least.x, least.y, least.z}},
                                  {"max", {most.x, most.y, most.z}}});
    const std::size_t positions = root_["accessors"].size() - 1;
    const std::uint64_t second = bytes_.size();
    append(piece.triangles.data(), piece.triangles.size() * sizeof piece.triangles[0]);
    root_["accessors"].push_back({{"bufferView", view(second, indices)},
                                  {"componentType", unsigned_ints},
                                  {"count", 3 * piece.triangles.size()},
                                  {"type", "SCALAR"}});
    root_["meshes"].push_back({{"name", piece.name},
                               {"primitives", Json::array({{{"attributes", {{"POSITION", positions}}},
                                                            {"indices", positions + 1},
                                                            {"material", piece.material}}})}});
    root_["nodes"].push_back(
        {{"name", piece.name}, {"mesh", root_["meshes"].size() - 1}, {"translation", list(centre)}});
  }

  void add(const ExchangedSonar& sonar) {
    const Placement placed = to_theirs(sonar.placement, axes_.world, axes_.sonar);
    Json figures{{"kind", sonar.kind},
                 {"beam_azimuths_deg", sonar.azimuth_deg},
                 {"horizontal_deg", sonar.horizontal_deg},
                 {"vertical_deg", sonar.vertical_deg},
                 {"range_min_m", sonar.range_min_m},
                 {"range_max_m", sonar.range_max_m},
                 {"samples", sonar.samples},
                 {"frequency_khz", sonar.frequency_khz},
                 {"sound_speed_m_s", sonar.sound_speed_m_s},
                 {"absorption_db_per_km", sonar.absorption_db_per_km}};
    if (sonar.shape == ExchangedSonar::Shape::two_sides) {
      figures["along_track_deg"] = sonar.along_track_deg;
      figures["depression_deg"] = sonar.depression_deg;
    }
    Json node{{"name", sonar.name},
              {"translation", list(placed.position_m)},
              {"rotation", list(quaternion_xyzw(placed.turn))},
              {"extras", {{"tubefoot_sonar", figures}}}};
    // The image of a camera is planar, so that it cannot be as wide as some fans.
    constexpr double widest_deg = 170;
    if (sonar.shape == ExchangedSonar::Shape::fan && sonar.horizontal_deg < widest_deg &&
        sonar.vertical_deg < widest_deg) {
      const double width = std::tan(radians(sonar.horizontal_deg) / 2),
                   height = std::tan(radians(sonar.vertical_deg) / 2);
      root_["cameras"].push_back({{"name", sonar.name},
                                  {"type", "perspective"},
                                  {"perspective",
                                   {{"yfov", radians(sonar.vertical_deg)},
                                    {"aspectRatio", plain(width / height)},
                                    {"znear", camera_near_plane_m(sonar)},
                                    {"zfar", sonar.range_max_m}}}});
      node["camera"] = root_["cameras"].size() - 1;
    }
    root_["nodes"].push_back(node);
  }

  void append(const void* data, std::size_t size) {
    bytes_.append(std::string_view(static_cast<const char*>(data), size));
  }

  const ExchangedScene& scene_;
  const EngineAxes& axes_;
  StreamedFile bytes_;
  Json root_;
  double largest_rounding_m_ = 0;
};

}  // namespace

WrittenScene write_gltf_scene(const ExchangedScene& scene, const std::filesystem::path& folder) {
  return Gltf(scene, folder).write(folder);
}

}  // namespace tubefoot
