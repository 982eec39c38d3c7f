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

/// A part of a facet that is in the sector of pings and that none sees, hidden there by one facet.
struct ShadowPart {
  std::uint32_t in_sector = 0;   ///< pings that have it in their tubes and window
  std::uint32_t first_ping = 0;  ///< the first of them, as an index into the counted pings
  FacetId occluder = no_facet;   ///< what comes first on the way to its middle; no_facet if unclear
  std::uint16_t occluder_component = 0;
  std::vector<std::size_t> cells{};  ///< of FacetCoverage::cells
};

/// A facet that lies in the sector of a ping, measured in metres. Facets go by their numbers in all of the
/// scene (Site::number_of).
struct CoveredFacet {
  FacetCoverage coverage;
  std::uint16_t component = 0, material = 0;
  double area_m2 = 0;
  std::vector<glm::dvec3> corners_m;  ///< local frame
  std::vector<ShadowPart> shadows;

  std::vector<glm::dvec3> polygon_m(std::size_t cell) const;
  double cell_area_m2(std::size_t cell) const;
};

/// What a facet's row tells beside names and numbers, and in which order.
inline constexpr std::array<const char*, 8> facet_reals{
    "area_m2", "seen_m2", "never_m2", "shadow_m2", "seen_share", "never_share", "shadow_share", "mean_pings"};
std::array<double, facet_reals.size()> reals_of(const CoveredFacet& facet);

/// Fractions of more characters are left out of the tables.
inline constexpr std::size_t longest_fraction = 4000;

/// A GeoPackage with the layers coverage, shadows, facets and depths (docs/coverage.md), in the scene's CRS.
class CoverageFile {
 public:
  /// Throws std::runtime_error with GDAL's message where that fails.
  explicit CoverageFile(const Scene& scene);
  ~CoverageFile();
  void add(const CoveredFacet& facet, std::span<const CountedPing> pings);
  /// Writes it. Throws std::runtime_error naming the file.
  void write(const std::filesystem::path& file);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The same tables as CSV text: a row a facet, and a row for each number of pings that see some of a facet.
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
