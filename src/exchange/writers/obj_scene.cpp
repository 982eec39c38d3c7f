// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <set>

#include "exchange/obj_mesh.hpp"
#include "exchange/writers/scene_writers.hpp"
#include "files/checked_file.hpp"

namespace tubefoot {
namespace {

/// Returns material names for OBJ, in which white space ends a name.
std::vector<std::string> material_names(const ExchangedScene& scene) {
  std::set<std::string> taken;
  std::vector<std::string> names;
  for (const ExchangedMaterial& material : scene.materials) {
    std::string name;
    for (const char c : material.name) name += static_cast<unsigned char>(c) <= ' ' || c == 127 ? '_' : c;
    const std::string first = name;
    for (int k = 2; !taken.insert(name).second; ++k) name = fmt::format("{}_{}", first, k);
    names.push_back(name);
  }
  return names;
}

}  // namespace

WrittenScene write_obj_scene(const ExchangedScene& scene, const std::filesystem::path& folder) {
  const std::vector<std::string> names = material_names(scene);
  ObjMesh mesh(folder / "scene.obj", axes_words(ExchangeFormat::obj));
  mesh.line("mtllib scene.mtl");
  for (const ExchangedPiece& piece : scene.pieces)
    mesh.object(piece.file_stem, names[piece.material], piece.points_m, piece.triangles);
  mesh.close();
  std::string colours =
      commented("Grey levels show lambert_db, because OBJ cannot describe how a material scatters sound.");
  for (std::size_t k = 0; k < names.size(); ++k) {
    const double grey = grey_of(scene.materials[k]);
    colours += fmt::format("newmtl {}\n# lambert_db {}\nKd {} {} {}\nKa 0 0 0\nKs 0 0 0\nd 1\nillum 1\n",
                           names[k], scene.materials[k].lambert_db, grey, grey, grey);
  }
  write_file(folder / "scene.mtl", std::string_view(colours));
  return {{"scene.obj", "scene.mtl"}, {"OBJ cannot describe sonars: only README.txt lists them"}};
}

}  // namespace tubefoot
