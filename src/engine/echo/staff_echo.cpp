// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/echo/staff_echo.hpp"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <stdexcept>

#include "engine/echo/texture_cells.hpp"
#include "engine/law/radial_law.hpp"
#include "geometry/integrals/convex_clip.hpp"
#include "geometry/integrals/path_cut.hpp"
#include "geometry/work/stop.hpp"

namespace tubefoot {
namespace {

/// Relative to the energy without interference.
constexpr double tolerance = 1e-8, tolerance_with_corners = 1e-6;
constexpr int most_refinements_with_tables = 12;
/// Facets that a task takes: part of the summation's order.
constexpr std::size_t facets_per_task = 64;

std::vector<TubeVisibility> look(const FacetMesh& mesh, const SceneTree& tree, const TubeSet& tubes,
                                 const VisibilityOptions& options) {
  std::vector<TubeVisibility> seen(tubes.tubes.size());
  tbb::enumerable_thread_specific<VisibilityScratch> threads;
  tbb::parallel_for(std::uint32_t{0}, std::uint32_t(seen.size()), [&](std::uint32_t tube) {
    see(mesh, tree, tubes, tube, options, threads.local(), seen[tube]);
  });
  return seen;
}

/// The largest angle, at most 1, over which something that grows so into the complex plane changes little.
template <class Growth>
double resolution_of(const Growth& growth) {
  double angle = 1;
  while (growth(angle / 2) > 3 && angle > 1e-6) angle /= 2;
  return angle;
}

/// A receiver on the staff, as it looks at the facet at hand.
struct End {
  glm::dvec3 at_m{0};   // relative to the transmitter
  double distance = 0;  // of the facet's plane
  glm::dvec2 foot{0};   // in the plane
  double range(glm::dvec2 p) const { return std::hypot(distance, p.x - foot.x, p.y - foot.y); }
};

/// Sums one fan's echo; one per task.
class StaffIntegral {
 public:
  StaffIntegral(const StaffHistory& history, const Fringe& staff, std::uint32_t fan, std::uint32_t beam,
                std::span<const double> borders, const EchoLaw& law)
      : history_(history),
        staff_(staff),
        sent_(law.patterns->transmit[fan]),
        heard_(law.patterns->receive[beam]),
        law_(law),
        borders_(borders),
        cutter_(borders),
        beta_(two_way_absorption_per_m(law.absorption_db_per_m) / 2) {
    ends_[0].at_m = staff.baseline_m / 2 * staff.axis;
    ends_[1].at_m = -ends_[0].at_m;
    patterns_rad_ = resolution_of([&](double y) {
      double most = 0;
      for (const Directivity& beam_sent : sent_.beams) most = std::max(most, beam_sent.growth(y));
      return most + heard_.growth(y);
    });
    const auto is_table = [](const Directivity& d) { return d.kind == Directivity::Kind::table; };
    tables_ = is_table(heard_) || std::any_of(sent_.beams.begin(), sent_.beams.end(), is_table);
    weighed_ = heard_.kind != Directivity::Kind::uniform || sent_.beams.size() != 1 ||
               sent_.beams[0].kind != Directivity::Kind::uniform;
    fringe_rad_ = resolution_of([&](double y) { return staff.wavenumber_rad_m * staff.baseline_m * y; });
    const std::size_t samples = borders.size() - 1;
    for (auto& sum : energy_) sum.assign(samples, 0);
    cross_.assign(3 * samples, 0);
  }

  /// Energies of one receiver.
  void add_energy(std::size_t end, const SharedFacet& facet) {
    if (!place(facet)) return;
    const SharedFootprints& shared = end == 0 ? history_.by_upper : history_.by_lower;
    for (std::uint32_t k = 0; k < facet.piece_count; ++k) {
      const SharedPiece& piece = shared.pieces[facet.first_piece + k];
      polygon_.assign(std::span(shared.corners_m).subspan(piece.first, piece.count), plane_, frame_);
      integrate(std::span(&ends_[end], 1), energy_[end]);
    }
  }

  /// What is common to both. `upper` and `lower` are the same facet.
  void add_product(const SharedFacet& upper, const SharedFacet& lower) {
    if (!place(upper)) return;
    const SharedFootprints &by_upper = history_.by_upper, &by_lower = history_.by_lower;
    PlanarPolygon other;
    for (std::uint32_t k = 0; k < upper.piece_count; ++k) {
      const SharedPiece& one = by_upper.pieces[upper.first_piece + k];
      const auto corners = std::span(by_upper.corners_m).subspan(one.first, one.count);
      for (std::uint32_t m = 0; m < lower.piece_count; ++m) {
        const SharedPiece& two = by_lower.pieces[lower.first_piece + m];
        if (two.transmit_tube != one.transmit_tube) continue;
        stop_if_wanted();
        polygon_.assign(corners, plane_, frame_);
        other.assign(std::span(by_lower.corners_m).subspan(two.first, two.count), plane_, frame_);
        if (clip_convex(polygon_, other)) integrate(ends_, cross_);
      }
    }
  }

