// SPDX-License-Identifier: GPL-3.0-or-later
// Computes bistatic echoes of single places: the centroids of the common parts of two tubes on a facet, and
// the hits of rays (quadratures.hpp).
#include <algorithm>
#include <glm/geometric.hpp>
#include <limits>

#include "engine/echo/path_on_facet.hpp"
#include "engine/echo/quadratures.hpp"
#include "engine/echo/sample_finder.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

class PlacedEcho {
 public:
  PlacedEcho(const CommonVisibility& visibility, const ReceiveBeams& beams, const RangeSamples& samples,
             const EchoModel& model, const Sink<double>& sink)
      : visibility_(visibility), beams_(beams), model_(model), sink_(sink), finder_(samples) {}

  /// Adds the common part of two tubes on each facet at its centroid.
  void whole(Binning binning) {
    for (std::size_t number = visibility_.first(); number < visibility_.end(); ++number) {
      stop_if_wanted();
      begin(number);
      for (std::uint32_t k = 0; k < facet_.piece_count;) {
        const SeenPart first = visibility_.part(number, facet_.first_piece + k);
        Measured sum;
        for (; k < facet_.piece_count; ++k) {
          const SeenPart part = visibility_.part(number, facet_.first_piece + k);
          if (part.tx_tube != first.tx_tube || part.rx_tube != first.rx_tube) break;
          assign(polygon_, part.corners_m, facet_.plane, frame_, bistatic_);
          sum.add(polygon_, path_.rx.over);
        }
        if (!(sum.area > 0)) continue;
        const glm::dvec2 centroid = sum.first + sum.weighed_offset / sum.area;
        const double half = (path_.tx.range(centroid) + path_.rx.range(centroid)) / 2;
        const bool at_once = binning == Binning::centroid || !(sum.far > sum.near);
        add(centroid, sum.area, first.tx_tube, first.rx_tube, at_once ? half : sum.near,
            at_once ? half : sum.far);
      }
    }
  }

  /// A hit represents the area solid_angle r^2 / sin(grazing).
  void hits() {
    for (const SharedHit& hit : visibility_.shared_hits()) {
      if (hit.seen != number_) begin(hit.seen);
      const double range = glm::length(hit.at_m);
      const glm::dvec2 at =
          bistatic_ == nullptr ? frame_.project(hit.at_m) : glm::dvec2(bistatic_->to_plane.at(hit.at_m));
      const double half = (path_.tx.range(at) + path_.rx.range(at)) / 2;
      if (!finder_.holds(half)) continue;
      const double area = hit.solid_angle_sr * (range * range) * range / facet_.plane.distance_m;
      add(at, area * flattened_, hit.transmit_tube, hit.receive_tube, half, half);
    }
  }

 private:
  /// Area, centroid and range interval of the polygons of a footprint. The centroid is summed relative to
  /// the first corner of the first polygon, which preserves the digits of small distant footprints.
  struct Measured {
    double area = 0, near = std::numeric_limits<double>::infinity(), far = 0;
    glm::dvec2 first{0}, weighed_offset{0};
    void add(const PlanarPolygon& polygon, const PathCutter::Receiver& receiver) {
      if (polygon.offsets.empty()) return;
      if (far == 0) first = polygon.first;
      const auto [shortest, longest] = PathCutter::half_paths_of(polygon, receiver);
      near = std::min(near, shortest);
      far = std::max(far, longest);
      const double own = std::max(tubefoot::area(polygon), 0.0);
      area += own;
      weighed_offset += own * (polygon.first - first + centroid_offset(polygon));
    }
  };

  void begin(std::size_t number) {
    number_ = number;
    facet_ = visibility_[number];
    bistatic_ = visibility_.bistatic(number);
    frame_ = PlaneFrame(facet_.plane);
    path_ = path_on(visibility_, number, frame_, model_);
    flattened_ = 1;
    if (bistatic_ != nullptr) {
      const glm::dvec2 u(bistatic_->to_plane.linear * frame_.u), v(bistatic_->to_plane.linear * frame_.v);
      flattened_ = std::abs(u.x * v.y - u.y * v.x);
    }
  }

  /// Adds the echo of an area at a place, uniformly over the half paths near to far.
  void add(glm::dvec2 at, double area_m2, std::uint32_t tx_tube, std::uint32_t rx_tube, double near_m,
           double far_m) {
    if (!beams_.in_one_fan(tx_tube, rx_tube)) return;
    const double tx = path_.tx.range(at), rx = path_.rx.range(at);
    PathOnFacet::Directions towards;
    if (path_.over_mirrors() || model_.patterns != nullptr) towards = path_.directions(at, tx, rx);
    double energy = path_.density_at(tx, rx) * path_.texture_at(at) * area_m2 * path_.passed(towards);
    if (model_.patterns == nullptr) return spread(beams_.of_tube[rx_tube], energy, tx_tube, near_m, far_m);
    const BeamPatterns& patterns = *model_.patterns;
    const double sent = patterns.transmit[patterns.fan_of_tube[rx_tube]].gain(towards.tx);
    energy *= sent;
    const auto [first, end] = patterns.beams_of_tube[rx_tube];
    for (std::uint32_t beam = first; beam < end; ++beam) {
      const double received = patterns.receive[beam].gain(towards.rx);
      if (patterns.receives(beam, sent * received)) spread(beam, energy * received, tx_tube, near_m, far_m);
    }
  }

  void spread(std::uint32_t beam, double energy, std::uint32_t tx_tube, double near_m, double far_m) {
    finder_.share(near_m, far_m, 0, 0, [&](std::size_t sample, double part) {
      sink_({beam, std::uint32_t(sample), part * energy, std::uint32_t(number_), tx_tube});
    });
  }

  const CommonVisibility& visibility_;
  const ReceiveBeams& beams_;
  const EchoModel& model_;
  const Sink<double>& sink_;
  SampleFinder finder_;
  // Values of the current facet.
  std::size_t number_ = std::numeric_limits<std::size_t>::max();
  SeenFacet facet_;
  const BistaticFacet* bistatic_ = nullptr;
  PlaneFrame frame_{FacetPlane{}};
  PathOnFacet path_;
  double flattened_ = 1;  // area on the plane of the path divided by the area that the transmit leg sees
  PlanarPolygon polygon_;
};

}  // namespace

void integrate_whole(const CommonVisibility& visibility, const ReceiveBeams& beams,
                     const RangeSamples& samples, const EchoModel& model, Binning binning,
                     const Sink<double>& sink) {
  PlacedEcho(visibility, beams, samples, model, sink).whole(binning);
}

void integrate_hits(const CommonVisibility& visibility, const ReceiveBeams& beams,
                    const RangeSamples& samples, const EchoModel& model, const Sink<double>& sink) {
  PlacedEcho(visibility, beams, samples, model, sink).hits();
}

}  // namespace tubefoot
