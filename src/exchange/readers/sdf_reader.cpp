// SPDX-License-Identifier: GPL-3.0-or-later
// Reads SDF worlds and models: nested and included models, links, and the shapes and sensors of links. It
// counts every element that it does not read.
#include <fmt/format.h>

#include <algorithm>

#include "exchange/readers/sdf_frames.hpp"
#include "exchange/readers/sdf_parts.hpp"

namespace tubefoot {
namespace {

/// Elements of SDFormat 1.4 to 1.11 that describe dynamics, control, light or display.
constexpr std::array without_echo{
    // of worlds
    "atmosphere", "audio", "gravity", "gui", "light", "magnetic_field", "physics", "plugin", "scene", "wind",
    // of models
    "allow_auto_disable", "enable_wind", "gripper", "joint", "self_collide", "static",
    // of links
    "audio_sink", "audio_source", "battery", "inertial", "kinematic", "must_be_base_link", "projector",
    "velocity_decay",
    // of visuals and collisions
    "auto_inertia_params", "cast_shadows", "density", "laser_retro", "max_contacts", "meta", "surface",
    "transparency", "visibility_flags"};

class SdfReader {
 public:
  explicit SdfReader(WorldParts& parts) : parts_(parts), frames_(parts) {}

  void read() {
    const std::unique_ptr<SdfScope> world = frames_.world_scope();
    parts_.read_own_scene(world->node);
    children(*world, {});
  }

 private:
  static bool is_any_of(std::string_view name, std::initializer_list<std::string_view> names) {
    return std::ranges::find(names, name) != names.end();
  }

  /// Counts an element that is not read.
  void leave_out(pugi::xml_node node) {
    if (std::ranges::find(without_echo, std::string_view(node.name())) != without_echo.end())
      parts_.without_effect(node);
    else
      parts_.pass_over(node);
  }

  /// Reads the children of a world or a model. `prefix`: "tug::" for the children of the model tug.
  void children(SdfScope& scope, const std::string& prefix) {
    for (const pugi::xml_node node : scope.node.children()) {
      if (node.type() != pugi::node_element) continue;
      parts_.visit(node);
      const std::string_view name = node.name();
      if (name == "model" || name == "include") {
        SdfScope* const inner = frames_.model(scope, node);
        if (name == "include") parts_.count_include(inner != nullptr);
        if (inner != nullptr) children(*inner, inner->is_merged ? prefix : prefix + inner->name + "::");
      } else if (name == "link") {
        if (const auto placed = frames_.place_of(scope, node)) link(scope, node, *placed, prefix);
      } else if (!is_any_of(name, {"pose", "tubefoot:scene", "frame"})) {
        leave_out(node);
      }
    }
  }

  void link(SdfScope& scope, pugi::xml_node link, const Placement& placed, const std::string& prefix) {
    const bool has_visuals = static_cast<bool>(link.child("visual"));
    if (!has_visuals && link.child("collision"))
      parts_.notice(link, fmt::format("link '{}' has no <visual>: tubefoot uses its <collision> instead",
                                      sdf_name_of(link)));
    for (const pugi::xml_node node : link.children()) {
      if (node.type() != pugi::node_element) continue;
      parts_.visit(node);
      const std::string_view name = node.name();
      if (name == (has_visuals ? "visual" : "collision")) {
        for (const pugi::xml_node child : node.children())
          if (child.type() == pugi::node_element &&
              !is_any_of(child.name(), {"pose", "geometry", "material", "tubefoot:material"}))
            leave_out(child);
        if (const auto inner = frames_.place_in_link(scope, node, placed))
          read_sdf_shape(parts_, node, *inner, prefix + sdf_name_of(link) + "::" + sdf_name_of(node));
      } else if (name == "sensor") {
        if (const auto inner = frames_.place_in_link(scope, node, placed))
          read_sdf_sensor(parts_, node, placed, *inner);
      } else if (name == "collision") {
        parts_.without_effect(node);  // the visuals are the surface
      } else if (name != "pose") {
        leave_out(node);
      }
    }
  }

  WorldParts& parts_;
  SdfFrames frames_;
};

}  // namespace

void read_sdf(WorldParts& parts) { SdfReader(parts).read(); }

}  // namespace tubefoot
