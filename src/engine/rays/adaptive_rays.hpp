// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/rays/ray_guide.hpp"
#include "engine/rays/ray_lanes.hpp"
#include "engine/rays/ray_patch.hpp"
#include "engine/rays/ray_sampling.hpp"
#include "geometry/tubes/tube.hpp"

// Distributes rays adaptively. The patch of every tube is divided into cells of equal area in (u, v). A first
// ray, the pilot, goes to a random point of each cell. The results of the pilots show where neighbouring rays
// differ, and the remaining rays are distributed accordingly.
//
// The m rays of a cell are the first m points of a Sobol' sequence. The sequence is scrambled with the cell's
// own key (ray_net.hpp) and shifted so that the pilot is the first point. Since the pilot is uniform in its
// cell, every other point is uniform too, for given m. Each ray represents a fraction 1/m of the cell.
//
// The cells are coloured like a chessboard, and each colour gets a fixed number of rays. The distribution
// among the cells of one colour depends on the pilots of the other colour alone. So m does not depend on the
// cell's own pilot, and the energies from all rays are unbiased.
namespace tubefoot {

/// The result of a pilot.
struct PilotEcho {
  float range_m = 0;
  float strength = 0;  ///< intensity that it returns per sr, in any unit; 0: no hit
};

class AdaptiveRays {
 public:
  /// Throws the exceptions of RayPlan. Without a guide the whole range is one sample.
  AdaptiveRays(const TubeSet& tubes, const RaySettings& settings, std::span<const std::uint32_t> beam_of_tube,
               const RayGuide* guide = nullptr);

  /// Number of pilots: one per cell, with the numbers of the cells.
  std::int64_t pilots() const { return cells_; }
  /// Number of all other rays.
  std::int64_t others() const { return others_; }
  /// Distributes the other rays according to the results of the pilots, which are in the order of the cells.
  void deal(std::span<const PilotEcho> met);
  /// Returns the number of rays in a cell, including its pilot.
  std::int64_t rays_in(std::int64_t cell) const { return 1 + dealt_[cell + 1] - dealt_[cell]; }

  /// A sequence of rays: either pilots [first, end), with the weights of whole cells, or other rays [first,
  /// end) after deal().
  class Source {
   public:
    Source(const AdaptiveRays& rays, bool pilots, std::int64_t first, std::int64_t end);
    /// Returns the next rays, up to 16. Returns false if there are no more.
    bool next(RayPacket& packet);

   private:
    void start_cell();
    void step_cell();
    void go_to(std::int64_t point);

    const AdaptiveRays& rays_;
    bool pilots_;
    std::int64_t next_, end_, cell_;
    std::size_t tube_ = 0;
    std::int64_t row_ = 0, column_ = 0;
    std::uint64_t key_ = 0;                // of the tube
    std::int64_t point_ = 0, points_ = 1;  // in the cell: number of the next point, number of points
    std::array<std::uint32_t, 2> at_{};    // the previous point, in the cell
    std::array<std::array<std::uint32_t, 2>, 32> step_{};  // per changing bit
  };

 private:
  struct Grid {  // cells of a tube
    std::int64_t first = 0, rows = 0, columns = 0;
    double column_width = 0, row_height = 0;
    std::int64_t cells() const { return rows * columns; }
    std::int64_t number(std::int64_t row, std::int64_t column) const;
    void find(std::int64_t cell, std::int64_t& row, std::int64_t& column) const;
  };
  struct Group {  // tubes that share a number of rays
    std::vector<std::uint32_t> tubes;
    std::int64_t others = 0;
  };
  std::size_t tube_of(std::int64_t cell) const;
  /// Returns the relative number of rays for a cell from the pilots of its neighbours. Negative: the cell has
  /// no neighbours.
  double worth(const Grid& grid, std::size_t tube, std::int64_t row, std::int64_t column,
               std::span<const PilotEcho> met) const;
  void deal(const Group& group, int colour, std::int64_t others, std::span<const double> worth,
            std::vector<std::int64_t>& more) const;

  std::uint64_t seed_;
  RayGuide guide_;
  std::vector<RayPatch> patches_;
  std::vector<Grid> grids_;
  std::vector<Group> groups_;
  std::int64_t cells_ = 0, others_ = 0;
  std::vector<std::int64_t> dealt_;  // number of other rays before each cell, and in total
};

}  // namespace tubefoot
