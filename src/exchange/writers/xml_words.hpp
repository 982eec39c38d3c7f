// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <pugixml.hpp>
#include <string>
#include <string_view>

#include "exchange/exchanged_scene.hpp"

// What the two XML formats share. Elements of our own have a namespace: other readers pass over them.
namespace tubefoot {

inline constexpr const char* own_namespace = "https://tubefoot.org/exchange/1";

pugi::xml_node add(pugi::xml_node parent, const char* name);
pugi::xml_node add(pugi::xml_node parent, const char* name, const std::string& text);
pugi::xml_node add(pugi::xml_node parent, const char* name, double value);
/// Returns the node, for more of them.
pugi::xml_node set(pugi::xml_node node, const char* attribute, const std::string& value);
pugi::xml_node set(pugi::xml_node node, const char* attribute, double value);
void add_comment(pugi::xml_node parent, std::string_view text);

/// <tubefoot:scene>: title, ping, water and materials.
void add_own_scene(pugi::xml_node parent, const ExchangedScene& scene);
/// <tubefoot:sonar>: the keys of a scene file, and where it is as "x y z roll pitch yaw" of its own body in
/// the frame and the axes of `parent`.
void add_own_sonar(pugi::xml_node parent, const ExchangedSonar& sonar, const Placement& theirs);

/// "x y z" and "roll pitch yaw" of a placement.
std::string rpy_text(const Placement& theirs);

/// Throws std::runtime_error where the disk refuses.
void write_xml(const pugi::xml_document& document, const std::filesystem::path& file);

}  // namespace tubefoot
