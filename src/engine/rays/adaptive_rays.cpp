// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/rays/adaptive_rays.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>

#include "engine/rays/ray_shares.hpp"
#include "geometry/steps/stop.hpp"

// Computes the distribution of adaptive rays from the pilots. The number of rays per cell is proportional to
// solid angle times deviation^(3/4) mean^(1/4) of the neighbours' echoes, with a lower limit. The points of
// each cell follow a scrambled Sobol' sequence in Gray code order.

namespace tubefoot {
namespace {

using namespace splitmix;

// The cells are traversed in bands of this many rows, so that sixteen successive rays are neighbours.
constexpr std::int64_t band_rows = 4;
constexpr int net_digits = 32;
// Rays per pilot, and the largest number of pilots, whose results must be stored. In tests with 1.5 to 4 rays
// per pilot, 1.5 to 2 gave the smallest errors on flat and rough seabeds, edges and a sphere.
constexpr std::int64_t rays_a_pilot = 2, most_pilots = std::int64_t{1} << 20;

/// Mean at the middle of a cell and variance over the cell, for a plane through the values of its four
/// neighbours.
struct Spread {
  double mean = 0, variance = 0;
};

Spread spread_of(const std::array<double, 4>& value, const std::array<bool, 4>& is_there) {
  Spread spread;
  int count = 0;
  for (std::size_t k = 0; k < 4; ++k)
    if (is_there[k]) {
      spread.mean += value[k];
      ++count;
    }
  spread.mean /= count;
  // Two opposite values give a slope; its variance over a cell is its square over 12.
  const auto slope2 = [&](std::size_t a, std::size_t b) {
    return is_there[a] && is_there[b] ? (value[b] - value[a]) * (value[b] - value[a]) / 4 / 12 : 0;
  };
  spread.variance = slope2(0, 1) + slope2(2, 3);
  // The remaining difference is roughness, because the mean values of opposite pairs would agree on a plane.
  if (count == 4) {
    const double rest = (value[0] + value[1] - value[2] - value[3]) / 4;
    spread.variance += rest * rest;
  } else if (count == 2 && spread.variance == 0) {
    for (std::size_t k = 0; k < 4; ++k)
      if (is_there[k]) spread.variance += (value[k] - spread.mean) * (value[k] - spread.mean) / 12;
  }
  return spread;
}

/// Shares of a uniform distribution over an interval of ranges: its share in all samples, and the sum of the
/// squares of the shares of single samples.
struct InSamples {
  double share = 1, squares = 1;
};

InSamples in_samples(const RayGuide& guide, double from_m, double to_m) {
  if (guide.count == 0) return {};
  const double from = (from_m - guide.first_m) / guide.step_m, to = (to_m - guide.first_m) / guide.step_m;
  const double begin = std::clamp(from, 0.0, double(guide.count)),
               end = std::clamp(to, 0.0, double(guide.count));
  if (!(to - from > 1e-9)) return from >= 0 && from < guide.count ? InSamples{1, 1} : InSamples{0, 0};
  if (!(end > begin)) return {0, 0};
  const double length = to - from, first = std::floor(begin),
               last = std::min(std::floor(end), guide.count - 1.0);
  const auto square = [&](double part) { return part / length * (part / length); };
  if (first == last) return {(end - begin) / length, square(end - begin)};
  return {(end - begin) / length,
          square(first + 1 - begin) + (last - first - 1) / (length * length) + square(end - last)};
}

}  // namespace

std::int64_t AdaptiveRays::Grid::number(std::int64_t row, std::int64_t column) const {
  const std::int64_t begin = row - row % band_rows, height = std::min(band_rows, rows - begin);
  return first + begin * columns + column * height + (row - begin);
}

void AdaptiveRays::Grid::find(std::int64_t cell, std::int64_t& row, std::int64_t& column) const {
  const std::int64_t in_tube = cell - first, begin = in_tube / (band_rows * columns) * band_rows,
                     height = std::min(band_rows, rows - begin), in_band = in_tube - begin * columns;
  column = in_band / height;
  row = begin + in_band % height;
}

AdaptiveRays::AdaptiveRays(const TubeSet& tubes, const RaySettings& settings,
                           std::span<const std::uint32_t> beam_of_tube, const RayGuide* guide)
    : seed_(settings.seed),
      guide_(guide != nullptr ? *guide : RayGuide()),
      patches_(ray_patches(tubes, settings, beam_of_tube)) {
  grids_.resize(patches_.size());
  if (!patches_.empty() && settings.rays > 0) {
    const auto lists = ray_groups(patches_.size(), settings, beam_of_tube);
    const auto most = std::max<std::int64_t>(most_pilots / std::int64_t(lists.size()), 1);
    for (const auto& list : lists) {
      std::vector<double> parts;
      for (const std::uint32_t t : list) parts.push_back(patches_[t].solid_angle(0, 1, 0, 1));
      std::int64_t pilots = 0;
      const auto wanted =
          dealt(parts, std::min(std::max<std::int64_t>(settings.rays / rays_a_pilot, 1), most));
      for (std::size_t k = 0; k < list.size(); ++k) {
        Grid& grid = grids_[list[k]];
        const PatchSides sides(patches_[list[k]]);
        const double aspect = sides.height / sides.width, count = double(wanted[k]);
        // The shorter side is rounded first, because the remainder is smallest then.
        const auto across =
            std::int64_t(std::clamp(std::round(std::sqrt(count * std::min(aspect, 1 / aspect))), 1.0, count));
        grid.rows = aspect > 1 ? wanted[k] / across : across;
        grid.columns = aspect > 1 ? across : wanted[k] / across;
        grid.column_width = 1 / double(grid.columns);
        grid.row_height = 1 / double(grid.rows);
        pilots += grid.cells();
      }
      groups_.push_back({list, std::max<std::int64_t>(settings.rays - pilots, 0)});
      others_ += groups_.back().others;
    }
  }
  for (Grid& grid : grids_) {
    grid.first = cells_;
    cells_ += grid.cells();
  }
  dealt_.assign(std::size_t(cells_) + 1, 0);
}

std::size_t AdaptiveRays::tube_of(std::int64_t cell) const {
  const auto after = std::upper_bound(grids_.begin(), grids_.end(), cell,
                                      [](std::int64_t c, const Grid& grid) { return c < grid.first; });
  return std::size_t(after - grids_.begin() - 1);
}

double AdaptiveRays::worth(const Grid& grid, std::size_t tube, std::int64_t row, std::int64_t column,
                           std::span<const PilotEcho> met) const {
  std::array<double, 4> range{}, strength{};
  std::array<bool, 4> is_there{};
  int looked = 0, hits = 0;
  const auto look = [&](std::size_t k, std::int64_t r, std::int64_t c) {
    if (r < 0 || r >= grid.rows || c < 0 || c >= grid.columns) return;
    ++looked;
    const PilotEcho& echo = met[std::size_t(grid.number(r, c))];
    if (!(echo.strength > 0)) return;
    ++hits;
    is_there[k] = true;
    range[k] = echo.range_m;
    strength[k] = echo.strength;
  };
  look(0, row - 1, column);
  look(1, row + 1, column);
  look(2, row, column - 1);
  look(3, row, column + 1);
  if (looked == 0) return -1;
  if (hits == 0) return 0;
  const double hit = double(hits) / looked;
  const Spread ranges = spread_of(range, is_there), strengths = spread_of(strength, is_there);
  // A uniform distribution with that variance.
  const double half = std::sqrt(3 * ranges.variance);
  const InSamples in = in_samples(guide_, ranges.mean - half, ranges.mean + half);
  // Variance of a ray's contribution to all samples: the mean square minus the squares of the means.
  const double mean2 = strengths.mean * strengths.mean;
  const double variance = hit * in.share * (mean2 + strengths.variance) - hit * hit * mean2 * in.squares;
  const RayPatch& patch = patches_[tube];
  const double u = (double(column) + 0.5) / double(grid.columns), v = (double(row) + 0.5) / double(grid.rows);
  const double length = glm::length(patch.at(u, v));
  const double solid_angle = patch.triple(u, v) / (length * length * length) / double(grid.cells());
  // Neyman's allocation is proportional to the deviation if errors decrease as 1/sqrt(n). The errors of a net
  // decrease faster, about as n^(-3/4) at a discontinuity, so the optimum is a smaller power of the
  // deviation. Strong echoes get more rays, but fewer than the minimum of the total variance requires,
  // because weak samples must be accurate too. The resulting weight is deviation^(3/4) mean^(1/4), computed
  // with square roots.
  const double deviation = std::sqrt(std::max(variance, 0.0) / mean2);
  return solid_angle * std::sqrt(std::sqrt(deviation * deviation * deviation * strengths.mean));
}

void AdaptiveRays::deal(std::span<const PilotEcho> met) {
  std::vector<double> worths(static_cast<std::size_t>(cells_));
  tbb::parallel_for(std::size_t{0}, grids_.size(), [&](std::size_t t) {
    stop_if_wanted();
    const Grid& grid = grids_[t];
    tbb::parallel_for(std::int64_t{0}, grid.rows, [&](std::int64_t row) {
      for (std::int64_t column = 0; column < grid.columns; ++column)
        worths[std::size_t(grid.number(row, column))] = worth(grid, t, row, column, met);
    });
  });
  std::vector<std::int64_t> more(static_cast<std::size_t>(cells_));
  for (const Group& group : groups_) {
    std::int64_t cells = 0, black = 0;
    for (const std::uint32_t t : group.tubes) {
      cells += grids_[t].cells();
      black += (grids_[t].cells() + 1) / 2;
    }
    const auto for_black = std::int64_t(std::llround(double(group.others) * (double(black) / double(cells))));
    deal(group, 0, for_black, worths, more);
    deal(group, 1, group.others - for_black, worths, more);
  }
  for (std::size_t cell = 0; cell < more.size(); ++cell) dealt_[cell + 1] = dealt_[cell] + more[cell];
}

void AdaptiveRays::deal(const Group& group, int colour, std::int64_t others, std::span<const double> worth,
                        std::vector<std::int64_t>& more) const {
  constexpr double least_worth = 0.3;  // of the mean, so that every cell gets some rays
  if (others == 0) return;
  std::vector<std::size_t> cells;
  for (const std::uint32_t t : group.tubes)
    for (std::int64_t row = 0; row < grids_[t].rows; ++row)
      for (std::int64_t column = (row + colour) % 2; column < grids_[t].columns; column += 2)
        cells.push_back(std::size_t(grids_[t].number(row, column)));
  std::vector<double> own;  // weight of each cell
  double mean = 0;
  std::size_t known = 0;
  for (const std::size_t cell : cells) {
    own.push_back(worth[cell]);
    if (own.back() < 0) continue;
    mean += own.back();
    ++known;
  }
  mean = mean > 0 ? mean / double(known) : 1;
  for (double& one : own) one = one < 0 ? mean : std::max(one, least_worth * mean);
  // A cell of weight w gets max(1, scale w) rays, including its pilot.
  double scale = 0;
  std::size_t sharing = cells.size();
  for (std::size_t before = 0; before != sharing;) {
    before = sharing;
    double sum = 0;
    sharing = 0;
    for (const double one : own)
      if (scale == 0 || scale * one > 1) {
        sum += one;
        ++sharing;
      }
    scale = (double(others) + double(sharing)) / sum;
  }
  double sum = 0, running = 0;
  for (const double one : own) sum += std::max(scale * one - 1, 0.0);
  std::int64_t given = 0;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    running += std::max(scale * own[k] - 1, 0.0);
    // Rounding the running total preserves the sum.
    const auto until = std::int64_t(std::llround(double(others) * (running / sum)));
    more[cells[k]] = until - given;
    given = until;
  }
}

