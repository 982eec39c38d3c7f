// SPDX-License-Identifier: GPL-3.0-or-later
// Writes footprints as polygon meshes. An OBJ file has one face per convex piece of a footprint and states
// the columns in comments. A PLY file has the columns as properties of its faces.
#include <fmt/format.h>

#include <bit>

#include "files/checked_file.hpp"
#include "files/streamed_file.hpp"
#include "files/temporary_buffer.hpp"
#include "footprints/footprint_file.hpp"
#include "footprints/footprint_place.hpp"
#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

static_assert(std::endian::native == std::endian::little, "PLY is written in the byte order of the machine");

class Obj : public FootprintFile {
 public:
  Obj(const std::filesystem::path& file, const FootprintSource& source) : file_(file), source_(source) {
    std::string head = fmt::format(
        "# tubefoot footprints of sensor {}: metres east, north and up of the origin of the scene\n# "
        "columns:",
        as_word(source.sensor));
    for (const FootprintColumn& column : footprint_columns()) head += fmt::format(" {}", column.name);
    file_.append(head + "\n");
  }

  void add(const FootprintTable& table) override {
    for (std::size_t row = 0; row < table.rows(); ++row) {
      stop_if_wanted();
      std::string text = "# footprint";
      for (const FootprintColumn& column : footprint_columns())
        std::visit([&](auto values) { text += fmt::format(" {}", (table.*values)[row]); }, column.values);
      text += fmt::format("\ng ping_{}_transmission_{}_beam_{}\nusemtl {}\n", table.ping[row],
                          table.transmission[row], table.beam[row],
                          as_word(material_name(source_.scene, table, row)));
      for (std::uint64_t piece = table.first_piece[row]; piece < table.first_piece[row + 1]; ++piece) {
        std::string face = "f";
        for (const glm::dvec3& p : table.corners_of(piece)) {
          text += fmt::format("v {} {} {}\n", p.x, p.y, p.z);
          face += fmt::format(" {}", ++vertices_);
        }
        text += face + "\n";
      }
      file_.append(text);
    }
  }
  void close() override { file_.close(); }

 private:
  StreamedFile file_;
  FootprintSource source_;
  std::uint64_t vertices_ = 0;
};

class Ply : public FootprintFile {
 public:
  Ply(const std::filesystem::path& file, const FootprintSource& source)
      : file_(file), source_(source), vertices_(file), faces_(file) {}

  void add(const FootprintTable& table) override {
    if (count_.vertices + table.corners_m.size() > most_vertices)
      throw write_error(file_.path(), fmt::format("the file would have more than {} corners, the limit of "
                                                  "PLY: write fewer pings, or use another format",
                                                  most_vertices));
    for (const glm::dvec3& corner : table.corners_m) vertices_.put(corner);
    for (std::size_t row = 0; row < table.rows(); ++row) {
      stop_if_wanted();
      const std::vector<double> shares = area_shares(table, row);
      for (std::uint64_t piece = table.first_piece[row]; piece < table.first_piece[row + 1]; ++piece) {
        const auto corners = static_cast<std::uint32_t>(table.corners_of(piece).size());
        faces_.put(corners);
        for (std::uint32_t k = 0; k < corners; ++k)
          faces_.put(static_cast<std::int32_t>(count_.vertices + table.first_corner[piece] + k));
        faces_.put(static_cast<std::uint32_t>(count_.rows + row));
        faces_.put(shares[piece - table.first_piece[row]]);
        for (const FootprintColumn& column : footprint_columns())
          std::visit([&](auto values) { faces_.put((table.*values)[row]); }, column.values);
      }
    }
    count_.vertices += table.corners_m.size();
    count_.faces += table.pieces();
    count_.rows += table.rows();
  }

  void close() override {
    std::string head = fmt::format(
        "ply\nformat binary_little_endian 1.0\ncomment tubefoot footprints of sensor {}: metres east, north "
        "and up of the origin of the scene\n",
        as_word(source_.sensor));
    const auto names = [&](const char* what, const auto& list) {
      for (std::size_t k = 0; k < list.size(); ++k)
        head += fmt::format("comment {} {} {}\n", what, k, as_word(list[k].name));
    };
    names("component", source_.scene.report.components);
    names("material", source_.scene.description.materials);
    head += fmt::format(
        "element vertex {}\nproperty double x\nproperty double y\nproperty double z\n"
        "element face {}\nproperty list uint int vertex_indices\nproperty uint footprint\n"
        "property double area_share\n",
        count_.vertices, count_.faces);
    for (const FootprintColumn& column : footprint_columns())
      head += fmt::format("property {} {}\n",
                          std::holds_alternative<FootprintColumn::Reals>(column.values) ? "double" : "uint",
                          column.name);
    file_.append(head + "end_header\n");
    for (TemporaryBuffer* temporary_buffer : {&vertices_, &faces_})
      temporary_buffer->replay([&](std::span<const char> bytes) {
        file_.append({bytes.data(), bytes.size()});
      });
    file_.close();
  }

 private:
  static constexpr std::uint64_t most_vertices = 0x7fffffff;

  StreamedFile file_;
  FootprintSource source_;
  TemporaryBuffer vertices_, faces_;
  struct {
    std::uint64_t vertices = 0, faces = 0, rows = 0;
  } count_;
};

}  // namespace

std::unique_ptr<FootprintFile> obj_file(const std::filesystem::path& file, const FootprintSource& source) {
  return std::make_unique<Obj>(file, source);
}

std::unique_ptr<FootprintFile> ply_file(const std::filesystem::path& file, const FootprintSource& source) {
  return std::make_unique<Ply>(file, source);
}

}  // namespace tubefoot
