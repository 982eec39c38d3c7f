// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <netcdf.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "files/file_format.hpp"
#include "files/hdf5_file.hpp"
#include "files/input_registry.hpp"
#include "files/library_settings.hpp"
#include "files/limits.hpp"
#include "files/memory_at_hand.hpp"
#include "files/netcdf_size.hpp"
#include "geometry/steps/stop.hpp"
#include "sensors/recordings/whole_echo_file.hpp"

// Reads netCDF files of other programs. Sizes are checked before memory is allocated, and every message
// names file and variable. NetcdfInput is an open file, and EchoGroupInput is one of its groups.
namespace tubefoot {

/// The expected kind of file, and the page that describes its layout.
struct ExpectedNetcdf {
  const char* what = "an echo file (echoes.nc)";
  const char* page = "docs/output-files.md";
};
inline constexpr std::size_t longest_text = 1 << 16;

/// Product of the factors; empty on overflow.
inline std::optional<std::uintmax_t> product(std::span<const std::size_t> factors) {
  std::uintmax_t result = 1;
  for (const std::size_t factor : factors)
    if (__builtin_mul_overflow(result, factor, &result)) return std::nullopt;
  return result;
}

/// A netCDF file open for reading. The constructor checks the file first and throws InputError.
class NetcdfInput {
 public:
  explicit NetcdfInput(const std::filesystem::path& path, ExpectedNetcdf expected = {})
      : path_(path), expected_(expected) {
    std::error_code error;
    if (!std::filesystem::exists(path, error)) fail("there is no such file");
    const InputFile input(path, {path.string()}, expected.what);
    bytes_ = input.size();
    const FileFormat format = format_of(path);
    if (format == FileFormat::netcdf_classic) {
      if (const auto needed = netcdf_classic_size(path); needed && *needed > bytes_)
        fail(fmt::format("the file is cut off: its header describes more than its {} bytes; write it again",
                         bytes_));
    } else if (is_hdf5(format)) {
      refuse_hdf5_references(path);
    } else {
      fail("cannot be read as netCDF: the file has another format, or is cut off or damaged; write it again");
    }
    keep_libraries_to_themselves();
    // This name lets netCDF treat any file name as a plain file.
    const std::string name = fmt::format("/proc/self/fd/{}", input.descriptor());
    const int status = nc_open(name.c_str(), NC_NOWRITE, &id_);
    if (status == NC_ENOTNC || status == NC_EHDFERR)
      fail("cannot be read as netCDF: the file has another format, or is cut off or damaged; write it again");
    check(status, "open the file");
  }
  ~NetcdfInput() {
    if (id_ >= 0) nc_close(id_);
  }
  NetcdfInput(const NetcdfInput&) = delete;
  NetcdfInput& operator=(const NetcdfInput&) = delete;

  int id() const { return id_; }
  std::uintmax_t bytes() const { return bytes_; }
  const std::filesystem::path& path() const { return path_; }
  const char* page() const { return expected_.page; }

  [[noreturn]] void fail(const std::string& message) const { throw InputError({path_.string()}, message); }
  void check(int status, const std::string& task) const {
    if (status == NC_NOERR) return;
    fail(fmt::format("cannot {}: {}: the file is damaged or cut off; write it again", task,
                     nc_strerror(status)));
  }

 private:
  std::filesystem::path path_;
  ExpectedNetcdf expected_;
  int id_ = -1;
  std::uintmax_t bytes_ = 0;
};

/// One group. `prefix` precedes the names of its variables in messages: "" or "camera/".
class EchoGroupInput {
 public:
  EchoGroupInput(const NetcdfInput& file, int id, std::string prefix)
      : file_(file), id_(id), prefix_(std::move(prefix)) {}

  bool has(const char* variable) const { return find(variable).has_value(); }

  /// Memory for the values of a variable by its dimensions; 0 if the variable is missing. Throws if the file
  /// is too small for that many values.
  double bytes_of(const char* name) const {
    const auto variable = find(name);
    if (!variable) return 0;
    return sizeof(double) * static_cast<double>(claimed_count(name, *variable, shape_of(*variable)));
  }

  /// A text attribute of the group; empty if it is missing.
  std::string text(const char* attribute) const { return text(NC_GLOBAL, attribute).value_or(""); }

