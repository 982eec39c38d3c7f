// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <pugixml.hpp>
#include <string>
#include <string_view>

#include "exchange/exchanged_scene.hpp"

// Common functions of the two XML formats. Elements of tubefoot have a namespace of their own, so that
// other readers ignore them.
namespace tubefoot {

inline constexpr const char* own_namespace = "https://tubefoot.org/exchange/1";

pugi::xml_node add(pugi::xml_node parent, const char* name);
pugi::xml_node add(pugi::xml_node parent, const char* name, const std::string& text);
pugi::xml_node add(pugi::xml_node parent, const char* name, double value);
/// Sets an attribute and returns the node, so that calls can be nested.
pugi::xml_node set(pugi::xml_node node, const char* attribute, const std::string& value);
pugi::xml_node set(pugi::xml_node node, const char* attribute, double value);
void add_comment(pugi::xml_node parent, std::string_view text);

/// Adds <tubefoot:scene>: title, ping, water and materials.
void add_own_scene(pugi::xml_node parent, const ExchangedScene& scene);
/// Adds <tubefoot:sonar> with the keys of a scene file and the placement of the body of the sonar. The
/// placement is "x y z roll pitch yaw" in the frame and the axes of `parent`.
void add_own_sonar(pugi::xml_node parent, const ExchangedSonar& sonar, const Placement& theirs);

/// Formats a placement as "x y z" and "roll pitch yaw".
std::string rpy_text(const Placement& theirs);

/// Throws std::runtime_error on a write error.
void write_xml(const pugi::xml_document& document, const std::filesystem::path& file);

}  // namespace tubefoot
