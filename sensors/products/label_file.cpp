// SPDX-License-Identifier: GPL-3.0-or-later
// Adds labels to echo files (echoes.nc), in the layout of docs/output-files.md: shares of objects and
// materials, mean heights and ranges.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <netcdf.h>

#include <algorithm>
#include <numeric>
#include <optional>

#include "sensors/formats/netcdf_stream.hpp"
#include "sensors/recordings/label_recording.hpp"
#include "sensors/recordings/recording.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// A name as one word, for the flag lists of the CF conventions.
std::string word(std::string name) {
  std::ranges::replace(name, ' ', '_');
  return name;
}

class LabelGroup {
 public:
  LabelGroup(const NetcdfStream& file, int id, const LabelRecording& label_recording)
      : file_(file), id_(id), label_recording_(label_recording) {
    for (const char* name : {"ping", "beam", "sample"}) {
      int dimension = 0;
      check(nc_inq_dimid(id_, name, &dimension), name);
      along_.push_back(dimension);
    }
    check(nc_inq_dimlen(id_, along_[1], &beams_), "beam");
    check(nc_inq_dimlen(id_, along_[2], &samples_), "sample");
    const int object = names("object", label_recording.objects),
              material = names("material", label_recording.materials);
    object_share_ = shares("object_share", object, "share of the energy that facets of the object return");
    material_share_ =
        shares("material_share", material, "share of the energy that facets of the material return");
    if (label_recording.has_unscattered)
      unscattered_ =
          define("unscattered_share", NC_DOUBLE, "1", "share of the energy that arrives without scattering");
    height_ =
        define("mean_height", NC_DOUBLE, "m",
               "energy-weighted mean height of the surfaces that return the energy, in the local frame");
    range_ = define("mean_range", NC_DOUBLE, "m",
                    "energy-weighted mean distance from the sensor to the surfaces that return the energy, "
                    "along straight lines");
    object_label_ = labels("object_label", "object", label_recording.objects);
    material_label_ = labels("material_label", "material", label_recording.materials);
  }

  void write() {
    put_names("object_name", label_recording_.objects);
    put_names("material_name", label_recording_.materials);
    std::size_t pings = 0;
    check(nc_inq_dimlen(id_, along_[0], &pings), "ping");
    for (std::size_t p = 0; p < pings; ++p) {
      const LabelPing ping = label_recording_.of(p);
      put(object_share_, p, label_recording_.objects.size(), ping.object_share);
      put(material_share_, p, label_recording_.materials.size(), ping.material_share);
      if (label_recording_.has_unscattered) put(unscattered_, p, 0, ping.unscattered_share);
      put(height_, p, 0, ping.mean_height);
      put(range_, p, 0, ping.mean_range);
      put(object_label_, p, ping.object_label);
      put(material_label_, p, ping.material_label);
    }
  }

 private:
  void check(int status, const std::string& of) const {
    if (status != NC_NOERR) file_.check(status, fmt::format("write '{}'", of));
  }
  void attribute(int variable, const char* name, const std::string& text) const {
    check(nc_put_att_text(id_, variable, name, text.size(), text.c_str()), name);
  }

  int names(const char* what, const std::vector<std::string>& all) {
    int dimension = 0, variable = 0;
    check(nc_def_dim(id_, what, all.size(), &dimension), what);
    check(nc_def_var(id_, fmt::format("{}_name", what).c_str(), NC_STRING, 1, &dimension, &variable), what);
    attribute(variable, "long_name", fmt::format("name of the {} in the scene", what));
    return dimension;
  }
  void put_names(const char* name, const std::vector<std::string>& all) const {
    int variable = 0;
    check(nc_inq_varid(id_, name, &variable), name);
    std::vector<const char*> texts;
    for (const std::string& one : all) texts.push_back(one.c_str());
    check(nc_put_var_string(id_, variable, texts.data()), name);
  }

