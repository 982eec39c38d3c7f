// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the files of fans across the track by portions of pings: tables of soundings, depth grids, and
// survey formats. The latter need a scene with a place on Earth. Threads process pings; files receive them
// in order.

#include "sensors/products/swath_files.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <mutex>
#include <utility>

#include "geometry/steps/in_order.hpp"
#include "sensors/detection/sounding_grid.hpp"
#include "sensors/formats/soundings_file.hpp"
#include "sensors/model/angles.hpp"
#include "sensors/pictures/depth_picture.hpp"
#include "sensors/products/pictures.hpp"
#include "sensors/products/swath_formats.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;

/// Number of first pings from which the cell of the depth grid is chosen.
std::size_t pings_a_block(const Recording& recording) {
  constexpr std::size_t block_bytes = std::size_t{48} << 20, bytes_per_sample = 12, most = 64;
  return std::clamp<std::size_t>(block_bytes / (bytes_per_sample * recording.cells()), 1, most);
}

/// Pings with places on Earth that go through the files together.
struct Portion {
  std::vector<PlacedPing> pings;
  std::vector<std::vector<Sounding>> found;             ///< by ping
  std::vector<std::vector<glm::dvec3>> found_on_earth;  ///< their longitudes, latitudes and heights
  /// By ping and format: SONAR-netCDF4, XTF and GSF. Empty for a format that is not written.
  std::vector<std::array<std::function<void()>, 3>> adding;
};

std::size_t pings_a_portion(const Recording& recording) {
  constexpr std::size_t portion_bytes = std::size_t{24} << 20, bytes_per_sample = 12, most = 32;
  return std::clamp<std::size_t>(portion_bytes / (bytes_per_sample * recording.cells()), 1, most);
}

/// A transformation to longitude and latitude is slow to set up. One serves the portion's pings, and one its
/// soundings.
void place_on_earth(std::vector<PlacedPing>& block, const Recording& recording, const RunContext& run,
                    const fs::path& file) {
  const std::vector<NavigationFix> fixes = navigation(recording, run, block.front().ping, block.size());
  std::vector<glm::dvec3> points;
  for (const PlacedPing& placed : block)
    for (const std::optional<Sounding>& sounding : placed.sounded.soundings)
      if (sounding) points.push_back(sounding->position_m);
  run.frame.to_lon_lat(points, {file.string()});
  auto next = points.begin();
  for (PlacedPing& placed : block) {
    placed.fix = fixes[placed.ping - block.front().ping];
    for (const std::optional<Sounding>& sounding : placed.sounded.soundings)
      placed.soundings_lon_lat.push_back(sounding ? *next++
                                                  : glm::dvec3(std::numeric_limits<double>::quiet_NaN()));
  }
}

/// The least of 1, 2 and 5 times a power of ten that is at least `value`.
double rounded_up(double value) {
  const double power = std::pow(10, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 5.0})
    if (value <= step * power * (1 + 1e-9)) return step * power;
  return 10 * power;
}

/// Cell of the depth grid if the scene gives none. It is the width of a beam straight down at the median
/// depth below the sonar, or the ping spacing if that is larger.
double chosen_cell_m(const Recording& recording, const std::vector<PlacedPing>& block) {
  std::vector<double> depths;
  for (const PlacedPing& placed : block)
    for (const std::optional<Sounding>& sounding : placed.sounded.soundings)
      if (sounding && !is_cut(*sounding))
        depths.push_back(std::abs(recording.ping_pose[placed.ping].position_m.z - sounding->position_m.z));
  std::nth_element(depths.begin(), depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2),
                   depths.end());
  const double beam_rad = recording.sensor->beams().front().elevation_width_rad;
  return rounded_up(
      std::max({2 * depths[depths.size() / 2] * std::tan(beam_rad / 2), recording.ping_spacing_m(), 0.01}));
}

