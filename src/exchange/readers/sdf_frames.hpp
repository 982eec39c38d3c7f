// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <pugixml.hpp>
#include <string>

#include "exchange/readers/world_parts.hpp"

namespace tubefoot {

/// A world or a model of SDF: the frames among its children, and the models in it.
struct SdfScope {
  pugi::xml_node node;  ///< a world or a model
  std::string name;     ///< of a model; an <include> may replace the model's own name
  Placement placed;     ///< placement in the world
  const SdfScope* outer = nullptr;
  bool is_included = false;  ///< whether an <include> names this model
  pugi::xml_node posed{};    ///< element whose <pose> places the model if its <include> has none
  bool is_merged = false;    ///< whether its children belong to `outer` (<include merge="true">)

  std::map<std::string, pugi::xml_node, std::less<>> frames{};
  std::map<std::string, std::optional<Placement>, std::less<>> known{};  ///< frames that were looked up
  /// Models, by their elements. Null: not found, or looked up just now.
  std::map<const void*, std::unique_ptr<SdfScope>> models{};
};

/// Resolves poses, frames and included models. Poses follow SDFormat 1.11, with the older spelling `frame`
/// of `relative_to`.
class SdfFrames {
 public:
  explicit SdfFrames(WorldParts& parts) : parts_(parts), xml_(parts.xml()) {}

  /// Returns the scope of the file's world, or of the file itself if it contains only models.
  std::unique_ptr<SdfScope> world_scope();
  /// Returns the scope of a child <model> or <include> of a scope. Reports the reason if there is none.
  SdfScope* model(SdfScope& scope, pugi::xml_node node);
  /// Returns the placement of a child of a scope in the world. Reports an unresolved frame and returns
  /// nothing.
  std::optional<Placement> place_of(SdfScope& scope, pugi::xml_node node);
  /// Does the same for a child of a link, whose default frame is the link.
  std::optional<Placement> place_in_link(SdfScope& scope, pugi::xml_node node, const Placement& link);

 private:
  /// Name of the frame to which a pose is relative; empty: the default frame of the element.
  static std::string frame_of(pugi::xml_node pose);
  /// Returns the placement that the numbers of a <pose> describe.
  Placement pose_in(pugi::xml_node pose) const;
  std::optional<Placement> frame(SdfScope& scope, const std::string& name);
  std::optional<Placement> looked_up(SdfScope& scope, const std::string& name);
  std::optional<Placement> placed_in(SdfScope& scope, pugi::xml_node pose, const std::string& otherwise);
  std::unique_ptr<SdfScope> opened(const SdfScope& outer, pugi::xml_node node);
  std::unique_ptr<SdfScope> opened_by(const SdfScope& outer, pugi::xml_node node, pugi::xml_node root);
  void add_frames(SdfScope& scope);
  void report_frame(pugi::xml_node node, const std::string& name);

  WorldParts& parts_;
  const XmlInput& xml_;
  std::size_t includes_ = 0;
  int depth_ = 0;  ///< of frames that depend on others
};

/// Returns the attribute `name` of an element on one line.
std::string sdf_name_of(pugi::xml_node node);
/// Returns whether a text is true for SDF: "true" or "1".
bool sdf_true(std::string_view text);

}  // namespace tubefoot
