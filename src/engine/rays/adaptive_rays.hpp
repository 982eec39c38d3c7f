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

// Rays where they tell most. Every tube's patch is cut into cells of equal area in (u, v). A first ray goes
// to a random place of each, the pilot; what the pilots meet says where neighbouring rays differ, and there
// the other rays are dealt.
//
// A cell's m rays are the first m points of a Sobol' sequence scrambled by its own key (ray_net.hpp) and
// shifted so that the pilot is the first of them. As the pilot is uniform in its cell, so is every other
// point, given m; each stands for an m-th of the cell. The cells are coloured like a chessboard, rays are
// shared out to each colour beforehand, and how they are dealt to the cells of one colour depends on the
// pilots of the other alone. So m does not depend on the cell's own pilot, and energies are unbiased with all
// rays in use.
namespace tubefoot {

/// What a pilot met.
struct PilotEcho {
  float range_m = 0;
  float strength = 0;  ///< what it returns per sr, in any unit; 0: nothing met
};

class AdaptiveRays {
 public:
  /// As RayPlan, and throws as it does. Without a guide everything falls into one sample.
  AdaptiveRays(const TubeSet& tubes, const RaySettings& settings, std::span<const std::uint32_t> beam_of_tube,
               const RayGuide* guide = nullptr);

  /// One for each cell, numbered as cells are.
  std::int64_t pilots() const { return cells_; }
  /// All others.
  std::int64_t others() const { return others_; }
  /// Deals them by what the pilots met, in the cells' order.
  void deal(std::span<const PilotEcho> met);
  /// Rays of a cell, its pilot being one of them.
  std::int64_t rays_in(std::int64_t cell) const { return 1 + dealt_[cell + 1] - dealt_[cell]; }

  /// Pilots [first, end), whose weights are those of whole cells; or others, of a number of rays in cells
  /// that is known.
  class Source {
   public:
    Source(const AdaptiveRays& rays, bool pilots, std::int64_t first, std::int64_t end);
    /// The next rays, up to 16. False when there are no more.
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
    std::uint64_t key_ = 0;                                // the tube's
    std::int64_t point_ = 0, points_ = 1;                  // of the cell: the next, and how many
    std::array<std::uint32_t, 2> at_{};                    // the point before, in the cell
    std::array<std::array<std::uint32_t, 2>, 32> step_{};  // by the bit that changes
  };

 private:
  struct Grid {  // a tube's cells
    std::int64_t first = 0, rows = 0, columns = 0;
    double column_width = 0, row_height = 0;
    std::int64_t cells() const { return rows * columns; }
    std::int64_t number(std::int64_t row, std::int64_t column) const;
    void find(std::int64_t cell, std::int64_t& row, std::int64_t& column) const;
  };
  struct Group {  // of tubes that a number of rays is for
    std::vector<std::uint32_t> tubes;
    std::int64_t others = 0;
  };
  std::size_t tube_of(std::int64_t cell) const;
  /// How many rays a cell deserves, in proportion, by its neighbours' pilots; negative: it has no neighbours.
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
  std::vector<std::int64_t> dealt_;  // other rays before each cell, and all
};

}  // namespace tubefoot
