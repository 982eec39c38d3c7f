// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "engine/echo/bistatic_echo.hpp"
#include "engine/paths/image_tree.hpp"
#include "geometry/integrals/measure.hpp"

// What a point that scatters sends to a receiver by one more scattering. docs/paths.md
namespace tubefoot {

/// What an image of a receiver sees, by facet, in coordinates of the facet's plane: made once for all points
/// that light it.
class HeardFacets {
 public:
  /// `apex_m`: where the image is, in the frame of the points that will be asked about.
  HeardFacets(const FacetMesh& mesh, const Image& heard, glm::dvec3 apex_m, double unit_m);

  struct Piece {
    std::uint32_t tube = 0;  ///< of the image
    std::vector<glm::dvec2> corners;
    glm::dvec2 low{0}, high{0};
  };
  struct Facet {
    FacetId facet = 0;
    FacetPlane plane;  ///< seen from the image
    PlaneFrame frame{FacetPlane{}};
    std::vector<Piece> pieces;
  };
  /// Null if it is not seen.
  const Facet* find(FacetId facet) const;
  const Image& image() const { return image_; }
  glm::dvec3 apex_m() const { return apex_m_; }

 private:
  const Image& image_;
  glm::dvec3 apex_m_;
  std::vector<Facet> facets_;  // by id
};

/// Bins of which few are not empty.
class SparseEnergy {
 public:
  void add(std::size_t bin, double energy) {
    if (bin >= values_.size()) values_.resize(bin + 1, 0);
    if (values_[bin] == 0 && energy != 0) touched_.push_back(bin);
    values_[bin] += energy;
  }
  /// Bins that are not empty, in order, as `take(bin, energy)`; empties them.
  template <class Take>
  void drain(const Take& take) {
    std::sort(touched_.begin(), touched_.end());
    for (const std::size_t bin : touched_)
      if (const double energy = std::exchange(values_[bin], 0); energy != 0) take(bin, energy);
    touched_.clear();
  }

 private:
  std::vector<double> values_;
  std::vector<std::size_t> touched_;
};

/// Integrates over what both a point and an image of the receiver see. Polygons are intersected in doubles
/// (what either sees is exact), cut until they are small against their distances from both ends, then into
/// samples along straight lines of equal path, and each part is taken at its centroid: the error goes with
/// the square of the size. One per thread.
class PatchEcho {
 public:
  /// No part is longer than `longest_m`. Beams, fans and patterns are those of the true receiver's tubes.
  PatchEcho(const EchoLaw& law, const BistaticBeams& beams, double longest_m);

  struct Point {
    glm::dvec3 at_m{0};      ///< the point, or its image
    const MirrorLoss& loss;  ///< of its mirrors
    glm::dvec3 axis{0};      ///< normal of the facet that it lies on, as the image sees it
    const ScatteringLaw* scattering = nullptr;
    std::uint32_t fan = 0;
  };
  /// Adds, for a point that scatters 1 J/sr along its normal, the energy of beam b and sample k to bin
  /// b * samples.count + k of `out`. Sample k holds half paths, from the point to the receiver,
  /// first + k step on; the first may be negative. Returns how many polygons met. `seen`: what the point
  /// sees. `local_m`: the local frame's coordinates of the frame's origin.
  std::size_t add(const SharedFootprints& seen, const Point& point, const HeardFacets& heard,
                  glm::dvec3 local_m, const RangeSamples& samples, SparseEnergy& out);

 private:
  using Polygon = std::vector<glm::dvec2>;

  void halve(std::size_t level);
  void cut_into_samples(const Polygon& polygon, glm::dvec2 centre);
  void take(const Polygon& polygon, double sample);

  const EchoLaw& law_;
  const BistaticBeams& beams_;
  double longest_m_, beta_;
  // Of the facet and the piece at hand.
  const Point* point_ = nullptr;
  const HeardFacets::Facet* facet_ = nullptr;
  const Image* image_ = nullptr;
  RangeSamples samples_;
  SparseEnergy* out_ = nullptr;
  std::uint32_t own_tube_ = 0;
  glm::dvec2 foot_{0};         // of the point
  double distance_ = 0;        // of the point from the plane
  glm::dvec3 image_local_{0};  // the receiver's image in the local frame
  const ScatteringLaw* scattering_ = nullptr;
  const ReflectivityField* texture_ = nullptr;
  double mu_ = 0;
  std::vector<Polygon> levels_;
  Polygon below_, above_, rest_;
};

}  // namespace tubefoot
