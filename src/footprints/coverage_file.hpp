// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "geometry/footprints/coverage.hpp"
#include "scene/scene.hpp"

namespace tubefoot {

/// A ping that a coverage counts.
struct CountedPing {
  std::string sensor;
  std::size_t ping = 0;
};

/// A part of a facet that lies in the sector of pings but is visible in none of them, because one facet
/// hides it.
struct ShadowPart {
  std::uint32_t in_sector = 0;   ///< number of pings whose tubes and range gate contain the part
  std::uint32_t first_ping = 0;  ///< the first of these pings, as an index into the counted pings
  FacetId occluder = no_facet;   ///< first facet on the path to the middle of the part; no_facet if ambiguous
  std::uint16_t occluder_component = 0;
  std::vector<std::size_t> cells{};  ///< indices into FacetCoverage::cells
};

/// A facet that lies in the sector of a ping, with measures in metres. Facet numbers are those of the whole
/// scene (LoadedScene::number_of).
struct CoveredFacet {
  FacetCoverage coverage;
  std::uint16_t component = 0, material = 0;
  double area_m2 = 0;
  std::array<glm::dvec3, 3> vertices_m{};  ///< of the facet, in the local frame
  std::vector<glm::dvec3> corners_m;       ///< of the cells, in the local frame
  std::vector<ShadowPart> shadows;

  std::vector<glm::dvec3> polygon_m(std::size_t cell) const;
  double cell_area_m2(std::size_t cell) const;
};

/// Names of the real-valued columns of a facet's row, in the order of the file.
inline constexpr std::array<const char*, 8> facet_reals{
    "area_m2", "seen_m2", "never_m2", "shadow_m2", "seen_share", "never_share", "shadow_share", "mean_pings"};
std::array<double, facet_reals.size()> reals_of(const CoveredFacet& facet);

/// Largest number of characters of an exact fraction in the tables. The tables leave longer fractions out.
inline constexpr std::size_t longest_fraction = 4000;

/// A GeoPackage with the layers coverage, shadows, facets and depths (docs/footprints.md), in the CRS of the
/// scene.
class CoverageFile {
 public:
  /// Throws std::runtime_error with GDAL's message if GDAL cannot create the package.
  explicit CoverageFile(const Scene& scene);
  ~CoverageFile();
  void add(const CoveredFacet& facet, std::span<const CountedPing> pings);
  /// Writes the package. Throws std::runtime_error that names the file.
  void write(const std::filesystem::path& file);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The same tables as CSV text. The first table has one row per facet. The second has one row per facet and
/// number of pings that see a part of it.
class CoverageTables {
 public:
  explicit CoverageTables(const Scene& scene);
  void add(const CoveredFacet& facet);
  const std::string& facets() const { return facets_; }
  const std::string& depths() const { return depths_; }

 private:
  const Scene& scene_;
  std::string facets_, depths_;
};

}  // namespace tubefoot
