// SPDX-License-Identifier: GPL-3.0-or-later
// Resolves the poses and frames of SDF worlds, and opens the models that they include. Every included model
// is a scope of its own, in which names of frames are looked up.
#include "exchange/readers/sdf_frames.hpp"

#include <fmt/format.h>

#include <cmath>

#include "files/shown.hpp"
#include "sensors/model/angles.hpp"

namespace tubefoot {
namespace {

bool is_named(pugi::xml_node node, std::string_view name) { return name == node.name(); }

/// Returns the first model of a file, or the element that the file contains instead.
pugi::xml_node entity_of(pugi::xml_node root) {
  if (is_named(root, "model")) return root;
  if (const pugi::xml_node model = root.child("model")) return model;
  for (const char* other : {"actor", "light", "world"})
    if (const pugi::xml_node found = root.child(other)) return found;
  return {};
}

/// Moves a scope and everything in it that is placed already.
void move(SdfScope& scope, const Placement& by) {
  scope.placed = by * scope.placed;
  for (auto& [name, placed] : scope.known)
    if (placed) placed = by * *placed;
  for (auto& [key, model] : scope.models)
    if (model) move(*model, by);
}

}  // namespace

std::string sdf_name_of(pugi::xml_node node) { return shown_line(node.attribute("name").value()); }

bool sdf_true(std::string_view text) {
  const std::string word = trimmed(text);
  return word == "true" || word == "1" || word == "True";
}

std::unique_ptr<SdfScope> SdfFrames::world_scope() {
  pugi::xml_node world = xml_.root().child("world");
  for (pugi::xml_node other = world.next_sibling("world"); other; other = other.next_sibling("world"))
    parts_.notice(other, "a second <world> is left out");
  if (!world) world = xml_.root();  // the file contains models only
  auto scope = std::make_unique<SdfScope>(SdfScope{world, {}, {}});
  add_frames(*scope);
  return scope;
}

void SdfFrames::add_frames(SdfScope& scope) {
  for (const pugi::xml_node child : scope.node.children()) {
    parts_.visit(child);
    for (const char* what : {"model", "link", "frame", "joint"})
      if (is_named(child, what)) scope.frames.emplace(child.attribute("name").value(), child);
    if (is_named(child, "include") && child.child("name"))
      scope.frames.emplace(trimmed(child.child_value("name")), child);
  }
}

std::string SdfFrames::frame_of(pugi::xml_node pose) {
  const std::string name = pose.attribute("relative_to").value();
  return name.empty() ? pose.attribute("frame").value() : name;  // "frame" in versions before SDF 1.7
}

Placement SdfFrames::pose_in(pugi::xml_node pose) const {
  if (!pose) return {};
  const std::string_view format = pose.attribute("rotation_format").as_string("euler_rpy");
  const std::string_view text = pose.child_value();
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) return {};
  if (format == "quat_xyzw") {
    const std::vector<double> v = xml_.numbers(pose, text, 7, "<pose>");
    if (!(std::hypot(std::hypot(v[3], v[4]), std::hypot(v[5], v[6])) > 1e-6))
      xml_.fail(pose, "the quaternion of <pose> is zero");
    return {{v[0], v[1], v[2]}, turn_of_quaternion({v[3], v[4], v[5], v[6]})};
  }
  if (format != "euler_rpy") xml_.fail(pose, "rotation_format must be euler_rpy or quat_xyzw");
  std::vector<double> v = xml_.numbers(pose, text, 6, "<pose>");
  if (pose.attribute("degrees").as_bool())
    for (std::size_t k = 3; k < 6; ++k) v[k] = radians(v[k]);
  return {{v[0], v[1], v[2]}, turn_of({v[3], v[4], v[5]})};
}

void SdfFrames::report_frame(pugi::xml_node node, const std::string& name) {
  parts_.notice(node, fmt::format("<{}> '{}' is left out: its pose is relative to '{}', which is not a "
                                  "model, link, joint or frame there",
                                  name_in(node), sdf_name_of(node), shown_line(name)));
}

