// SPDX-License-Identifier: GPL-3.0-or-later
// Writes tables of soundings (docs/output-files.md) as CSV, or as a GeoPackage through GDAL. Positions are in
// the coordinate reference system of the scene.

#include "sensors/formats/soundings_file.hpp"

#include <fmt/format.h>
#include <ogr_spatialref.h>
#include <ogrsf_frmts.h>

#include <iterator>
#include <stdexcept>
#include <vector>

#include "files/checked_file.hpp"
#include "files/gdal_access.hpp"
#include "files/gdal_messages.hpp"
#include "files/streamed_file.hpp"

namespace tubefoot {

namespace fs = std::filesystem;

class SoundingsFile::Writer {
 public:
  Writer(fs::path file, const LocalFrame& frame, bool sectors)
      : file_(std::move(file)), frame_(frame), sectors_(sectors) {}
  virtual ~Writer() {
    if (!finished_) discard_file(file_);
  }

  void add(std::span<const Sounding> soundings, std::span<const glm::dvec3> on_earth) {
    waiting_.insert(waiting_.end(), soundings.begin(), soundings.end());
    on_earth_.insert(on_earth_.end(), on_earth.begin(), on_earth.end());
    constexpr std::size_t batch = 8192;
    if (waiting_.size() >= batch) write_waiting();
  }
  void finish() {
    write_waiting();
    close();
    finished_ = true;
  }

 protected:
  virtual void write(const std::vector<Sounding>& soundings, const std::vector<glm::dvec3>& on_earth) = 0;
  virtual void close() = 0;
  fs::path file_;
  LocalFrame frame_;
  bool sectors_;

 private:
  void write_waiting() {
    if (waiting_.empty()) return;
    if (frame_.is_georeferenced() && on_earth_.empty()) {
      for (const Sounding& sounding : waiting_) on_earth_.push_back(sounding.position_m);
      frame_.to_lon_lat(on_earth_, {file_.string()});
    }
    write(waiting_, on_earth_);
    waiting_.clear();
    on_earth_.clear();
  }

  std::vector<Sounding> waiting_;
  std::vector<glm::dvec3> on_earth_;
  bool finished_ = false;
};

namespace {

/// Easting and northing in the frame's map, height in m.
glm::dvec3 on_map(const LocalFrame& frame, const LocalFrame::Map& map, glm::dvec3 p) {
  return {map.easting + p.x / map.metres_per_unit, map.northing + p.y / map.metres_per_unit,
          p.z + frame.origin_height_m()};
}

class CsvWriter : public SoundingsFile::Writer {
 public:
  CsvWriter(const fs::path& file, const LocalFrame& frame, bool sectors)
      : Writer(file, frame, sectors), stream_(file) {
    text_ = "ping,beam,time_s,east_m,north_m,up_m,";
    if (frame_.is_georeferenced()) text_ += "longitude_deg_east,latitude_deg_north,height_m_up_positive,";
    text_ +=
        "two_way_travel_time_s,slant_range_m,beam_angle_deg_starboard_positive,amplitude,quality_0_to_1,"
        "method,status";
    text_ += sectors_ ? ",sector\n" : "\n";
    put();
  }

 private:
  void write(const std::vector<Sounding>& soundings, const std::vector<glm::dvec3>& on_earth) override {
    auto out = std::back_inserter(text_);
    for (std::size_t k = 0; k < soundings.size(); ++k) {
      const Sounding& s = soundings[k];
      fmt::format_to(out, "{},{},{},{:.4f},{:.4f},{:.4f},", s.ping, s.beam, s.time_s, s.position_m.x,
                     s.position_m.y, s.position_m.z);
      if (!on_earth.empty())
        fmt::format_to(out, "{:.10f},{:.10f},{:.4f},", on_earth[k].x, on_earth[k].y, on_earth[k].z);
      fmt::format_to(out, "{},{:.4f},{},{},{},{},{}", s.two_way_travel_time_s, s.slant_range_m,
                     s.beam_angle_deg, s.amplitude, s.quality, name_of(s.method), name_of(s.flags));
      if (sectors_) fmt::format_to(out, ",{}", s.sector);
      text_ += '\n';
    }
    put();
  }
  void put() {
    stream_.append(text_);
    text_.clear();
  }
  void close() override { stream_.close(); }