/// Adds a ping's soundings, and points on straight lines between those of neighbouring beams. If the sonar
/// moved by at most two cells, it adds lines to the soundings of the same beams in the previous ping.
/// Without them, pings one cell apart would sometimes skip a cell as the sonar rolls and pitches. No line
/// crosses an acoustic shadow (fills_between).
void add_to_grid(SoundingGrid& grid, const PlacedPing& ping, const PlacedPing* before,
                 const std::vector<std::optional<Sounding>>& (*soundings_of)(const PlacedPing&)) {
  const std::vector<std::optional<Sounding>>& soundings = soundings_of(ping);
  const double cell_m = grid.depths().cell_m();
  const bool close = before && glm::distance(before->position_m, ping.position_m) <= 2 * cell_m;
  const auto measured = [&](const PlacedPing& from, std::size_t beam) {
    return MeasuredFrom{*soundings_of(from)[beam], from.position_m};
  };
  const auto add_line = [&](const MeasuredFrom& a, const MeasuredFrom& b) {
    if (fills_between(a, b, cell_m)) grid.add_between(a.sounding, b.sounding);
  };
  for (std::size_t beam = 0; beam < soundings.size(); ++beam) {
    if (!soundings[beam]) continue;
    grid.add(*soundings[beam]);
    if (beam > 0 && soundings[beam - 1]) add_line(measured(ping, beam - 1), measured(ping, beam));
    if (close && soundings_of(*before)[beam]) add_line(measured(*before, beam), measured(ping, beam));
  }
}

const std::vector<std::optional<Sounding>>& received_of(const PlacedPing& ping) {
  return ping.sounded.soundings;
}
const std::vector<std::optional<Sounding>>& ideal_of(const PlacedPing& ping) { return ping.ideal; }

bool has_depths(const std::vector<PlacedPing>& block) {
  return std::ranges::any_of(block, [](const PlacedPing& placed) {
    return std::ranges::any_of(placed.sounded.soundings,
                               [](const auto& sounding) { return sounding && !is_cut(*sounding); });
  });
}

/// The files of a recording: those that are not omitted and can represent its positions and dates.
struct Kept {
  bool csv = false, gpkg = false, sonar_netcdf = false, xtf = false, gsf = false;
  bool depth_grid = false, depth_picture = false, ideal_depth_picture = false;
  std::vector<std::string> left_out;

  bool tables() const { return csv || gpkg; }
  bool formats() const { return sonar_netcdf || xtf || gsf; }
  bool grids() const { return depth_grid || depth_picture || ideal_depth_picture; }
};

/// Joins names to "a", "a and b" or "a, b and c".
std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t k = 0; k < names.size(); ++k)
    text += (k == 0 ? "" : k + 1 == names.size() ? " and " : ", ") + names[k];
  return text;
}

Kept kept_of(const Recording& recording, const RunContext& run) {
  const std::string& name = recording.sensor->description().name;
  const double first_s = run.start_unix_s + recording.ping_time_s.front(),
               last_s = run.start_unix_s + recording.ping_time_s.back();
  Kept kept;
  kept.csv = run.writes("soundings.csv");
  kept.gpkg = run.writes("soundings.gpkg");
  kept.depth_grid = run.writes("depth.tif");
  kept.depth_picture = run.draws("depth.png");
  kept.ideal_depth_picture = run.draws("depth-ideal.png");
  std::vector<std::string> on_earth;
  for (const auto& [product, ending] : {std::pair("sonar.nc", "-sonar.nc"), {"gsf", ".gsf"}, {"xtf", ".xtf"}})
    if (run.writes(product)) on_earth.push_back(name + ending);
  if (on_earth.empty()) return kept;
  const bool several = on_earth.size() > 1;
  if (!run.frame.is_georeferenced()) {
    kept.left_out.push_back(fmt::format("'{}': {} {} a position on Earth and {} omitted: add [georeference]",
                                        name, listed(on_earth), several ? "need" : "needs",
                                        several ? "are" : "is"));
    return kept;
  }
  if (first_s < 0) {
    kept.left_out.push_back(fmt::format(
        "'{}': its first ping is before 1970, so {} {} omitted: change 'start_utc' or 'first_ping_s'", name,
        listed(on_earth), several ? "are" : "is"));
    return kept;
  }
  kept.sonar_netcdf = run.writes("sonar.nc");
  kept.xtf = run.writes("xtf");
  constexpr double gsf_ends_s = 2147483647;
  kept.gsf = run.writes("gsf") && last_s < gsf_ends_s;
  if (run.writes("gsf") && !kept.gsf)
    kept.left_out.push_back(fmt::format(
        "'{0}': {0}.gsf is omitted, because its time format ends in 2038: change 'start_utc'", name));
  return kept;
}