std::optional<Placement> SdfFrames::placed_in(SdfScope& scope, pugi::xml_node pose,
                                              const std::string& otherwise) {
  const std::string name = frame_of(pose);
  const std::optional<Placement> base = frame(scope, name.empty() ? otherwise : name);
  if (!base) return {};
  return *base * pose_in(pose);
}

std::optional<Placement> SdfFrames::frame(SdfScope& scope, const std::string& name) {
  constexpr int deepest = 64;
  if (name.empty() || name == "__model__") return scope.placed;
  if (name == "world" && !scope.frames.contains(name)) return Placement{};
  if (const auto known = scope.known.find(name); known != scope.known.end()) return known->second;
  if (depth_ >= deepest) return {};
  ++depth_;
  scope.known.emplace(name, std::nullopt);  // for frames that depend on each other
  const std::optional<Placement> found = looked_up(scope, name);
  scope.known.insert_or_assign(name, found);
  --depth_;
  return found;
}

std::optional<Placement> SdfFrames::looked_up(SdfScope& scope, const std::string& name) {
  if (const auto found = scope.frames.find(name); found != scope.frames.end()) {
    const pugi::xml_node node = found->second;
    if (is_named(node, "model") || is_named(node, "include")) {
      const SdfScope* inner = model(scope, node);
      return inner == nullptr ? std::nullopt : std::optional(inner->placed);
    }
    // A frame is attached to another one, and a joint to its child link.
    return placed_in(scope, node.child("pose"),
                     is_named(node, "frame")   ? std::string(node.attribute("attached_to").value())
                     : is_named(node, "joint") ? trimmed(node.child_value("child"))
                                               : std::string());
  }
  const std::size_t end = name.find("::");
  const std::string first = name.substr(0, end);
  const auto named = scope.frames.find(first);
  for (const pugi::xml_node node : scope.node.children()) {
    parts_.visit(node);
    const bool has_own_name = is_named(node, "include") && !node.child("name");
    if (!has_own_name && (named == scope.frames.end() || named->second != node) &&
        !sdf_true(node.attribute("merge").value()))
      continue;
    if (!is_named(node, "model") && !is_named(node, "include")) continue;
    SdfScope* const inner = model(scope, node);
    if (inner == nullptr) continue;
    if (inner->name == first)
      return end == name.npos ? std::optional(inner->placed) : frame(*inner, name.substr(end + 2));
    if (inner->is_merged)
      if (const auto found = frame(*inner, name)) return found;
  }
  return {};
}

std::unique_ptr<SdfScope> SdfFrames::opened(const SdfScope& outer, pugi::xml_node node) {
  constexpr std::size_t most_includes = 10'000;
  constexpr int most_levels = 16;
  auto made = std::make_unique<SdfScope>(SdfScope{node, sdf_name_of(node), {}, &outer});
  if (!is_named(node, "include")) return made;
  const std::string uri = node.child_value("uri");
  const auto left_out = [&](const std::string& why) {
    parts_.notice(node, fmt::format("<include> of '{}' is left out: {}", shown_line(trimmed(uri)), why));
    return nullptr;
  };
  if (++includes_ > most_includes)
    xml_.fail(node, fmt::format("the world has more than {} <include>: import its models separately",
                                most_includes));
  const pugi::xml_node root = parts_.included(node, uri);
  if (!root) return nullptr;
  const pugi::xml_node entity = entity_of(root);
  if (!entity && root.child("include")) return opened_by(outer, node, root);
  if (!entity) return left_out("its file contains no <model>");
  if (!is_named(entity, "model")) {
    if (is_named(entity, "light")) {
      parts_.without_effect(entity);
      made->node = {};
      return made;
    }
    return left_out(fmt::format("it is a <{}>, and tubefoot includes models", name_in(entity)));
  }
  int levels = 0;
  for (const SdfScope* at = &outer; at != nullptr; at = at->outer) {
    if (at->node == entity) return left_out("the model includes itself");
    if (at->is_included) ++levels;
  }
  if (levels >= most_levels)
    return left_out(fmt::format("models include each other more than {} levels deep", most_levels));
  made->node = made->posed = entity;
  made->is_included = true;
  made->is_merged = sdf_true(node.attribute("merge").value());
  const std::string name = trimmed(node.child_value("name"));
  made->name = name.empty() ? sdf_name_of(entity) : shown_line(name);
  for (const char* child : {"experimental:params", "plugin"})
    for (const pugi::xml_node more : node.children(child)) parts_.pass_over(more);
  return made;
}