  StreamedFile stream_;
  std::string text_;
};

/// East and north in metres about the scene's own origin.
constexpr const char* local_crs =
    R"wkt(ENGCRS["tubefoot local east-north",EDATUM["scene origin"],CS[Cartesian,2],)wkt"
    R"wkt(AXIS["east (E)",east,ORDER[1],LENGTHUNIT["metre",1]],)wkt"
    R"wkt(AXIS["north (N)",north,ORDER[2],LENGTHUNIT["metre",1]]])wkt";

class GeoPackageWriter : public SoundingsFile::Writer {
 public:
  GeoPackageWriter(const fs::path& file, const LocalFrame& frame, bool sectors)
      : Writer(file, frame, sectors), map_(frame.map()) {
    const GdalMessages messages;
    const FixedGdalDate date;
    register_gdal_drivers();
    discard_file(file_);  // GDAL does not overwrite files
    GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GPKG");
    require(driver != nullptr, messages, "find the GeoPackage driver of GDAL");
    dataset_.reset(driver->Create(file_.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
    require(dataset_ != nullptr, messages, "create the file");
    OGRSpatialReference crs;
    const OGRErr known = !frame.is_georeferenced() ? crs.importFromWkt(local_crs)
                         : frame.is_tangent()      ? crs.importFromEPSG(4326)
                                                   : crs.importFromWkt(map_.crs_wkt.c_str());
    require(known == OGRERR_NONE, messages, "describe the coordinate reference system of the file");
    crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    layer_ = dataset_->CreateLayer("soundings", &crs, wkbPoint25D, nullptr);
    require(layer_ != nullptr, messages, "create the layer of the file");
    for (const char* name : {"ping", "beam"}) field(name, OFTInteger64);
    for (const char* name : {"time_s", "east_m", "north_m", "up_m", "two_way_travel_time_s", "slant_range_m",
                             "beam_angle_deg", "amplitude", "quality"})
      field(name, OFTReal);
    for (const char* name : {"method", "status"}) field(name, OFTString);
    if (sectors_) field("sector", OFTInteger64);
    require(messages.failures().empty(), messages, "create the layer of the file");
  }
  ~GeoPackageWriter() override {
    const GdalMessages quiet;
    const FixedGdalDate date;
    dataset_.reset();
  }

 private:
  void require(bool good, const GdalMessages& messages, const char* task) const {
    if (!good) throw write_error(file_, fmt::format("cannot {}{}", task, messages.in_brackets()));
  }
  void field(const char* name, OGRFieldType type) {
    OGRFieldDefn definition(name, type);
    layer_->CreateField(&definition);  // a failure appears in the messages
  }
  void write(const std::vector<Sounding>& soundings, const std::vector<glm::dvec3>& on_earth) override {
    const GdalMessages messages;
    const FixedGdalDate date;
    bool good = dataset_->StartTransaction() == OGRERR_NONE;
    for (std::size_t k = 0; good && k < soundings.size(); ++k) {
      const Sounding& s = soundings[k];
      OGRFeature feature(layer_->GetLayerDefn());
      int f = 0;
      feature.SetField(f++, static_cast<GIntBig>(s.ping));
      feature.SetField(f++, static_cast<GIntBig>(s.beam));
      for (const double value :
           {s.time_s, s.position_m.x, s.position_m.y, s.position_m.z, s.two_way_travel_time_s,
            s.slant_range_m, s.beam_angle_deg, s.amplitude, s.quality})
        feature.SetField(f++, value);
      feature.SetField(f++, name_of(s.method));
      feature.SetField(f++, name_of(s.flags));
      if (sectors_) feature.SetField(f++, static_cast<GIntBig>(s.sector));
      const glm::dvec3 place = frame_.is_tangent() ? on_earth[k] : on_map(frame_, map_, s.position_m);
      const OGRPoint point(place.x, place.y, place.z);
      feature.SetGeometry(&point);
      good = layer_->CreateFeature(&feature) == OGRERR_NONE;
    }
    good = good && dataset_->CommitTransaction() == OGRERR_NONE;
    require(good && messages.failures().empty(), messages, "write the file");
  }
  void close() override {
    const GdalMessages messages;
    const FixedGdalDate date;
    dataset_->FlushCache();
    dataset_.reset();
    require(messages.failures().empty(), messages, "complete the file");
  }

  LocalFrame::Map map_;
  GDALDatasetUniquePtr dataset_;
  OGRLayer* layer_ = nullptr;
};

std::unique_ptr<SoundingsFile::Writer> writer_for(const fs::path& file, const LocalFrame& frame,
                                                  bool sectors) {
  if (file.extension() == ".csv") return std::make_unique<CsvWriter>(file, frame, sectors);
  if (file.extension() == ".gpkg") return std::make_unique<GeoPackageWriter>(file, frame, sectors);
  throw std::invalid_argument(
      fmt::format("'{}': the name of a file of soundings must end in .csv or .gpkg", file.string()));
}

}  // namespace

SoundingsFile::SoundingsFile(const fs::path& file, const LocalFrame& frame, bool sectors)
    : writer_(writer_for(file, frame, sectors)) {}

SoundingsFile::~SoundingsFile() = default;

void SoundingsFile::add(std::span<const Sounding> soundings, std::span<const glm::dvec3> on_earth) {
  writer_->add(soundings, on_earth);
}

void SoundingsFile::finish() { writer_->finish(); }

}  // namespace tubefoot