  /// Names of the numeric variables with at least one dimension and one value.
  std::vector<std::string> tables() const {
    int count = 0;
    file_.check(nc_inq_varids(id_, &count, nullptr), "count variables");
    std::vector<int> ids(static_cast<std::size_t>(count));
    file_.check(nc_inq_varids(id_, &count, ids.data()), "list variables");
    std::vector<std::string> names;
    for (const int id : ids) {
      char name[NC_MAX_NAME + 1] = {};
      file_.check(nc_inq_varname(id_, id, name), "read a variable's name");
      nc_type type = 0;
      file_.check(nc_inq_vartype(id_, id, &type), "read a variable's type");
      const bool number = type >= NC_BYTE && type <= NC_UINT64 && type != NC_CHAR;
      const std::vector<std::size_t> shape = shape_of(id);
      if (number && !shape.empty() && product(shape) != 0) names.emplace_back(name);
    }
    return names;
  }

  /// Reads a whole numeric variable without conversion.
  EchoVariable table(const std::string& name) const {
    const int id = *find(name.c_str());
    const auto said = [&](const char* attribute) { return text(id, attribute).value_or(""); };
    EchoVariable variable{
        name, words_of(id), shape_of(id), said("units"), said("long_name"), said("flag_meanings"), {}};
    variable.values.resize(checked_count(name.c_str(), id, variable.shape));
    read_slabs(name.c_str(), id, variable.shape, variable.values);
    return variable;
  }

  /// The group's own attributes that are a text or a number.
  std::vector<EchoAttribute> attributes() const {
    int count = 0;
    file_.check(nc_inq_natts(id_, &count), "count attributes");
    std::vector<EchoAttribute> all;
    for (int k = 0; k < count; ++k) {
      char name[NC_MAX_NAME + 1] = {};
      nc_type type = 0;
      std::size_t length = 0;
      file_.check(nc_inq_attname(id_, NC_GLOBAL, k, name), "read an attribute's name");
      file_.check(nc_inq_att(id_, NC_GLOBAL, name, &type, &length), "read an attribute");
      if (type == NC_CHAR && length > longest_text) continue;
      if (type == NC_CHAR || (type == NC_STRING && length == 1)) {
        all.push_back({name, text(name)});
      } else if (type != NC_STRING && type <= NC_UINT64 && length == 1) {
        double value = 0;
        file_.check(nc_get_att_double(id_, NC_GLOBAL, name, &value), "read an attribute");
        all.push_back({name, value});
      }
    }
    return all;
  }

  /// Values of a variable that must have these dimensions and one of these units.
  std::vector<double> values(const char* name, const std::vector<std::string>& dimensions,
                             std::span<const std::string_view> units,
                             std::vector<std::size_t>* lengths = nullptr) const {
    const std::vector<std::size_t> shape = checked_shape(name, dimensions, units);
    if (lengths) *lengths = shape;
    std::vector<double> result(*product(shape));
    read_into(name, dimensions, result);
    return result;
  }

  /// Lengths of the variable's dimensions. Performs all checks that are possible before the values are read.
  std::vector<std::size_t> checked_shape(const char* name, const std::vector<std::string>& dimensions,
                                         std::span<const std::string_view> units) const {
    const auto variable = find(name);
    if (!variable)
      fail(name, fmt::format("is missing; expected dimensions ({}) and unit '{}'",
                             fmt::join(dimensions, ", "), units.front()));
    check_dimensions(name, *variable, dimensions);
    check_type(name, *variable);
    check_unit(name, *variable, units);
    const std::vector<std::size_t> shape = shape_of(*variable);
    checked_count(name, *variable, shape);
    return shape;
  }

  /// Reads all values of a variable of that shape.
  void read_into(const char* name, const std::vector<std::string>& dimensions,
                 std::span<double> values) const {
    const int variable = *find(name);
    const std::vector<std::size_t> shape = shape_of(variable);
    read_slabs(name, variable, shape, values);
    check_written(name, variable, dimensions, shape, values);
  }

  /// Throws unless `good` is true for every value; `expected` describes that condition.
  template <typename Good>
  void require(const char* name, const std::vector<std::string>& dimensions,
               const std::vector<std::size_t>& shape, const std::vector<double>& values, Good good,
               const char* expected) const {
    const auto bad = std::find_if_not(values.begin(), values.end(), good);
    if (bad == values.end()) return;
    fail(name,
         fmt::format("holds {} at {}; expected {}", *bad,
                     place(dimensions, shape, static_cast<std::size_t>(bad - values.begin())), expected));
  }