/// All files of a recording that are open simultaneously.
class SwathFiles {
 public:
  SwathFiles(const fs::path& folder, const Recording& recording, const RunContext& run,
             const SwathSettings& settings, std::vector<std::string>& warnings)
      : folder_(folder),
        recording_(recording),
        run_(run),
        settings_(settings),
        warnings_(warnings),
        name_(recording.sensor->description().name),
        kept_(kept_of(recording, run)),
        finder_(recording, run, settings.rule) {
    if (kept_.ideal_depth_picture && receiver_output_of(recording, run))
      ideal_finder_.emplace(BottomFinder::ideal(recording, settings.rule, run));
    const auto open_table = [&](std::size_t table, bool wanted, const char* ending) {
      if (wanted)
        tables_[table] = std::make_unique<SoundingsFile>(new_file("-soundings", ending), run.frame,
                                                         recording.sectors() > 1);
    };
    open_table(0, kept_.csv, ".csv");
    open_table(1, kept_.gpkg, ".gpkg");
    open_formats();
  }

  std::vector<fs::path> write() {
    if (!kept_.tables() && !kept_.formats() && !kept_.grids()) return {};
    const std::size_t pings = recording_.pings(), size = pings_a_portion(recording_);
    Steps steps("pings of soundings", pings);
    const auto add_to_table = [this](std::size_t table, const Portion& portion) {
      if (!tables_[table]) return;
      for (std::size_t k = 0; k < portion.found.size(); ++k)
        tables_[table]->add(portion.found[k], portion.found_on_earth[k]);
    };
    const auto add_to_format = [](std::size_t format, const Portion& portion) {
      for (const auto& adding : portion.adding)
        if (adding[format]) adding[format]();
    };
    in_order(
        0, (pings + size - 1) / size, size * recording_.cells() * (sizeof(double) + sizeof(float)),
        [&](std::size_t k) { return portion_of(k * size, std::min(size, pings - k * size)); },
        [&](std::size_t, const Portion& portion) {
          const std::lock_guard lock(libraries_);
          add_to_format(0, portion);
        },
        [&](std::size_t, const Portion& portion) {
          const std::lock_guard lock(libraries_);
          add_to_table(1, portion);
        },
        [&](std::size_t, const Portion& portion) { add_to_table(0, portion); },
        [&](std::size_t, const Portion& portion) { add_to_format(1, portion); },
        [&](std::size_t, const Portion& portion) { add_to_format(2, portion); },
        [&](std::size_t, Portion& portion) {
          for (PlacedPing& placed : portion.pings) {
            if (kept_.grids()) add_to_grids(std::move(placed));
            steps.done();
          }
        });
    for (const auto& table : tables_)
      if (table) table->finish();
    for (const auto& format : formats_)
      if (format) format->finish();
    write_grid();
    return files_;
  }

 private:
  fs::path new_file(const std::string& part, const char* ending) {
    files_.push_back(name_ + part + ending);
    return folder_ / files_.back();
  }

  void open_formats() {
    warnings_.insert(warnings_.end(), kept_.left_out.begin(), kept_.left_out.end());
    if (kept_.sonar_netcdf) formats_[0] = make_sonar_netcdf(folder_, recording_, run_, settings_, finder_);
    if (kept_.xtf) formats_[1] = make_xtf(folder_, recording_, run_, settings_);
    if (kept_.gsf) formats_[2] = make_gsf(folder_, recording_, run_, settings_, finder_.placer());
    for (const auto& format : formats_) {
      if (!format) continue;
      for (const fs::path& file : format->files()) files_.push_back(file);
    }
  }