/// Opens the model that a file names by an <include> of its own. The outer <include> precedes the inner one.
std::unique_ptr<SdfScope> SdfFrames::opened_by(const SdfScope& outer, pugi::xml_node node,
                                               pugi::xml_node root) {
  for (const SdfScope* at = &outer; at != nullptr; at = at->outer)
    if (at->node == root) {
      parts_.notice(node, fmt::format("<include> of '{}' is left out: the file includes itself",
                                      shown_line(trimmed(node.child_value("uri")))));
      return nullptr;
    }
  const SdfScope of_file{root, {}, {}, &outer, true};
  const pugi::xml_node inner = root.child("include");
  std::unique_ptr<SdfScope> made = opened(of_file, inner);
  if (!made) return nullptr;
  made->outer = &outer;
  if (inner.child("pose")) made->posed = inner;
  made->is_merged = sdf_true(node.attribute("merge").value());
  if (const std::string name = trimmed(node.child_value("name")); !name.empty())
    made->name = shown_line(name);
  return made;
}

SdfScope* SdfFrames::model(SdfScope& scope, pugi::xml_node node) {
  const void* key = node.internal_object();
  if (const auto known = scope.models.find(key); known != scope.models.end()) return known->second.get();
  scope.models.emplace(key, nullptr);  // for models whose poses depend on each other
  std::unique_ptr<SdfScope> made = opened(scope, node);
  if (!made) return nullptr;
  // The pose of an <include> replaces that of the model.
  const pugi::xml_node posed = made->is_included && !node.child("pose") ? made->posed : node;
  const std::optional<Placement> placed = placed_in(scope, posed.child("pose"), {});
  if (!placed) {
    report_frame(node, frame_of(posed.child("pose")));
    return nullptr;
  }
  add_frames(*made);
  std::string origin = trimmed(made->is_included ? node.child_value("placement_frame") : "");
  if (origin.empty()) origin = made->node.attribute("placement_frame").value();
  if (!origin.empty()) {
    const std::optional<Placement> in_model = frame(*made, origin);
    if (!in_model) {
      parts_.notice(node, fmt::format("<{}> '{}' is left out: it has no frame '{}' to be placed at",
                                      name_in(node), made->name, shown_line(origin)));
      return nullptr;
    }
    move(*made, *placed * inverse(*in_model));
  } else {
    made->placed = *placed;
  }
  SdfScope* const result = made.get();
  scope.models.insert_or_assign(key, std::move(made));
  return result;
}

std::optional<Placement> SdfFrames::place_of(SdfScope& scope, pugi::xml_node node) {
  if (is_named(node, "model") || is_named(node, "include")) {
    const SdfScope* inner = model(scope, node);
    return inner == nullptr ? std::nullopt : std::optional(inner->placed);
  }
  const std::optional<Placement> placed = placed_in(scope, node.child("pose"), {});
  if (!placed) report_frame(node, frame_of(node.child("pose")));
  return placed;
}

std::optional<Placement> SdfFrames::place_in_link(SdfScope& scope, pugi::xml_node node,
                                                  const Placement& link) {
  const pugi::xml_node pose = node.child("pose");
  const std::string name = frame_of(pose);
  if (name.empty()) return link * pose_in(pose);
  const std::optional<Placement> base = frame(scope, name);
  if (!base) {
    report_frame(node, name);
    return {};
  }
  return *base * pose_in(pose);
}

}  // namespace tubefoot
