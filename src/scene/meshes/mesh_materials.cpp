// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/meshes/mesh_materials.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string_view>
#include <unordered_set>

#include "files/words.hpp"

namespace tubefoot {
namespace {

std::uint16_t index_of(const std::vector<MaterialDescription>& materials, const std::string& name,
                       const SourcePlace& place) {
  const auto found = std::ranges::find(materials, name, &MaterialDescription::name);
  if (found == materials.end()) throw InputError(place, fmt::format("there is no material named '{}'", name));
  return static_cast<std::uint16_t>(found - materials.begin());
}

void refuse_unmet(const std::vector<MaterialClass>& table, const std::vector<bool>& met,
                  const NamedMesh& mesh) {
  const auto unmet = std::ranges::find(met, false);
  if (unmet == met.end()) return;
  const MaterialClass& entry = table[static_cast<std::size_t>(unmet - met.begin())];
  std::vector<std::string> names;  // each once, in order
  std::unordered_set<std::string_view> known;
  for (const auto& together : mesh.names)
    for (const std::string& name : together)
      if (known.insert(name).second) names.push_back(name);
  constexpr std::size_t most_named = 20;
  const std::string_view meant = nearest(entry.value, names);
  if (names.size() > most_named) names.resize(most_named);
  throw InputError(entry.place, fmt::format("no face of the mesh has the name \"{}\": {}", entry.value,
                                            names.empty()    ? "its faces have no names"
                                            : !meant.empty() ? fmt::format("did you mean \"{}\"?", meant)
                                                             : "expected " + one_of(names, '"')));
}

}  // namespace

std::vector<NamedFacets> apply_mesh_materials(NamedMesh& mesh, const ObjectDescription& object,
                                              const std::vector<MaterialDescription>& materials) {
  const auto* file = std::get_if<MeshFile>(&object.kind);
  const std::vector<MaterialClass> table = file != nullptr ? file->materials : std::vector<MaterialClass>();
  const std::uint16_t own = index_of(materials, object.material, object.material_place);
  std::vector<bool> met(table.size(), false);
  std::vector<NamedFacets> listed;
  std::map<std::pair<std::string, std::string>, std::size_t> listed_at;
  std::vector<std::uint16_t> material(mesh.names.size(), own);
  std::vector<std::size_t> entry(mesh.names.size());
  for (std::size_t i = 0; i < mesh.names.size(); ++i) {
    const std::vector<std::string>& names = mesh.names[i];
    const MaterialClass* found = nullptr;
    for (const std::string& name : names) {
      const auto at = std::ranges::find(table, name, &MaterialClass::value);
      if (at == table.end()) continue;
      // Later names count as used, too. An entry for a group is no error if an entry for a material
      // precedes it.
      met[static_cast<std::size_t>(at - table.begin())] = true;
      if (found == nullptr) found = &*at;
    }
    if (found != nullptr) material[i] = index_of(materials, found->material, found->place);
    const std::string called = found != nullptr ? found->value : names.empty() ? "" : names.front();
    const std::string& becomes = materials[material[i]].name;
    const auto [known, is_new] = listed_at.emplace(std::pair(called, becomes), listed.size());
    if (is_new) listed.push_back({called, becomes, 0});
    entry[i] = known->second;
  }
  refuse_unmet(table, met, mesh);
  if (mesh.names_of.empty()) return {};
  if (!table.empty()) mesh.materials.reserve(mesh.names_of.size());
  for (const std::uint32_t names : mesh.names_of) {
    ++listed[entry[names]].facets;
    if (!table.empty()) mesh.materials.push_back(material[names]);
  }
  std::erase_if(listed, [](const NamedFacets& named) { return named.facets == 0; });
  if (listed.size() == 1 && listed.front().name.empty()) listed.clear();
  return listed;
}

}  // namespace tubefoot