  /// Computes all results of pings that do not depend on other pings; on any thread.
  Portion portion_of(std::size_t first, std::size_t count) const {
    Portion portion;
    portion.pings.resize(count);
    portion.found.resize(count);
    portion.found_on_earth.resize(count);
    portion.adding.resize(count);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t k) {
      PlacedPing& placed = portion.pings[k];
      placed.ping = first + k;
      placed.position_m = recording_.ping_pose[placed.ping].position_m;
      placed.sounded = finder_.sound(placed.ping);
      if (ideal_finder_) placed.ideal = ideal_finder_->sound(placed.ping).soundings;
      for (const std::optional<Sounding>& sounding : placed.sounded.soundings)
        if (sounding) portion.found[k].push_back(*sounding);
    });
    if (run_.frame.is_georeferenced() && (kept_.tables() || kept_.formats())) {
      const std::lock_guard lock(libraries_);
      place_on_earth(portion.pings, recording_, run_, folder_ / name_);
    }
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t k) {
      for (std::size_t beam = 0; beam < portion.pings[k].soundings_lon_lat.size(); ++beam)
        if (portion.pings[k].sounded.soundings[beam])
          portion.found_on_earth[k].push_back(portion.pings[k].soundings_lon_lat[beam]);
      for (std::size_t format = 0; format < formats_.size(); ++format)
        if (formats_[format]) portion.adding[k][format] = formats_[format]->adding(portion.pings[k]);
      portion.pings[k].sounded.received_j = {};  // most of a ping's memory, no longer needed
    });
    return portion;
  }

  /// The grids begin with the first pings_a_block() pings that have depths.
  void add_to_grids(PlacedPing placed) {
    if (grid_) return add_to_begun_grids(std::move(placed));
    const bool last = placed.ping + 1 == recording_.pings();
    waiting_.push_back(std::move(placed));
    if (waiting_.size() < pings_a_block(recording_) && !last) return;
    if (has_depths(waiting_)) {
      const double requested_m = settings_.grid_cell_m;
      grid_.emplace(run_.frame, requested_m > 0 ? requested_m : chosen_cell_m(recording_, waiting_));
      if (ideal_finder_) ideal_grid_.emplace(run_.frame, grid_->depths().cell_m());
    }
    for (PlacedPing& waited : waiting_) add_to_begun_grids(std::move(waited));
    waiting_.clear();
  }
  void add_to_begun_grids(PlacedPing placed) {
    const PlacedPing* before = last_ ? &*last_ : nullptr;
    if (grid_) add_to_grid(*grid_, placed, before, received_of);
    if (ideal_grid_) add_to_grid(*ideal_grid_, placed, before, ideal_of);
    last_ = std::move(placed);
  }

  void write_grid() {
    if (!kept_.grids()) return;
    if (!grid_) {
      warnings_.push_back(fmt::format(
          "'{}': no beam detects the seabed within its range gate, so there is no depth grid", name_));
      return;
    }
    if (kept_.depth_grid) grid_->write_tiff(new_file("-depth", ".tif"));
    if (!kept_.depth_picture && !kept_.ideal_depth_picture) return;
    const std::string& font = font_for(name_, warnings_);
    if (kept_.depth_picture)
      draw_depths(grid_->depths(), name_, font)
          .write_png(new_file("-depth", ".png"), name_, run_.pictures.bits);
    if (ideal_grid_ && !ideal_grid_->depths().empty())
      draw_depths(ideal_grid_->depths(), name_ + "   with an ideal receiver", font)
          .write_png(new_file("-depth-ideal", ".png"), name_, run_.pictures.bits);
  }

  const fs::path& folder_;
  const Recording& recording_;
  const RunContext& run_;
  const SwathSettings& settings_;
  std::vector<std::string>& warnings_;
  std::string name_;
  Kept kept_;
  BottomFinder finder_;
  std::optional<BottomFinder>
      ideal_finder_;  ///< set for a picture of its depths if the receiver is not ideal
  std::array<std::unique_ptr<SoundingsFile>, 2> tables_;  ///< CSV and GeoPackage; null: not written
  std::array<std::unique_ptr<SwathFormat>, 3> formats_;   ///< in the order of Portion::adding
  std::optional<SoundingGrid> grid_, ideal_grid_;
  /// Serialises GDAL and HDF5: each use of GDAL first silences HDF5's messages, while no other thread may be
  /// in HDF5. Every user of either library holds this mutex, and never while waiting for other work of these
  /// workers.
  mutable std::mutex libraries_;
  std::vector<PlacedPing> waiting_;  ///< pings that wait for the grids to begin
  std::optional<PlacedPing> last_;   ///< the previous ping
  std::vector<fs::path> files_;
};

}  // namespace

std::vector<std::string> swath_products() {
  return {"soundings.csv", "soundings.gpkg", "sonar.nc",  "xtf",
          "gsf",           "depth.tif",      "depth.png", "depth-ideal.png"};
}

std::vector<std::string> swath_files_left_out(const Recording& recording, const RunContext& run) {
  return kept_of(recording, run).left_out;
}

std::vector<fs::path> write_swath_files(const fs::path& folder, const Recording& recording,
                                        const RunContext& run, const SwathSettings& settings,
                                        std::vector<std::string>& warnings) {
  check(recording);
  return SwathFiles(folder, recording, run, settings, warnings).write();
}

}  // namespace tubefoot