  [[noreturn]] void fail(const char* name, const std::string& message) const {
    file_.fail(
        fmt::format("variable '{}{}' {} (see {} for the layout)", prefix_, name, message, file_.page()));
  }

 private:
  std::optional<int> find(const char* name) const {
    int variable = 0;
    const int status = nc_inq_varid(id_, name, &variable);
    if (status == NC_ENOTVAR) return std::nullopt;
    file_.check(status, fmt::format("find variable '{}{}'", prefix_, name));
    return variable;
  }

  std::optional<std::string> text(int variable, const char* attribute) const {
    nc_type type = 0;
    std::size_t length = 0;
    const int status = nc_inq_att(id_, variable, attribute, &type, &length);
    if (status == NC_ENOTATT) return std::nullopt;
    const std::string task = fmt::format("read attribute '{}{}'", prefix_, attribute);
    file_.check(status, task);
    if (length > longest_text) file_.fail(fmt::format("attribute '{}{}' is too long", prefix_, attribute));
    std::string result;
    if (type == NC_CHAR) {
      result.resize(length);
      file_.check(nc_get_att_text(id_, variable, attribute, result.data()), task);
      result.resize(std::min(result.size(), result.find('\0')));  // some writers terminate texts as C does
    } else if (type == NC_STRING && length == 1) {
      char* string = nullptr;
      file_.check(nc_get_att_string(id_, variable, attribute, &string), task);
      if (string) result = string;
      nc_free_string(1, &string);
    } else {
      file_.fail(fmt::format("attribute '{}{}' is not text: write it as one string", prefix_, attribute));
    }
    return result;
  }

  std::vector<int> dimension_ids(int variable) const {
    int count = 0;
    file_.check(nc_inq_varndims(id_, variable, &count), "count dimensions");
    std::vector<int> ids(static_cast<std::size_t>(count));
    file_.check(nc_inq_vardimid(id_, variable, ids.data()), "list dimensions");
    return ids;
  }

  std::vector<std::size_t> shape_of(int variable) const {
    std::vector<std::size_t> lengths;
    for (const int dimension : dimension_ids(variable)) {
      lengths.emplace_back();
      file_.check(nc_inq_dimlen(id_, dimension, &lengths.back()), "read a dimension's length");
    }
    return lengths;
  }

  std::vector<std::string> words_of(int variable) const {
    std::vector<std::string> found;
    for (const int dimension : dimension_ids(variable)) {
      char word[NC_MAX_NAME + 1] = {};
      file_.check(nc_inq_dimname(id_, dimension, word), "read a dimension's name");
      found.emplace_back(word);
    }
    return found;
  }

  void check_dimensions(const char* name, int variable, const std::vector<std::string>& expected) const {
    const std::vector<std::string> found = words_of(variable);
    if (found != expected)
      fail(name, fmt::format("has dimensions ({}), expected ({}): write it with these names in this order",
                             fmt::join(found, ", "), fmt::join(expected, ", ")));
  }

  void check_type(const char* name, int variable) const {
    nc_type type = 0;
    file_.check(nc_inq_vartype(id_, variable, &type), "read a variable's type");
    if (type == NC_DOUBLE || type == NC_FLOAT) return;
    char word[NC_MAX_NAME + 1] = "unknown";
    nc_inq_type(id_, type, word, nullptr);
    fail(name,
         fmt::format("has type {}, expected float64 (or float32): write plain floating-point values", word));
  }

  void check_unit(const char* name, int variable, std::span<const std::string_view> expected) const {
    const auto unit = text(variable, "units");
    if (!unit)
      fail(name,
           fmt::format(
               "has no unit, expected '{0}': if the values have this unit, write the attribute units = '{0}'",
               expected.front()));
    if (std::find(expected.begin(), expected.end(), *unit) == expected.end())
      fail(name, fmt::format("has unit '{}', expected '{}': convert the values", *unit, expected.front()));
  }

  /// Number of values to read.
  std::size_t checked_count(const char* name, int variable, const std::vector<std::size_t>& shape) const {
    const std::size_t count = claimed_count(name, variable, shape);
    if (count == 0)
      fail(name, fmt::format("is empty ({}): there is nothing to read", fmt::join(shape, " x ")));
    check_chunk(name, variable);
    return count;
  }

  std::size_t bytes_of_type(int variable) const {
    nc_type type = 0;
    std::size_t bytes = 0;
    file_.check(nc_inq_vartype(id_, variable, &type), "read a variable's type");
    file_.check(nc_inq_type(id_, type, nullptr, &bytes), "read a type's size");
    return bytes;
  }

