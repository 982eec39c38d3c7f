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

// What references through refracting water share: bins that hold no less and no more, samples whose borders
// are not quite certain, and who looks where.
namespace tubefoot {

/// A certified echo through refracting water.
struct RefractedReference {
  /// Its worst ratio is that of the bounds that are finite.
  CertifiedEcho certified;
  std::size_t unbounded = 0;  ///< bins that facets without a proven ray could reach: their bound is infinite
  /// How many bins there are, and how many bounds are wider than asked. Infinite bounds are among them.
  std::size_t bins = 0, bins_over = 0;
  double usual_excess = 0;  ///< factor by which the middle one of the finite bounds among these is too wide
};

/// Of a bin: no less, no more.
struct BinInterval {
  double lo = 0, hi = 0;
};
using BinIntervals = std::map<std::size_t, BinInterval>;

/// Samples that are cut `shift_m` before and after each border: number 2 k + 1 is surely of sample k, and 2 k
/// lies about the border between k - 1 and k.
class ShiftedSamples {
 public:
  ShiftedSamples(std::span<const double> borders, double step_m, double shift_m)
      : borders_(borders), shift_m_(shift_m), most_shift_m_(0.45 * step_m) {
    // An interval so wide that borders meet is one sample about each.
    const double shift = std::min(shift_m_, most_shift_m_);
    for (const double b : borders) {
      about_.push_back(std::max(b - shift, 0.0));
      about_.push_back(b + shift);
    }
  }
  std::span<const double> borders() const { return about_; }
  /// No place is surely of any sample.
  bool too_wide() const { return shift_m_ > most_shift_m_; }

  /// What a part of these samples has, from `lo` to `hi`, to the beam's bins.
  void add(std::uint32_t beam, std::uint32_t sample, double lo, double hi, BinIntervals& bins) const {
    const std::size_t row = borders_.size() - 1, first = beam * row;
    if (too_wide()) {
      const double from = about_[sample] - shift_m_ - most_shift_m_,
                   to = about_[sample + 1] + shift_m_ + most_shift_m_;
      for (std::size_t k = 0; k < row; ++k)
        if (borders_[k] <= to && borders_[k + 1] >= from) bins[first + k].hi += hi;
    } else if (sample % 2 == 1) {
      BinInterval& bin = bins[first + sample / 2];
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

/// What keeps its bounds from being as narrow as asked.
RefractedReference reference_of(CertifiedEcho echo, double tolerance);
/// What bins hold, added up in the order of the list.
RefractedReference reference_between(std::span<const BinIntervals> parts, const Echo& ordinary,
                                     double tolerance);

/// An echo whose bounds are infinite where nothing is known. `hold`: against what is asked; `targets_of`:
/// what bounds of one that surely has these energies are to be.
RefractedReference reference_of(CertifiedEcho echo, const std::function<void(CertifiedEcho&)>& hold,
                                const std::function<std::vector<double>(Echo&& least)>& targets_of);

/// Which facets have images that a tube may see.
class Looked {
 public:
  explicit Looked(std::span<const FacetEnclosure> facets);
  double most_gap_m() const { return most_travel_path_error_m_; }

  /// By increasing id; and in directions beside the tube, within reach.
  std::vector<FacetId> in(const Sector& tube, const SceneTree& tree, double beside_rad = 0) const;

 private:
  std::span<const FacetEnclosure> facets_;
  std::vector<std::pair<glm::dvec3, double>> balls_;  // about each image
  std::vector<FacetId> wide_;
  double usual_travel_path_error_m_ = 0, most_travel_path_error_m_ = 0;
};

/// Where the facets without a proven ray may be seen in a tube, and how soon.
class Unknown {
 public:
  Unknown(std::span<const FacetEnclosure> facets, const RayEnclosure& rays);
  /// Range beyond which nothing is known.
  double begins_m(const Sector& tube) const;

 private:
  struct Around {
    glm::dvec3 centre_m{0};
    double radius_m = 0, nearest_m = 0;
    DirectionBox launch;  // of rays to it
    bool anywhere = false;
  };
  /// Launched in the ball's vertical plane, up to most_turn_rad() higher or lower.
  void look_at(Around& ball) const;
  /// False only if no tube looks where a ray to the ball may be launched, or none comes as far.
  bool may_be_seen(const Around& ball, const Sector& tube) const;
  const RayEnclosure& rays_;
  std::vector<Around> balls_;
};

}  // namespace tubefoot
