// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/mesh_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>

#include "files/inlet.hpp"
#include "files/memory_at_hand.hpp"
#include "scene/mesh_file_polygons.hpp"

namespace tubefoot {
namespace {

std::string mesh_text(const std::filesystem::path& file) {
  const SourcePlace place{file.string(), 0, 0};
  const InputFile input(file);
  // The text, and what is made of it.
  require_memory(3 * static_cast<double>(input.size()), place, fmt::format("its {} bytes", input.size()),
                 "give a coarser mesh, or one cut to the scene");
  std::string content = read_whole(file, place, input.size(), "a mesh that nobody is writing to");
  if (content.find_first_not_of(" \t\r\n") == content.npos)
    throw InputError(place, "is empty, expected a mesh");
  return content;
}

}  // namespace

ComponentMesh read_mesh_file(const std::filesystem::path& file) {
  const std::string name = file.string();
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto parse = extension == ".obj"   ? parse_obj
                     : extension == ".ply" ? parse_ply
                     : extension == ".stl" ? parse_stl
                     : extension == ".off" ? parse_off
                                           : nullptr;
  if (parse == nullptr) {
    throw InputError(
        {name, 0, 0},
        fmt::format("'{}' is no mesh format that is read: expected .obj, .ply, .stl or .off", extension));
  }
  PolygonSoup soup = parse(mesh_text(file), name);
  return triangulate(std::move(soup), name);
}

}  // namespace tubefoot