  /// Number of values. Throws if the file is too small for that many.
  std::size_t claimed_count(const char* name, int variable, const std::vector<std::size_t>& shape) const {
    const auto count = product(shape);
    // Highest compression ratio of deflate. Values that were never written are rejected in any case.
    constexpr std::uintmax_t densest = 1032;
    if (!count || *count / densest > file_.bytes() / bytes_of_type(variable))
      fail(name, fmt::format("declares {} values, more than the file's {} bytes can hold: write all values, "
                             "uncompressed or with deflate",
                             fmt::join(shape, " x "), file_.bytes()));
    return static_cast<std::size_t>(*count);
  }

  /// Reads in slabs, so that a request to stop takes effect soon. Each slab has whole chunks; otherwise
  /// netCDF would decompress chunks repeatedly.
  void read_slabs(const char* name, int variable, const std::vector<std::size_t>& shape,
                  std::span<double> values) const {
    constexpr std::size_t most_values = std::size_t{1} << 22;
    const std::size_t row = values.size() / shape[0],
                      chunk_rows = std::max<std::size_t>(1, chunk_of(variable)[0]);
    const std::size_t rows = std::max<std::size_t>(1, most_values / row / chunk_rows) * chunk_rows;
    std::vector<std::size_t> start(shape.size(), 0), part = shape;
    for (; start[0] < shape[0]; start[0] += rows) {
      stop_if_wanted();
      part[0] = std::min(rows, shape[0] - start[0]);
      file_.check(nc_get_vara_double(id_, variable, start.data(), part.data(), &values[start[0] * row]),
                  fmt::format("read variable '{}{}'", prefix_, name));
    }
  }

  /// Lengths of a variable's chunks; zeros for contiguous storage.
  std::vector<std::size_t> chunk_of(int variable) const {
    int storage = NC_CONTIGUOUS, dimensions = 0;
    file_.check(nc_inq_varndims(id_, variable, &dimensions), "count dimensions");
    std::vector<std::size_t> chunk(static_cast<std::size_t>(std::max(dimensions, 1)), 0);
    file_.check(nc_inq_var_chunking(id_, variable, &storage, chunk.data()), "read a variable's chunk sizes");
    if (storage != NC_CHUNKED) std::ranges::fill(chunk, 0);
    return chunk;
  }

  /// netCDF decompresses a whole chunk into memory, however small the requested part is.
  void check_chunk(const char* name, int variable) const {
    const std::vector<std::size_t> chunk = chunk_of(variable);
    const auto values = product(chunk);
    if (!values || *values > static_cast<std::uintmax_t>(limits::block_bytes) / bytes_of_type(variable))
      fail(name,
           fmt::format(
               "is stored in chunks of {} values, more than {} MB each: write smaller chunks, one per ping",
               fmt::join(chunk, " x "), limits::block_bytes >> 20));
  }

  /// netCDF fills values that were never written with a special value.
  void check_written(const char* name, int variable, const std::vector<std::string>& dimensions,
                     const std::vector<std::size_t>& shape, std::span<const double> values) const {
    double fill = NC_FILL_DOUBLE;
    std::size_t length = 0;
    if (const int status = nc_inq_attlen(id_, variable, "_FillValue", &length); status != NC_ENOTATT) {
      const std::string task = fmt::format("read '{}{}:_FillValue'", prefix_, name);
      file_.check(status, task);
      if (length != 1) fail(name, fmt::format("has {} values in attribute _FillValue, expected one", length));
      file_.check(nc_get_att_double(id_, variable, "_FillValue", &fill), task);
    }
    if (fill == 0) return;  // then 0 is an ordinary value
    const auto unwritten = std::find(values.begin(), values.end(), fill);
    if (unwritten == values.end()) return;
    fail(name, fmt::format("has no value at {}: write all values, including zeros",
                           place(dimensions, shape, static_cast<std::size_t>(unwritten - values.begin()))));
  }

  static std::string place(const std::vector<std::string>& dimensions, const std::vector<std::size_t>& shape,
                           std::size_t index) {
    std::string result;
    for (std::size_t k = shape.size(); k-- > 0; index /= shape[k])
      result = fmt::format("{} {}{}{}", dimensions[k], index % shape[k], result.empty() ? "" : ", ", result);
    return result;
  }

  const NetcdfInput& file_;
  int id_;
  std::string prefix_;
};

}  // namespace tubefoot
