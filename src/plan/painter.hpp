// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <vector>

#include "plan/marks.hpp"
#include "plan/panel.hpp"

namespace tubefoot {

/// Draws what a scene holds onto panels of one sheet, all but their axes.
class Painter {
 public:
  Painter(const Survey& survey, const SceneMarks& marks, Sheet& sheet)
      : survey_(survey), marks_(marks), sheet_(sheet) {}

  /// Where a section cuts the plan.
  struct Cut {
    View view;
    std::string letter;
  };
  /// From above. `near`: only the pings that are drawn large.
  void draw_plan(const Panel& panel, std::span<const Cut> cuts, bool near);
  /// From the side: seabed from the lowest to the highest before and behind.
  void draw_side(const Panel& panel);
  /// The seabed where the panel's plane cuts it, and objects that come into `about` seen from above.
  void draw_section(const Panel& panel, const Extent& about);

  /// Whether some of the seabed was drawn coarsely.
  bool was_coarse() const { return coarse_; }

 private:
  void draw_seabed(const Panel& panel);
  void draw_terrain_mark(const Panel& panel, Labels& labels);
  void draw_profile(const Panel& panel, bool cut);
  void draw_surface(const Panel& panel, Labels& labels);
  void draw_sectors(const Panel& panel, bool near);
  void draw_objects(const Panel& panel, const Extent* about, Labels& labels);
  void draw_tracks(const Panel& panel, bool with_headings, Labels& labels);
  void draw_places(const Panel& panel, bool near, Labels& labels);
  void draw_distance(const Panel& panel, Labels& labels);
  void draw_cut(const Panel& panel, const Cut& cut);

  const Survey& survey_;
  const SceneMarks& marks_;
  Sheet& sheet_;
  bool coarse_ = false;
};

/// What of a line is inside of a box or near it: what is far outside has more digits than a drawing holds.
std::vector<std::vector<glm::dvec2>> clipped(const std::vector<glm::dvec2>& line, const Box& box);

}  // namespace tubefoot
