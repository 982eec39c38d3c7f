// SPDX-License-Identifier: GPL-3.0-or-later
// Writes footprints as VTK's XML PolyData with one cell per convex piece of a footprint. Arrays are
// appended data in base64 ("VTK File Formats", XML).
#include <fmt/format.h>

#include <array>
#include <bit>
#include <deque>

#include "files/streamed_file.hpp"
#include "files/temporary_buffer.hpp"
#include "footprints/footprint_file.hpp"
#include "footprints/footprint_place.hpp"

namespace tubefoot {
namespace {

static_assert(std::endian::native == std::endian::little, "the file says LittleEndian");

/// Encodes bytes that arrive in portions as base64 (RFC 4648).
class Base64 {
 public:
  explicit Base64(StreamedFile& file) : file_(file) {}

  void add(std::span<const char> bytes) {
    for (const char byte : bytes) {
      group_ = group_ << 8 | static_cast<unsigned char>(byte);
      if (++held_ == 3) put(4);
    }
    file_.append(text_);
    text_.clear();
  }
  void finish() {
    if (const int missing = held_ == 0 ? 0 : 3 - held_; missing > 0) {
      group_ <<= 8 * missing;
      put(4 - missing);
      text_.append(static_cast<std::size_t>(missing), '=');
    }
    file_.append(text_);
    text_.clear();
  }
  static std::uint64_t length(std::uint64_t bytes) { return (bytes + 2) / 3 * 4; }

 private:
  void put(int letters) {
    static constexpr char alphabet[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (int k = 0; k < letters; ++k) text_ += alphabet[group_ >> (18 - 6 * k) & 63];
    group_ = 0;
    held_ = 0;
  }

  StreamedFile& file_;
  std::string text_;
  std::uint32_t group_ = 0;
  int held_ = 0;
};

class Vtp : public FootprintFile {
 public:
  Vtp(const std::filesystem::path& file, const FootprintSource& source) : file_(file), source_(source) {
    points_ = &array("Points", "Float64", 3);
    connectivity_ = &array("connectivity", "Int64");
    ends_ = &array("offsets", "Int64");
    footprint_ = &array("footprint", "Int64");
    share_ = &array("area_share", "Float64");
    for (const FootprintColumn& column : footprint_columns())
      cells_.push_back(&array(
          column.name, std::holds_alternative<FootprintColumn::Reals>(column.values) ? "Float64" : "UInt32"));
    occluder_ends_ = &array("occluder_end", "Int64");
    occluders_ = &array("occluders", "UInt32");
  }

  void add(const FootprintTable& table) override {
    for (const glm::dvec3& corner : table.corners_m) points_->bytes.put(corner);
    for (std::size_t row = 0; row < table.rows(); ++row) {
      const std::vector<double> shares = area_shares(table, row);
      for (const double share : shares) {
        footprint_->bytes.put(static_cast<std::int64_t>(rows_ + row));
        share_->bytes.put(share);
        for (std::size_t c = 0; c < cells_.size(); ++c)
          std::visit([&](auto values) { cells_[c]->bytes.put((table.*values)[row]); },
                     footprint_columns()[c].values);
      }
      occluder_ends_->bytes.put(static_cast<std::int64_t>(occluder_count_ + table.first_occluder[row + 1]));
    }
    for (std::size_t k = 0; k < table.corners_m.size(); ++k)
      connectivity_->bytes.put(static_cast<std::int64_t>(corner_count_ + k));
    for (std::size_t piece = 0; piece < table.pieces(); ++piece)
      ends_->bytes.put(static_cast<std::int64_t>(corner_count_ + table.first_corner[piece + 1]));
    for (const std::uint32_t facet : table.occluders) occluders_->bytes.put(facet);
    corner_count_ += table.corners_m.size();
    piece_count_ += table.pieces();
    occluder_count_ += table.occluders.size();
    rows_ += table.rows();
  }

  void close() override {
    std::uint64_t offset = 0;
    const auto entry = [&](const Array& array, std::optional<std::uint64_t> tuples = {}) {
      std::string text = fmt::format(R"(<DataArray type="{}" Name="{}" NumberOfComponents="{}")", array.type,
                                     array.name, array.components);
      if (tuples) text += fmt::format(R"( NumberOfTuples="{}")", *tuples);
      text += fmt::format(R"( format="appended" offset="{}"/>)", offset);
      offset += Base64::length(sizeof(std::uint64_t) + array.bytes.size());
      return text + "\n";
    };
    std::string head = fmt::format(
        "<?xml version=\"1.0\"?>\n<!-- tubefoot footprints of sensor {}: metres east, north and up of the "
        "origin of the scene -->\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
        "header_type=\"UInt64\">\n<PolyData>\n<FieldData>\n",
        as_word(source_.sensor));
    head += names("component_names", source_.scene.report.components);
    head += names("material_names", source_.scene.description.materials);
    // The arrays are declared in the order of the appended data.
    const std::string points = entry(*points_);
    std::string polys = entry(*connectivity_);
    polys += entry(*ends_);
    std::string cells = entry(*footprint_);
    cells += entry(*share_);
    for (const Array* array : cells_) cells += entry(*array);
    head += entry(*occluder_ends_, rows_);
    head += entry(*occluders_, occluder_count_);
    head += fmt::format(
        "</FieldData>\n<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" "
        "NumberOfStrips=\"0\" NumberOfPolys=\"{}\">\n"
        "<Points>\n{}</Points>\n<Polys>\n{}</Polys>\n<CellData>\n{}</CellData>\n</Piece>\n</PolyData>\n"
        "<AppendedData encoding=\"base64\">\n_",
        corner_count_, piece_count_, points, polys, cells);
    file_.append(head);
    for (Array& array : arrays_) {
      Base64 text(file_);
      const std::uint64_t size = array.bytes.size();
      text.add({reinterpret_cast<const char*>(&size), sizeof size});
      array.bytes.replay([&](std::span<const char> bytes) { text.add(bytes); });
      text.finish();
    }
    file_.append("\n</AppendedData>\n</VTKFile>\n");
    file_.close();
  }

 private:
  struct Array {
    const char *name, *type;
    int components;
    TemporaryBuffer bytes;
  };
  Array& array(const char* name, const char* type, int components = 1) {
    return arrays_.emplace_back(Array{name, type, components, TemporaryBuffer(file_.path())});
  }

  /// Returns texts as VTK writes strings in ASCII: the codes of the letters, and a 0 after each text.
  template <class Named>
  static std::string names(const char* name, const std::vector<Named>& list) {
    std::string text = fmt::format(R"(<Array type="String" Name="{}" NumberOfTuples="{}" format="ascii">)",
                                   name, list.size());
    for (const Named& one : list) {
      for (const unsigned char c : one.name) text += fmt::format(" {}", static_cast<int>(c));
      text += " 0";
    }
    return text + "</Array>\n";
  }

  StreamedFile file_;
  FootprintSource source_;
  std::deque<Array> arrays_;
  Array *points_, *connectivity_, *ends_, *footprint_, *share_, *occluder_ends_, *occluders_;
  std::vector<Array*> cells_;
  std::uint64_t corner_count_ = 0, piece_count_ = 0, occluder_count_ = 0, rows_ = 0;
};

}  // namespace

std::unique_ptr<FootprintFile> vtp_file(const std::filesystem::path& file, const FootprintSource& source) {
  return std::make_unique<Vtp>(file, source);
}

}  // namespace tubefoot
