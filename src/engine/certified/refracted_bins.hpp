// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <limits>
#include <map>
#include <span>
#include <vector>

#include "engine/certified/apparent_enclosure.hpp"
#include "engine/certified/reference.hpp"
#include "engine/surface/sector.hpp"

// Common parts of references in stratified water: energy intervals by bin, and samples with uncertain
// borders. Other classes select the facets that a tube may see, and find the ranges beyond which nothing is
// proven. See docs/notes/certified-energies.md, section "Through refracting water".
namespace tubefoot {

/// Certified echo in stratified water.
struct RefractedReference {
  /// The worst ratio considers only finite bounds.
  CertifiedEcho certified;
  /// Number of bins with infinite bound, which facets without a proven ray may reach.
  std::size_t unbounded = 0;
  /// Number of bins, and number of bounds wider than requested. The latter includes infinite bounds.
  std::size_t bins = 0, bins_over = 0;
  double usual_excess = 0;  ///< median ratio of the finite bounds among these to the requested bounds
};

/// Bounds of energies by bin. Their sums are not rounded outwards, but widened at the end.
using BinIntervals = std::map<std::size_t, Interval>;
/// Returns the samples [first, second) that meet an interval of ranges.
std::pair<std::size_t, std::size_t> samples_between(std::span<const double> borders, double nearest_m,
                                                    double farthest_m);

/// Samples that are cut `shift_m` before and after each border. Sample 2 k + 1 certainly belongs to sample
/// k. Sample 2 k lies about the border between k - 1 and k.
class ShiftedSamples {
 public:
  ShiftedSamples(std::span<const double> borders, double step_m, double shift_m)
      : borders_(borders), shift_m_(shift_m), most_shift_m_(0.45 * step_m) {
    // If the shift is so wide that borders meet, each border has one sample about it.
    const double shift = std::min(shift_m_, most_shift_m_);
    for (const double b : borders) {
      about_.push_back(std::max(b - shift, 0.0));
      about_.push_back(b + shift);
    }
  }
  std::span<const double> borders() const { return about_; }
  /// Returns whether no position certainly belongs to any sample.
  bool too_wide() const { return shift_m_ > most_shift_m_; }

  /// Adds the energy of a part in one of these samples, between `lo` and `hi`, to the bins of a beam.
  void add(std::uint32_t beam, std::uint32_t sample, double lo, double hi, BinIntervals& bins) const {
    const std::size_t row = borders_.size() - 1, first = beam * row;
    if (too_wide()) {
      const double from = about_[sample] - shift_m_ - most_shift_m_,
                   to = about_[sample + 1] + shift_m_ + most_shift_m_;
      for (std::size_t k = 0; k < row; ++k)
        if (borders_[k] <= to && borders_[k + 1] >= from) bins[first + k].hi += hi;
    } else if (sample % 2 == 1) {
      Interval& bin = bins[first + sample / 2];
      bin.lo += lo;
      bin.hi += hi;
    } else {
      if (sample / 2 < row) bins[first + sample / 2].hi += hi;
      if (sample > 0) bins[first + sample / 2 - 1].hi += hi;
    }
  }

 private:
  std::span<const double> borders_;
  double shift_m_, most_shift_m_;
  std::vector<double> about_;
};

/// Compares an echo, whose unknown bounds are infinite, with a tolerance and counts the bins that miss it.
RefractedReference reference_of(CertifiedEcho echo, double tolerance);
/// The same for an echo with these requested bounds.
RefractedReference reference_of(
    CertifiedEcho echo, double tolerance,
    const std::function<std::vector<double>(const Echo& echo, double tolerance)>& targets);
/// Sums the bins in the order of the list and compares them with a tolerance.
RefractedReference reference_between(std::span<const BinIntervals> parts, const Echo& ordinary,
                                     double tolerance);

/// Selects the facets whose images a tube may see.
class Looked {
 public:
  explicit Looked(std::span<const FacetEnclosure> facets);
  double most_gap_m() const { return most_travel_path_error_m_; }

  /// Returns the facets by increasing id. `beside_rad` also includes directions next to the tube, within its
  /// reach.
  std::vector<FacetId> in(const Sector& tube, const SceneTree& tree, double beside_rad = 0) const;

 private:
  std::span<const FacetEnclosure> facets_;
  std::vector<std::pair<glm::dvec3, double>> balls_;  // around each image
  std::vector<FacetId> wide_;
  double usual_travel_path_error_m_ = 0, most_travel_path_error_m_ = 0;
};

/// Directions and ranges of the facets without a proven ray.
class Unknown {
 public:
  Unknown(std::span<const FacetEnclosure> facets, const RayEnclosure& rays);
  /// Returns the range beyond which nothing is proven in a tube.
  double begins_m(const Sector& tube) const;

 private:
  struct Around {
    glm::dvec3 centre_m{0};
    double radius_m = 0, nearest_m = 0;
    DirectionBox launch;  // launch directions of rays to the ball
    bool anywhere = false;
  };
  /// Sets the launch directions: in the vertical planes of the ball, up to most_turn_rad() higher or lower.
  void look_at(Around& ball) const;
  /// Returns false only if no tube contains a launch direction of a ray to the ball, or no tube reaches that
  /// far.
  bool may_be_seen(const Around& ball, const Sector& tube) const;
  const RayEnclosure& rays_;
  std::vector<Around> balls_;
};

}  // namespace tubefoot
