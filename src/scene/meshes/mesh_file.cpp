// SPDX-License-Identifier: GPL-3.0-or-later

// Reads mesh files: it determines the format, reads the polygons, divides them into triangles, and converts
// the result to metres with z up.

#include "scene/meshes/mesh_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <glm/common.hpp>
#include <utility>

#include "files/file_format.hpp"
#include "files/input_registry.hpp"
#include "files/memory_at_hand.hpp"
#include "scene/meshes/mesh_file_model.hpp"
#include "scene/meshes/mesh_file_polygons.hpp"

namespace tubefoot {
namespace {

using Parser = UncheckedPolygons (*)(std::string_view, const std::string&);

Parser parser_of(const std::string& extension) {
  return extension == ".obj"   ? parse_obj
         : extension == ".ply" ? parse_ply
         : extension == ".stl" ? parse_stl
         : extension == ".off" ? parse_off
                               : nullptr;
}

bool is_model_name(const std::string& extension) {
  return extension == ".dae" || extension == ".gltf" || extension == ".glb" || extension == ".3ds" ||
         extension == ".fbx";
}

/// Returns whether a text is UTF-16: with a byte order mark, or with every second byte 0 at its beginning.
bool is_utf16(std::string_view text) {
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff")) return true;
  if (text.size() < 4) return false;
  const auto letter = [&](std::size_t i) { return text[i] >= ' ' && text[i] <= '~'; };
  return (letter(0) && text[1] == 0 && letter(2) && text[3] == 0) ||
         (text[0] == 0 && letter(1) && text[2] == 0 && letter(3));
}

std::string mesh_text(const std::filesystem::path& file) {
  const SourcePlace place{file.string(), 0, 0};
  const InputFile input(file);
  // Memory for the text and for the data from it.
  require_memory(3 * static_cast<double>(input.size()), place, fmt::format("its {} bytes", input.size()),
                 "give a coarser mesh, or one that is cut to the scene");
  std::string content = read_whole(file, place, input.size(), "a mesh that no program is writing");
  if (content.starts_with("\xef\xbb\xbf")) content.erase(0, 3);
  if (is_utf16(content))
    throw InputError(
        place,
        "is text in UTF-16, expected UTF-8: save it in UTF-8, or convert it with iconv -f UTF-16 -t UTF-8");
  if (content.find_first_not_of(" \t\r\n") == content.npos)
    throw InputError(place, "is empty, expected a mesh");
  return content;
}

/// Rotates by 90 degrees about the axis that stays, so that `up` becomes z, and scales to metres.
void to_metres_z_up(NamedMesh& mesh, const std::string& up, double unit_m) {
  for (glm::dvec3& p : mesh.points_m) {
    if (up == "y") p = {p.x, -p.z, p.y};
    if (up == "x") p = {-p.z, p.y, p.x};
    p *= unit_m;
  }
}

/// Warns of rounding, because Assimp keeps only 24 bits of a number.
void warn_of_rounding(NamedMesh& mesh, const std::string& file) {
  double largest_m = 0;
  for (const glm::dvec3& p : mesh.points_m) {
    const glm::dvec3 size = glm::abs(p);
    largest_m = std::max({largest_m, size.x, size.y, size.z});
  }
  constexpr double worth_telling_m = 1e-3;
  if (largest_m * 0x1p-24 > worth_telling_m)
    mesh.warnings.push_back(
        fmt::format("{}: its coordinates of up to {:.3g} m are read in single precision and rounded by up to "
                    "{:.2g} m: move the model to its own origin, or export it as OBJ",
                    file, largest_m, largest_m * 0x1p-24));
}

NamedMesh mesh_of_model(const std::filesystem::path& file, FileFormat format, const MeshAxes& axes) {
  const std::string name = file.string();
  Model model = read_model(file, format);
  std::optional<std::string> up = axes.up ? axes.up : model.declared.up;
  if (!up) up = axes.up_unless_stated;
  std::optional<double> unit_m = axes.unit_m ? axes.unit_m : model.declared.unit_m;
  if (!unit_m) unit_m = axes.unit_unless_stated_m;
  const bool by_default = !unit_m && model.declared.default_unit_m;
  if (by_default) unit_m = model.declared.default_unit_m;
  if (!up || !unit_m)
    throw InputError(
        {name, 0, 0},
        fmt::format("does not define {}{}{}, {}: add {}{}{} to the object", !up ? "its vertical axis" : "",
                    !up && !unit_m ? " and " : "", !unit_m ? "its unit of length" : "",
                    format == FileFormat::studio_3ds ? "which no 3DS file does"
                                                     : "although other files of its format do",
                    !up ? "'up' (\"x\", \"y\" or \"z\")" : "", !up && !unit_m ? " and " : "",
                    !unit_m ? "'unit_m' (its length in metres)" : ""));
  NamedMesh mesh = triangulate(std::move(model.polygons), name);
  to_metres_z_up(mesh, *up, *unit_m);
  if (by_default)
    mesh.warnings.push_back(fmt::format(
        "{}: it states no unit of length, so its unit is {} m, the default of its format; another length "
        "needs 'unit_m' of the object",
        name, *unit_m));
  warn_of_rounding(mesh, name);
  return mesh;
}

}  // namespace

NamedMesh read_mesh_file(const std::filesystem::path& file, const MeshAxes& axes) {
  const std::string name = file.string();
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const FileFormat format = format_of(file);
  const Parser parse = parser_of(extension);
  if (parse == nullptr && is_model(format)) return mesh_of_model(file, format, axes);
  const auto fail = [&name](const std::string& what) { throw InputError({name, 0, 0}, what); };
  if (is_model_name(extension))
    fail(fmt::format("does not begin like a {} file: it is {}", extension,
                     InputFile(file).size() == 0 ? "empty" : "of another format, or damaged"));
  if (parse == nullptr)
    fail(
        fmt::format("'{}' is not a mesh format that tubefoot reads: expected .obj, .ply, .stl, .off, .dae, "
                    ".gltf, .glb, .3ds or .fbx",
                    extension));
  if (is_model(format) && extension != ".stl")
    fail(fmt::format("begins like {}: give the file the extension of this format, not {}", name_of(format),
                     extension));
  NamedMesh mesh = triangulate(parse(mesh_text(file), name), name);
  to_metres_z_up(mesh, axes.up.value_or(axes.up_unless_stated.value_or("z")),
                 axes.unit_m.value_or(axes.unit_unless_stated_m.value_or(1)));
  return mesh;
}

}  // namespace tubefoot
