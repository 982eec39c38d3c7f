// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <functional>
#include <map>
#include <vector>

#include "engine/certified/certified_cells.hpp"
#include "engine/certified/reference.hpp"
#include "geometry/footprints/shared_footprints.hpp"
#include "geometry/numbers/interval.hpp"
#include "geometry/steps/steps.hpp"

// The driver of all references. A source gives the visible polygons: tubes of one apex, facets that two
// apexes share, or pieces that two receivers have in common. A function object encloses the energies of a
// polygon. The driver cuts polygons into the cells of their textures and runs the tasks in parallel. It
// keeps their sums in a fixed order, and narrows the parts until the bounds meet the tolerance. Include this
// heavy header only in .cpp files.
namespace tubefoot {

constexpr double least_allowed = 1e-300;

/// Facets of a run are usually neighbours, with the same samples.
constexpr std::size_t facets_in_run = 32;

/// Enclosures by bin.
template <class N>
using Bins = std::map<std::size_t, N>;

/// Enclosures by bin for tasks with many beams. Only samples with contributions have rows.
class BinSums {
 public:
  BinSums(std::size_t beams, std::size_t samples) : beams_(beams), rows_(samples) {}

  Interval& at(std::size_t beam, std::size_t sample) {
    std::vector<Interval>& row = rows_[sample];
    if (row.empty()) row.resize(beams_);
    return row[beam];
  }
  /// `total`: by beam, then by sample.
  void add_to(std::vector<Interval>& total) const {
    for (std::size_t sample = 0; sample < rows_.size(); ++sample)
      for (std::size_t beam = 0; beam < rows_[sample].size(); ++beam) {
        const Interval& part = rows_[sample][beam];
        if (part.hi != 0 || part.lo != 0) total[beam * rows_.size() + sample] += part;
      }
  }

 private:
  std::size_t beams_;
  std::vector<std::vector<Interval>> rows_;
};

/// Data that all parts of a reference share.
struct CertifiedRequest {
  /// `echo_model` must outlive this object. Throws std::invalid_argument as certified_textures() does.
  CertifiedRequest(const EchoModel& echo_model, const RangeSamples& samples);
  CertifiedRequest(const EchoModel& echo_model, const RangeSamples& samples, double requested,
                   std::vector<double> targets)
      : CertifiedRequest(echo_model, samples) {
    tolerance = requested;
    target = std::move(targets);
  }

  std::size_t row() const { return borders.size() - 1; }  ///< number of samples
  /// Returns the beams [first, second) that receive a tube. `beam_of_tube` is for ideal beams.
  std::pair<std::uint32_t, std::uint32_t> beams_of(std::uint32_t tube,
                                                   std::span<const std::uint32_t> beam_of_tube) const;
  TexturedPolygon textured(const CertifiedPolygon& polygon, std::uint16_t material,
                           const FacetMap& lies) const;

  const EchoModel& model;
  std::vector<std::shared_ptr<const CertifiedTexture>> textures;  ///< by material
  std::vector<double> borders;                                    ///< of the samples
  double step_m;
  Ball beta_per_m;             ///< one-way absorption
  double tolerance = 0;        ///< to which parts are enclosed
  std::vector<double> target;  ///< permitted half-width of each bin's enclosure
  /// Whether some texture has too many cells, so that a smaller tolerance does not help.
  mutable std::atomic<bool> is_coarse = false;
};

/// An echo model with patterns in the directions of its path's ends.
struct PatternsOfEnds {
  explicit PatternsOfEnds(const EchoModel& of) : model(of) {
    if (of.patterns == nullptr) return;
    patterns = as_images_have(*of.patterns, of.path);
    model.patterns = &patterns;
  }
  PatternsOfEnds(const PatternsOfEnds&) = delete;
  PatternsOfEnds& operator=(const PatternsOfEnds&) = delete;
  EchoModel model;
  BeamPatterns patterns;
};

/// Encloses items in parallel tasks of `in_task` successive items. Returns the sums of the tasks in their
/// order, so that the total does not depend on the threads. `enclose(item, sums)`: adds an item.
template <class Sums, class Enclose>
std::vector<Sums> enclose_tasks(const char* what, std::size_t items, std::size_t in_task, const Sums& empty,
                                const Enclose& enclose) {
  std::vector<Sums> by_task((items + in_task - 1) / in_task, empty);
  Steps steps(what, items);
  tbb::parallel_for(std::size_t{0}, by_task.size(), [&](std::size_t task) {
    for (std::size_t item = task * in_task; item < std::min((task + 1) * in_task, items); ++item) {
      steps.done();
      enclose(item, by_task[task]);
    }
  });
  return by_task;
}

/// Encloses the visible pieces of each tube of one apex: `enclose(tube, context, seen, sums)`.
template <class Sums, class Enclose>
std::vector<Sums> enclose_tubes(const FacetMesh& mesh, const SceneTree& tree, const TubeSet& tubes,
                                const VisibilityOptions& options, const Enclose& enclose) {
  struct Buffers {
    VisibilityScratch visibility;
    TubeVisibility seen;
  };
  tbb::enumerable_thread_specific<Buffers> threads;
  return enclose_tasks("tubes", tubes.tubes.size(), 1, Sums(), [&](std::size_t tube, Sums& sums) {
    auto& [visibility, seen] = threads.local();
    see(mesh, tree, tubes, std::uint32_t(tube), options, visibility, seen);
    enclose(std::uint32_t(tube), NameContext{mesh, tubes.apex, seen.rays}, seen, sums);
  });
}

/// A piece that a transmitter and a receiver share.
struct ReceivedPiece {
  std::span<const glm::dvec3> corners_m;  ///< as the transmitter sees them (SharedFootprints)
  std::span<const glm::dvec3> rests_m;    ///< of these corners, or empty
  glm::dvec3 receiver_m;

