// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "engine/echo/echo.hpp"
#include "engine/paths/image_tree.hpp"
#include "engine/paths/seen_bed.hpp"
#include "geometry/integrals/measure.hpp"

// What a point that scatters sends to a receiver by one more scattering. docs/paths.md
namespace tubefoot {

/// What an image of a receiver sees, by facet, in coordinates of the plane that the facet lies in: made once
/// for all points that light it.
class HeardFacets {
 public:
  /// `apex_m`: where the image is, in the frame of the points that will be asked about; `bed`: what it sees.
  HeardFacets(const Image& heard, glm::dvec3 apex_m, SeenBed bed);

  struct Piece {
    std::uint32_t tube = 0;   ///< of the image
    std::size_t seen_as = 0;  ///< bent facet, where rays are bent
    std::vector<glm::dvec2> corners;
    glm::dvec2 low{0}, high{0};
  };
  struct Facet {
    FacetId facet = 0;
    FacetPlane plane;  ///< from the image; in refracting water that may be behind it
    PlaneFrame frame{FacetPlane{}};
    std::vector<Piece> pieces;
  };
  /// Null if the side of a facet that a normal points to is not seen.
  const Facet* find(FacetId facet, glm::dvec3 normal) const;
  /// Null where rays are straight.
  const BentFacet* bent_of(const Piece& piece) const {
    return bent_.empty() ? nullptr : &bent_[piece.seen_as];
  }
  const Image& image() const { return image_; }
  glm::dvec3 apex_m() const { return apex_m_; }

 private:
  const Image& image_;
  glm::dvec3 apex_m_;
  std::vector<BentFacet> bent_;
  std::vector<Facet> facets_;  // by id
};

/// Who hears the last scattering: an image of a receiver, or those of both receivers of a staff in the same
/// mirrors.
struct Listener {
  HeardFacets upper;                 ///< or the only receiver
  std::optional<HeardFacets> lower;  ///< for the mean product of both
  /// Of a staff: the row of bins that energies go to; a product's real and imaginary part go to this and the
  /// next. None: those of the beams that hear them.
  std::optional<std::uint32_t> row;
  glm::dvec3 middle_m{0}, arm_m{0};  ///< of the staff's image: from its lower to its upper end
  double wavenumber_rad_m = 0;

  const Image& image() const { return upper.image(); }
  double largest() const {
    return lower ? std::min(image().largest, lower->image().largest) : image().largest;
  }
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
  PatchEcho(const EchoLaw& law, const ReceiveBeams& beams, double longest_m);

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
  /// sees. `local_m`: the local frame's coordinates of the frame's origin. A product has what both receivers
  /// hear in sample k; with `borders_m` above 0, where samples are that far apart but do not begin where
  /// these do, it is in that of the mean of both half paths, as much of it as both have in one on average.
  std::size_t add(const SeenBed& bed, const Point& point, const Listener& heard, glm::dvec3 local_m,
                  const RangeSamples& samples, double borders_m, SparseEnergy& out);

 private:
  using Polygon = std::vector<glm::dvec2>;

  /// The point, or a receiver, over the facet at hand.
  struct Over {
    const Image* image = nullptr;  ///< of a receiver
    double height = 0;             ///< over the plane
    glm::dvec2 foot{0};            ///< its foot point
    glm::dvec3 at_m{0};            ///< in the local frame
    /// Where rays are bent: where the plane's points lie and where they are seen, both from here.
    const BentFacet* bent = nullptr;
    LyingPlane lies, seen;
    double range(glm::dvec2 p) const {
      return bent != nullptr ? glm::length(seen.at(p)) : std::hypot(height, glm::length(p - foot));
    }
    /// Of the range, which is known.
    glm::dvec2 slope(glm::dvec2 p, double range) const {
      if (bent == nullptr) return (p - foot) / range;
      const glm::dvec3 at = seen.at(p);
      return glm::dvec2(glm::dot(at, seen.u), glm::dot(at, seen.v)) / range;
    }
  };
  /// A place as an end sees it.
  struct Met {
    double range = 0, sine = 0;
    glm::dvec3 direction{0};   ///< in which it is seen, unit vector
    glm::dvec3 lies_m{0};      ///< from the end
    double out = 1, home = 1;  ///< spreading and absorption over those of the straight way
  };
  Met meet(const Over& end, glm::dvec2 p) const;
  void bend(Over& end, const BentFacet& facet, glm::dvec3 from_heard_m) const;

  void clip(const std::vector<glm::dvec2>& by, Polygon& polygon);
  /// A corner of a piece of the lower receiver's, in the coordinates of the upper one's plane.
  glm::dvec2 from_lower(const HeardFacets::Facet& lower, glm::dvec2 corner) const;
  void halve(std::size_t level);
  void cut_into_samples(const Polygon& polygon, glm::dvec2 centre);
  void cut_for_both(const Polygon& polygon, double sample, double middle, glm::dvec2 gradient,
                    glm::dvec2 centre);
  void take(const Polygon& polygon, double sample);
  double fringe_rad_a_m(glm::dvec2 centre) const;
  void take_product(double sample, glm::dvec2 p, double upper, double lower);

  const EchoLaw& law_;
  const ReceiveBeams& beams_;
  double longest_m_, beta_;
  // Of the facet and the piece at hand.
  const Point* point_ = nullptr;
  const Listener* heard_ = nullptr;
  const HeardFacets::Facet* facet_ = nullptr;
  Over lit_;            // the point
  Over upper_, lower_;  // the lower one of a staff's, if a product is asked for
  double borders_m_ = 0;
  RangeSamples samples_;
  SparseEnergy* out_ = nullptr;
  std::uint32_t own_tube_ = 0;
  const ScatteringLaw* scattering_ = nullptr;
  const ReflectivityField* texture_ = nullptr;
  double mu_ = 0;
  std::vector<Polygon> levels_;
  Polygon below_, above_, rest_, before_, both_, common_;
};

}  // namespace tubefoot
