// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "engine/rays/ray_columns.hpp"
#include "engine/rays/ray_lanes.hpp"
#include "engine/rays/ray_net.hpp"
#include "engine/rays/ray_patch.hpp"
#include "geometry/tubes/tube.hpp"

// Plans and computes the rays of a ping for all samplings except the adaptive one (adaptive_rays.hpp). Rays
// are computed in packets of sixteen, in any portions, and depend only on the seed and their number.

namespace tubefoot {

/// Defines the directions of the rays of a ping and the weight of each ray. The sum of weight times integrand
/// over all rays estimates an integral over directions.
///
/// - stratified: a tube's patch is divided into as many cells as the tube has rays. Each cell gets one
///   direction, uniform in the patch's (u, v). The weight is cell area times density of solid angle there.
///   Unbiased; the weights sum to the tube's solid angle in expectation.
/// - regular: the middles of the same cells. The weights sum to the tube's solid angle exactly.
/// - random: independent and uniform in solid angle over the sector (rays per ping) or the beam (rays per
///   beam), all of equal weight. Unbiased; the weights sum to the solid angle of the sector or beam exactly,
///   and to that of the tube in expectation.
/// - sobol: a tube's rays are points of a scrambled Sobol' sequence in (u, v) (ray_net.hpp). The weight is
///   the ray's share of the patch times density of solid angle there. Unbiased. For 2^m rays, every grid of
///   2^m cells has one ray in each cell, however long and narrow the cells are.
/// - adaptive: a first ray in each cell of a grid, and the other rays where the first ones show that
///   neighbours differ (adaptive_rays.hpp). Unbiased.
/// - column: one column of rays at the middle of each beam, at equal angles along its longer side. The weight
///   is the ray's share of the beam's solid angle; the weights sum to it exactly. Existing simulators use
///   this sampling.
enum class RaySampling { stratified, regular, random, column, sobol, adaptive };

inline constexpr std::array all_samplings{RaySampling::stratified, RaySampling::sobol,  RaySampling::adaptive,
                                          RaySampling::regular,    RaySampling::random, RaySampling::column};

/// Returns the sampling of that name. Throws std::invalid_argument.
RaySampling ray_sampling_from_name(std::string_view name);
std::string_view name_of(RaySampling sampling);

struct RaySettings {
  enum class Per { ping, beam };
  RaySampling sampling = RaySampling::stratified;
  /// Number of rays, distributed by solid angle among all tubes or among the tubes of each beam. Except in
  /// `random`, every tube (`column`: every beam) gets at least one ray.
  std::int64_t rays = 0;
  Per per = Per::ping;
  std::uint64_t seed = 1;
};

/// All rays of one ping, numbered from 0 in the order of their tubes. RaySource computes them.
class RayPlan {
 public:
  /// `beam_of_tube` may be empty if no beams are needed: for counts per ping, except in columns. Throws
  /// std::invalid_argument for a negative number of rays, a tube that is no convex pyramid, or beams that do
  /// not match the tubes. Also throws it for `column` if a beam's tubes form no grid, and for `adaptive`.
  /// Does not keep references.
  RayPlan(const TubeSet& tubes, const RaySettings& settings, std::span<const std::uint32_t> beam_of_tube);

  std::int64_t rays() const { return rays_; }
  /// Returns a suitable number of rays for a RaySource. Random rays are coherent only if many are drawn and
  /// sorted together.
  std::int64_t rays_at_a_time() const {
    return settings_.sampling == RaySampling::random ? 1 << 16 : 1 << 11;
  }

 private:
  friend class RaySource;
  struct Share {  // of a tube, or of a column
    std::int64_t first = 0, rays = 0, rows = 0;
    double weight = 0;  // of each ray, in `random`
  };
  void share_out(std::span<const double> solid_angles, const std::vector<std::vector<std::uint32_t>>& groups);

  RaySettings settings_;
  std::vector<RayPatch> patches_;
  std::vector<RayColumn> columns_;
  std::vector<Share> shares_;
  std::int64_t rays_ = 0;
};

/// Computes the rays [first, end) of a plan. A ray's direction and weight depend on (tubes, settings, ray)
/// alone. Only the order of random rays, which are sorted by position, depends on [first, end).
class RaySource {
 public:
  RaySource(const RayPlan& plan, std::int64_t first, std::int64_t end);
  /// Returns the next rays, up to 16, neighbours if possible. Returns false if there are no more.
  bool next(RayPacket& packet);

 private:
  // A tube's rays lie in rows of cells. They are traversed in bands of four rows, so that sixteen successive
  // rays are a block of four by four.
  static constexpr int band_rows = 4;
  // Weights of `regular` are corrected to the exact solid angle of this many cells of a row together.
  static constexpr std::int64_t segment_length = 64;
  struct Row {
    std::int64_t begin = 0, count = 0;  // rays of the tube before the row, and in it
    double u_step = 0;
    std::int64_t segment = -1;
    double factor = 1;  // of the weights in the segment
  };

  void start_run();
  void start_band(std::int64_t row);
  double row_factor(const Row& row) const;
  void draw_run();
  void start_net();
  bool next_block(RayPacket& packet);
  void next_cells(RayPacket& packet, int lane, int count);
  void next_of_net(RayPacket& packet, int lane, int count);
  void next_random(RayPacket& packet, int lane, int count);
  void next_of_column(RayPacket& packet, int lane, int count);
  void place(RayPacket& packet, int lane, int count, const RayPacket::Numbers& u, const RayPacket::Numbers& v,
             const RayPacket::Numbers& weight) const;

  const RayPlan& plan_;
  std::int64_t next_, end_;
  std::size_t run_ = 0;  // the tube or column of the current rays
  std::int64_t run_next_ = 0, run_end_ = 0;
  std::uint64_t key_ = 0;
  std::array<Row, band_rows> row_;
  std::int64_t full_columns_ = 0, column_ = 0;
  int band_height_ = 0, row_in_band_ = 0;
  RayCells block_;      // values that are constant for the blocks of a band,
  int block_row_ = -1;  // if the blocks begin in this row
  RayNet net_;
  std::int64_t net_first_ = 0;  // the net's first ray in the tube
  std::vector<std::array<double, 2>> drawn_, sorted_;
  std::vector<std::uint32_t> bin_, bin_begin_;
  std::int64_t sorted_begin_ = 0;
  RayColumn::Cursor cursor_;
};

}  // namespace tubefoot