AdaptiveRays::Source::Source(const AdaptiveRays& rays, bool pilots, std::int64_t first, std::int64_t end)
    : rays_(rays), pilots_(pilots), next_(first), end_(end), cell_(first) {
  if (next_ == end_) return;
  if (!pilots) {
    const auto& dealt = rays_.dealt_;
    cell_ = std::upper_bound(dealt.begin(), dealt.end(), first) - dealt.begin() - 1;
  }
  tube_ = rays_.tube_of(cell_);
  rays_.grids_[tube_].find(cell_, row_, column_);
  key_ = mixed(mixed(rays_.seed_ + golden) + golden * (tube_ + 1));
  start_cell();
  if (!pilots) go_to(next_ - rays_.dealt_[cell_] + 1);
}

/// Places the pilot and computes the steps to the other points of the cell in Gray code order. Successive
/// points differ by the step of one bit of their number.
void AdaptiveRays::Source::start_cell() {
  const std::uint64_t label = golden * std::uint64_t(cell_ - rays_.grids_[tube_].first + 1);
  const std::uint64_t pilot = mixed(key_ + label);
  at_ = {std::uint32_t(pilot >> 32), std::uint32_t(pilot)};
  point_ = 1;
  if (pilots_) return;
  points_ = rays_.rays_in(cell_);
  const std::uint64_t scrambling = mixed(~key_ + label);
  const int bits = std::min(net_digits, int(std::bit_width(std::uint64_t(points_ - 1))));
  std::uint32_t direction = 1u << (net_digits - 1);  // of the second dimension, as in ray_net.cpp
  std::array<std::uint32_t, net_digits> column;
  for (int bit = 0; bit < bits; ++bit, direction ^= direction >> 1) {
    const std::uint32_t one = 1u << (net_digits - 1 - bit);
    const std::uint64_t drawn = mixed(scrambling + golden * std::uint64_t(bit + 1));
    column[std::size_t(bit)] = one | (std::uint32_t(drawn) & (one - 1));
    std::uint32_t along = 0;
    for (std::uint32_t word = direction; word != 0; word &= word - 1)
      along ^= column[std::size_t(std::countl_zero(word & (~word + 1)))];
    step_[std::size_t(bit)] = {one | (std::uint32_t(drawn >> 32) & (one - 1)), along};
  }
}

