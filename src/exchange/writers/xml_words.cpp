// SPDX-License-Identifier: GPL-3.0-or-later
#include "exchange/writers/xml_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "exchange/obj_mesh.hpp"
#include "exchange/plain_number.hpp"
#include "files/checked_file.hpp"
#include "files/shown.hpp"

namespace tubefoot {

pugi::xml_node add(pugi::xml_node parent, const char* name) { return parent.append_child(name); }

pugi::xml_node add(pugi::xml_node parent, const char* name, const std::string& text) {
  pugi::xml_node node = parent.append_child(name);
  node.text().set(shown_line(text).c_str());
  return node;
}

pugi::xml_node add(pugi::xml_node parent, const char* name, double value) {
  return add(parent, name, fmt::format("{}", plain(value)));
}

pugi::xml_node set(pugi::xml_node node, const char* attribute, const std::string& value) {
  node.append_attribute(attribute).set_value(harmless(value).c_str());
  return node;
}

pugi::xml_node set(pugi::xml_node node, const char* attribute, double value) {
  return set(node, attribute, fmt::format("{}", plain(value)));
}

void add_comment(pugi::xml_node parent, std::string_view text) {
  parent.append_child(pugi::node_comment).set_value(fmt::format(" {} ", text).c_str());
}

void add_own_scene(pugi::xml_node parent, const ExchangedScene& scene) {
  const pugi::xml_node own = add(parent, "tubefoot:scene");
  set(own, "title", scene.title);
  set(own, "ping", static_cast<double>(scene.ping));
  set(own, "sound_speed_m_s", scene.sound_speed_m_s);
  const auto& sonars = scene.sonars;
  if (!sonars.empty() && std::ranges::all_of(sonars, [&](const ExchangedSonar& other) {
        return other.absorption_db_per_km == sonars.front().absorption_db_per_km;
      }))
    set(own, "absorption_db_per_km", sonars.front().absorption_db_per_km);
  for (const ExchangedMaterial& material : scene.materials) {
    const pugi::xml_node node = add(own, "tubefoot:material");
    set(node, "name", material.name);
    set(node, "lambert_db", material.lambert_db);
  }
}

void add_own_sonar(pugi::xml_node parent, const ExchangedSonar& sonar, const Placement& theirs) {
  const pugi::xml_node own = add(parent, "tubefoot:sonar");
  set(own, "name", sonar.name);
  set(own, "kind", sonar.kind);
  set(own, "pose", fmt::format("{} {}", numbers_text(theirs.position_m), rpy_text(theirs)));
  for (const auto& [key, value] : sonar.keys) set(own, key.c_str(), value);
}

std::string rpy_text(const Placement& theirs) { return numbers_text(roll_pitch_yaw(theirs.turn)); }

void write_xml(const pugi::xml_document& document, const std::filesystem::path& file) {
  std::ostringstream text;
  document.save(text, "  ", pugi::format_default, pugi::encoding_utf8);
  write_file(file, std::string_view(text.str()));
}

}  // namespace tubefoot