  int define(const std::string& name, int type, const char* units, const char* long_name,
             std::optional<int> label = {}) {
    std::vector<int> dimensions = along_;
    std::vector<std::size_t> chunk{1, beams_, samples_};
    if (label) {
      dimensions.insert(dimensions.begin() + 1, *label);
      chunk.insert(chunk.begin() + 1, 1);
    }
    int variable = 0;
    check(nc_def_var(id_, name.c_str(), type, int(dimensions.size()), dimensions.data(), &variable), name);
    attribute(variable, "units", units);
    attribute(variable, "long_name", long_name);
    attribute(variable, "coordinates", "ping_time beam_azimuth beam_elevation slant_range");
    check(nc_def_var_chunking(id_, variable, NC_CHUNKED, chunk.data()), name);
    constexpr int shuffle = 1, deflate = 1, level = 4;
    check(nc_def_var_deflate(id_, variable, shuffle, deflate, level), name);
    return variable;
  }
  int shares(const char* name, int label, const char* long_name) {
    return define(name, NC_DOUBLE, "1", long_name, label);
  }
  int labels(const char* name, const char* what, const std::vector<std::string>& all) {
    const std::optional<double>& level_db = label_recording_.label_level_db;
    const std::string long_name = level_db ? fmt::format(
                                                 "{} with the largest share of the energy that the beam "
                                                 "receives within {:g} dB of the two-way peak of its pattern",
                                                 what, *level_db)
                                           : fmt::format("{} with the largest share", what);
    const int variable = define(name, NC_SHORT, "1", long_name.c_str());
    if (level_db)
      check(nc_put_att_double(id_, variable, "label_level_db", NC_DOUBLE, 1, &*level_db), "label_level_db");
    std::vector<short> values(all.size());
    std::iota(values.begin(), values.end(), short{0});
    std::vector<std::string> words;
    for (const std::string& one : all) words.push_back(word(one));
    check(nc_put_att_short(id_, variable, "flag_values", NC_SHORT, values.size(), values.data()), name);
    attribute(variable, "flag_meanings", fmt::format("{}", fmt::join(words, " ")));
    const short none = LabelRecording::no_label;
    check(nc_def_var_fill(id_, variable, NC_FILL, &none), name);
    return variable;
  }

  /// `labels`: number of shares per sample; 0: one value per sample.
  void put(int variable, std::size_t ping, std::size_t labels, const std::vector<double>& values) const {
    std::vector<std::size_t> start{ping, 0, 0}, count{1, beams_, samples_};
    if (labels > 0) {
      start.push_back(0);
      count.insert(count.begin() + 1, labels);
    }
    check(nc_put_vara_double(id_, variable, start.data(), count.data(), values.data()), "labels");
  }
  void put(int variable, std::size_t ping, const std::vector<std::int16_t>& values) const {
    const std::size_t start[] = {ping, 0, 0}, count[] = {1, beams_, samples_};
    check(nc_put_vara_short(id_, variable, start, count, values.data()), "labels");
  }

  const NetcdfStream& file_;
  int id_;
  const LabelRecording& label_recording_;
  std::vector<int> along_;
  std::size_t beams_ = 0, samples_ = 0;
  int object_share_ = 0, material_share_ = 0, unscattered_ = 0, height_ = 0, range_ = 0, object_label_ = 0,
      material_label_ = 0;
};

}  // namespace

void add_labels(const fs::path& path, std::span<const Recording> recordings,
                std::span<const LabelRecording> label_recordings) {
  if (label_recordings.empty()) return;
  std::size_t bytes = 0;
  for (std::size_t k = 0; k < label_recordings.size(); ++k) {
    const LabelRecording& label_recording = label_recordings[k];
    bytes += recordings[k].pings() * label_recording.cells *
             ((label_recording.objects.size() + label_recording.materials.size() + 3) * sizeof(double) +
              2 * sizeof(std::int16_t));
  }
  NetcdfStream file(path, NetcdfStream::Finished{});
  file.reserve(bytes + bytes / 64);  // upper bound of the size of data that deflate cannot compress
  for (std::size_t k = 0; k < label_recordings.size(); ++k) {
    const int group =
        label_recordings.size() > 1 ? file.group("/" + recordings[k].sensor->description().name) : file.id();
    LabelGroup(file, group, label_recordings[k]).write();
  }
  file.finish();
}

}  // namespace tubefoot