  const std::vector<double>& energy(std::size_t end) const { return energy_[end]; }
  const std::vector<double>& cross() const { return cross_; }

 private:
  /// False where a receiver looks along the plane or at its back, which only the grid's half units can do.
  bool place(const SharedFacet& facet) {
    plane_ = {facet.plane_normal, facet.transmit_distance_m};
    frame_ = PlaneFrame(plane_);
    for (End& end : ends_) {
      end.distance = plane_.distance_m + glm::dot(plane_.normal, end.at_m);
      end.foot = frame_.project(end.at_m);
      if (!(end.distance > 0)) return false;
    }
    along_ = {glm::dot(frame_.u, staff_.axis), glm::dot(frame_.v, staff_.axis),
              -plane_.distance_m * glm::dot(plane_.normal, staff_.axis)};
    scattering_ = law_.law_of(facet.facet);
    own_ = law_.facet_factor.empty() ? 1 : law_.facet_factor[facet.facet];
    if (scattering_ == nullptr) own_ *= law_.material_mu[law_.material[facet.facet]] * plane_.distance_m;
    cornered_ = scattering_ != nullptr && (scattering_->pieces().size() > 1 || scattering_->is_pointed());
    smooth_rad_ = patterns_rad_;
    if (scattering_ != nullptr)
      smooth_rad_ = std::min(smooth_rad_, resolution_of([&](double y) { return scattering_->growth(y); }));
    if (cornered_) smooth_rad_ = std::min(smooth_rad_, 0.1);  // rules of few nodes do not see a corner
    texture_ = law_.texture(facet.facet);
    if (texture_ != nullptr) lies_ = law_.lying(facet.facet, plane_, frame_);
    return true;
  }

  double cross_section(double distance, double range) const {
    const double sine = std::min(distance / range, 1.0);
    return scattering_->cross_section(sine,
                                      std::sqrt(std::max(range * range - distance * distance, 0.0)) / range);
  }

  /// What a square metre sends by way of a receiver, but for texture and patterns.
  double density(const End& end, double rt, double rr) const {
    const double loss = own_ * std::exp(-beta_ * (rt + rr)) / (rt * rt * (rr * rr));
    if (scattering_ == nullptr) return loss * end.distance / (rt * rr);
    return loss * std::sqrt(cross_section(plane_.distance_m, rt) * cross_section(end.distance, rr));
  }

  /// The two gains of a path.
  double gain(glm::dvec2 p, double rt, const End& end, double rr) const {
    if (!weighed_) return 1;
    const glm::dvec3 from_transmitter = p.x * frame_.u + p.y * frame_.v - plane_.distance_m * plane_.normal;
    return sent_.gain(from_transmitter / rt) * heard_.gain((from_transmitter - end.at_m) / rr);
  }

  /// One end: its energies. Both: the size of the products, and their real and imaginary parts.
  void integrate(std::span<const End> ends, std::vector<double>& out) {
    if (texture_ == nullptr) return integrate_part(polygon_, ends, out);
    cells_.cut(polygon_, lies_, texture_->cells(),
               [&](const PlanarPolygon& part) { integrate_part(part, ends, out); });
  }

  void integrate_part(const PlanarPolygon& part, std::span<const End> ends, std::vector<double>& out) {
    PathCutter::Work work;
    work.values = ends.size() == 1 ? 1 : 3;
    work.resolution_rad = ends.size() == 1 ? smooth_rad_ : std::min(smooth_rad_, fringe_rad_);
    work.tolerance = cornered_ ? tolerance_with_corners : tolerance;
    work.agreements = cornered_ ? 2 : 1;
    if (cornered_ || tables_) work.most_refinements = most_refinements_with_tables;
    std::array<PathCutter::Receiver, 2> receivers;
    for (std::size_t k = 0; k < ends.size(); ++k) receivers[k] = {ends[k].distance, ends[k].foot};
    const auto even = [&](glm::dvec2 p, double rt, const End& end, double rr) {
      return density(end, rt, rr) * gain(p, rt, end, rr);
    };
    cutter_.add(
        part, std::span(receivers).first(ends.size()),
        [&](glm::dvec2 p, double rt, double rr, std::span<double> values) {
          values[0] = even(p, rt, ends[0], rr);
          if (ends.size() > 1) {
            const double other = ends[1].range(p);
            values[0] = std::sqrt(values[0] * even(p, rt, ends[1], other));
          }
          if (texture_ != nullptr) values[0] *= texture_->factor(lies_.at(p));
          if (ends.size() == 1) return;
          // (upper^2 - lower^2) / (upper + lower): no cancellation where the baseline is short.
          const double along = along_.x * p.x + along_.y * p.y + along_.z;
          const double further = -2 * staff_.baseline_m * along / (rr + ends[1].range(p));
          const std::complex<double> product = std::polar(values[0], staff_.wavenumber_rad_m * further);
          values[1] = product.real();
          values[2] = product.imag();
        },
        work, out);
  }

