// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
#include <vector>

#include "footprints/coverage_file.hpp"
#include "scene/scene.hpp"

namespace tubefoot {

/// The covered facets as a mesh with the values of the table of facets. Each facet is one triangle.
class CoverageMesh {
 public:
  explicit CoverageMesh(const Scene& scene) : scene_(scene) {}
  void add(const CoveredFacet& facet);
  /// Writes VTK's XML PolyData: values are arrays of the cells. Throws std::runtime_error that names the
  /// file.
  void write_vtp(const std::filesystem::path& file) const;
  /// Writes binary glTF 2.0 with the y axis upwards: values are attributes of the corners, and colours show
  /// the mean number of pings. Throws std::runtime_error that names the file.
  void write_glb(const std::filesystem::path& file) const;

 private:
  struct Row {
    std::array<glm::dvec3, 3> corners_m;
    FacetId facet = 0;
    std::uint32_t component = 0, material = 0, most_pings = 0;
    std::array<double, facet_reals.size()> reals{};
  };
  glm::dvec3 centre_m() const;

  const Scene& scene_;
  std::vector<Row> rows_;
};

}  // namespace tubefoot