  ReceivedPiece(const SharedFootprints& shared, const SharedPiece& piece)
      : corners_m(std::span(shared.corners_m).subspan(piece.first, piece.count)),
        rests_m(shared.corner_rests_m.empty()
                    ? std::span<const glm::dvec3>()
                    : std::span(shared.corner_rests_m).subspan(piece.first, piece.count)),
        receiver_m(shared.receiver_m) {}
};

/// Calls `add(piece, beams)` for the pieces of a facet that two ends share and some beam receives.
template <class Add>
void each_received(const CertifiedRequest& request, const ReceiveBeams& beams, const SharedFootprints& shared,
                   const SharedFacet& facet, const Add& add) {
  for (std::uint32_t k = 0; k < facet.piece_count; ++k) {
    stop_if_wanted();
    const SharedPiece& piece = shared.pieces[facet.first_piece + k];
    if (!beams.in_one_fan(piece.transmit_tube, piece.receive_tube)) continue;
    const auto received = request.beams_of(piece.receive_tube, beams.of_tube);
    if (received.first == received.second) continue;
    add(piece, received);
  }
}

/// Calls `add(upper piece, lower piece)` for the pieces of a facet in the same transmit tube.
template <class Add>
void each_common(const SharedFootprints& by_upper, const SharedFacet& upper, const SharedFootprints& by_lower,
                 const SharedFacet& lower, const Add& add) {
  for (std::uint32_t k = 0; k < upper.piece_count; ++k)
    for (std::uint32_t m = 0; m < lower.piece_count; ++m) {
      const SharedPiece &one = by_upper.pieces[upper.first_piece + k],
                        &two = by_lower.pieces[lower.first_piece + m];
      if (one.transmit_tube != two.transmit_tube) continue;
      stop_if_wanted();
      add(ReceivedPiece(by_upper, one), ReceivedPiece(by_lower, two));
    }
}

/// Function that returns the requested bounds for an echo with these energies.
using Targets = std::function<std::vector<double>(const Echo& echo, double tolerance)>;

/// Counts the bins whose bound exceeds the requested bound, as compare_with() does for energies.
void compare_with(CertifiedEcho& certified, double tolerance, const Targets& targets);

/// Throws std::invalid_argument for an arithmetic that is not exact.
void require_exact(const VisibilityOptions& options);
/// Throws std::invalid_argument for facets whose apparent positions differ between two apexes.
void require_one_position(std::span<const BistaticFacet> bistatic);

/// Sets the energy and the bound of a bin from its enclosure. An infinite enclosure keeps the energy.
void take_enclosure(CertifiedEcho& certified, std::size_t bin, const Ball& total, bool is_energy = true);
/// Converts enclosures to energies and bounds.
CertifiedEcho enclosed_echo(const Echo& ordinary, std::span<const Ball> total);

/// Repeats the enclosure until the tolerance is met, at most twice. The distribution of a bin's tolerance
/// over its parts is a guess, which may fail for a bin with very many small parts. Each repetition narrows
/// all parts by the ratio that the worst bin requires. `enclose()` encloses the echo to the request's
/// tolerance. `ordinary` guides the work.
CertifiedEcho refined_until_tolerance(CertifiedRequest& request, const Echo& ordinary, double tolerance,
                                      const Targets& targets, const std::function<CertifiedEcho()>& enclose);

}  // namespace tubefoot
