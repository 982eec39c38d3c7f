// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <vector>

#include "plan/marks.hpp"
#include "plan/panel.hpp"

namespace tubefoot {

/// Draws the elements of a scene on the panels of one sheet, except for axes.
class Painter {
 public:
  Painter(const Survey& survey, const SceneMarks& marks, Sheet& sheet)
      : survey_(survey), marks_(marks), sheet_(sheet) {}

  /// Line in the plan along which a section lies.
  struct Cut {
    View view;
    std::string letter;
  };
  /// Draws a view from above. `near`: only pings at large scale.
  void draw_plan(const Panel& panel, std::span<const Cut> cuts, bool near);
  /// Draws a side view. The seabed appears between its lowest and its highest point along the line of
  /// sight.
  void draw_side(const Panel& panel);
  /// Draws the seabed in the plane of the panel, and the objects that overlap `about` in plan.
  void draw_section(const Panel& panel, const Extent& about);

  /// Returns whether part of the seabed was drawn at reduced resolution.
  bool was_coarse() const { return coarse_; }

 private:
  void draw_seabed(const Panel& panel);
  void draw_terrain_mark(const Panel& panel, Labels& labels);
  void draw_profile(const Panel& panel, bool cut);
  void draw_surface(const Panel& panel, Labels& labels);
  void draw_sectors(const Panel& panel, bool near);
  /// Draws single targets in the water, and the boxes of populations.
  void draw_targets(const Panel& panel, Labels& labels);
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

/// Returns the parts of a line inside of a box or near it. Coordinates far outside have too many digits for
/// a drawing.
std::vector<std::vector<glm::dvec2>> clipped(const std::vector<glm::dvec2>& line, const Box& box);

}  // namespace tubefoot