/// Makes `point` the next point.
void AdaptiveRays::Source::go_to(std::int64_t point) {
  const auto before = std::uint64_t(point - 1);
  for (auto gray = std::uint32_t(before ^ before >> 1); gray != 0; gray &= gray - 1)
    for (std::size_t d = 0; d < 2; ++d) at_[d] ^= step_[std::size_t(std::countr_zero(gray))][d];
  point_ = point;
}

void AdaptiveRays::Source::step_cell() {
  ++cell_;
  const Grid* grid = &rays_.grids_[tube_];
  const std::int64_t begin = row_ - row_ % band_rows, height = std::min(band_rows, grid->rows - begin);
  if (++row_ == begin + height) {
    row_ = begin;
    if (++column_ == grid->columns) {
      column_ = 0;
      row_ += height;
    }
  }
  if (row_ == grid->rows) {
    ++tube_;
    row_ = 0;
    key_ = mixed(mixed(rays_.seed_ + golden) + golden * (tube_ + 1));
  }
}

bool AdaptiveRays::Source::next(RayPacket& packet) {
  alignas(64) RayPacket::Numbers u{}, v{}, weight{};
  int lane = 0;
  for (; lane < RayPacket::size && next_ < end_; ++lane, ++next_, ++point_) {
    if (pilots_) {
      if (point_ > 1) {
        step_cell();
        start_cell();
      }
    } else {
      while (point_ == points_) {
        step_cell();
        points_ = rays_.rays_in(cell_);
        point_ = 1;
        if (points_ > 1) start_cell();
      }
      for (std::size_t d = 0; d < 2; ++d)
        at_[d] ^= step_[std::size_t(std::countr_zero(std::uint64_t(point_)) % net_digits)][d];
    }
    const Grid& grid = rays_.grids_[tube_];
    u[lane] = (double(column_) + (double(at_[0]) + 0.5) * 0x1p-32) * grid.column_width;
    v[lane] = (double(row_) + (double(at_[1]) + 0.5) * 0x1p-32) * grid.row_height;
    weight[lane] = grid.column_width * grid.row_height / double(points_);
    packet.tube[lane] = std::uint32_t(tube_);
  }
  packet.count = lane;
  if (lane == 0) return false;
  // Usually all rays belong to one tube; rays of further tubes are computed separately and merged.
  aim(rays_.patches_[packet.tube[0]], u, v, weight, packet);
  for (int k = 1; k < lane; ++k) {
    if (packet.tube[k] == packet.tube[k - 1]) continue;
    RayPacket rest;
    aim(rays_.patches_[packet.tube[k]], u, v, weight, rest);
    take_lanes(rest, k, packet, k, lane - k);
  }
  return true;
}

}  // namespace tubefoot