  const StaffHistory& history_;
  const Fringe& staff_;
  const TransmitPattern& sent_;
  const Directivity& heard_;
  const EchoLaw& law_;
  std::span<const double> borders_;
  PathCutter cutter_;
  double beta_;  // of the ways there and back, each
  double patterns_rad_ = 1, fringe_rad_ = 1;
  bool tables_ = false, weighed_ = false;
  std::array<End, 2> ends_;
  // Of the facet at hand.
  FacetPlane plane_;
  PlaneFrame frame_{FacetPlane{}};
  glm::dvec3 along_{0};  // the staff's axis times a place: of x, of y, and of the foot point
  const ScatteringLaw* scattering_ = nullptr;
  const ReflectivityField* texture_ = nullptr;
  LyingPlane lies_;
  double own_ = 1, smooth_rad_ = 1;
  bool cornered_ = false;
  PlanarPolygon polygon_;
  TextureCells cells_;
  std::array<std::vector<double>, 2> energy_;
  std::vector<double> cross_;  // 3 a sample
};

}  // namespace

TubeSet tubes_of_fan(const TubeSet& tubes, std::span<const std::uint32_t> fan_of_tube, std::uint32_t fan) {
  TubeSet part = tubes;
  part.tubes.clear();
  for (std::size_t t = 0; t < tubes.tubes.size(); ++t)
    if (fan_of_tube[t] == fan) part.tubes.push_back(tubes.tubes[t]);
  return part;
}

TubeSet moved_along(const TubeSet& tubes, const Fringe& staff, double end, double grid_unit_m) {
  TubeSet moved = tubes;
  const glm::dvec3 way = glm::round(end * staff.baseline_m / (2 * grid_unit_m) * staff.axis);
  moved.apex.x += std::int32_t(way.x);
  moved.apex.y += std::int32_t(way.y);
  moved.apex.z += std::int32_t(way.z);
  return moved;
}

StaffHistory trace_staff(const FacetMesh& mesh, const SceneTree& tree, double grid_unit_m,
                         const VisibilityOptions& options, TubeSet transmit, const Fringe& staff) {
  if (options.arithmetic == Arithmetic::plain_double)
    throw std::invalid_argument(
        "two receivers on a staff need an exact arithmetic: fixed, filtered or rational");
  StaffHistory history;
  history.upper = moved_along(transmit, staff, 1, grid_unit_m);
  history.lower = moved_along(transmit, staff, -1, grid_unit_m);
  history.transmit = std::move(transmit);
  const auto sent = look(mesh, tree, history.transmit, options);
  const auto share = [&](const TubeSet& tubes, SharedFootprints& shared) {
    const auto heard = look(mesh, tree, tubes, options);
    shared = FootprintSharer(mesh, {history.transmit, sent}, {tubes, heard}, grid_unit_m).all();
  };
  share(history.upper, history.by_upper);
  share(history.lower, history.by_lower);
  return history;
}

StaffEcho integrate_staff_echo(const StaffHistory& history, const Fringe& staff, std::uint32_t fan,
                               std::uint32_t beam, const RangeSamples& samples, const EchoLaw& law) {
  const std::vector<double> borders = sample_borders_m(samples);
  if (!(staff.baseline_m >= 0 && staff.baseline_m <= samples.first_m))
    throw std::invalid_argument("a staff's baseline may not be longer than the nearest range");
  struct Job {
    const SharedFacet *upper, *lower;
  };
  std::vector<Job> jobs;  // by facet
  const auto &up = history.by_upper.facets, &down = history.by_lower.facets;
  for (auto u = up.begin(), d = down.begin(); u != up.end() || d != down.end();) {
    const bool has_upper = u != up.end() && (d == down.end() || u->facet <= d->facet),
               has_lower = d != down.end() && (u == up.end() || d->facet <= u->facet);
    jobs.push_back({has_upper ? &*u++ : nullptr, has_lower ? &*d++ : nullptr});
  }
  std::vector<std::optional<StaffIntegral>> parts((jobs.size() + facets_per_task - 1) / facets_per_task);
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t task) {
    StaffIntegral& part = parts[task].emplace(history, staff, fan, beam, borders, law);
    const std::size_t end = std::min((task + 1) * facets_per_task, jobs.size());
    for (std::size_t k = task * facets_per_task; k < end; ++k) {
      stop_if_wanted();
      if (jobs[k].upper != nullptr) part.add_energy(0, *jobs[k].upper);
      if (jobs[k].lower != nullptr) part.add_energy(1, *jobs[k].lower);
      if (jobs[k].upper != nullptr && jobs[k].lower != nullptr)
        part.add_product(*jobs[k].upper, *jobs[k].lower);
    }
  });
  const auto count = std::size_t(samples.count);
  StaffEcho echo{std::vector<double>(count), std::vector<double>(count), std::vector<double>(count),
                 std::vector<double>(count)};
  for (const auto& part : parts)
    for (std::size_t k = 0; k < count; ++k) {
      echo.upper_j[k] += part->energy(0)[k];
      echo.lower_j[k] += part->energy(1)[k];
      echo.cross_real_j[k] += part->cross()[3 * k + 1];
      echo.cross_imag_j[k] += part->cross()[3 * k + 2];
    }
  return echo;
}

}  // namespace tubefoot
