// SPDX-License-Identifier: GPL-3.0-or-later
#include "kmall/kmall_survey.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string_view>

#include "geometry/steps/stop.hpp"

namespace tubefoot {
namespace {

/// Beams of two pings are equal if their angles differ by less.
constexpr double equal_angles_deg = 0.02;

double remainder_deg(double degrees) { return std::remainder(degrees, 360.0); }

bool have_equal_frequencies(const std::vector<KmallSector>& a, const std::vector<KmallSector>& b) {
  constexpr double equal_hz = 1;
  return std::ranges::equal(a, b, [](const KmallSector& x, const KmallSector& y) {
    return std::abs(x.frequency_hz - y.frequency_hz) < equal_hz;
  });
}

/// Beams in order from port to starboard.
struct BeamList {
  std::vector<double> angles_deg;  ///< positive to starboard
  std::vector<std::size_t> sectors, numbers;
};

/// Sorts beams, whose angles are positive to port.
template <class Beam>
BeamList listed(const std::vector<Beam>& beams, double Beam::*angle_deg, bool (*is_used)(const Beam&)) {
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < beams.size(); ++k)
    if (is_used(beams[k])) order.push_back(k);
  std::ranges::stable_sort(order, std::greater(), [&](std::size_t k) { return beams[k].*angle_deg; });
  constexpr double least_deg = 1e-3;
  BeamList list;
  for (const std::size_t k : order) {
    const double starboard_deg = -(beams[k].*angle_deg) + 0.0;
    if (!list.angles_deg.empty() && starboard_deg - list.angles_deg.back() < least_deg) continue;
    list.angles_deg.push_back(starboard_deg);
    list.sectors.push_back(beams[k].sector);
    list.numbers.push_back(k);
  }
  return list;
}

bool are_equal(const std::vector<double>& a, const std::vector<double>& b) {
  return std::ranges::equal(a, b, [](double x, double y) { return std::abs(x - y) < equal_angles_deg; });
}

/// A mode while its pings are collected.
struct CollectedMode {
  KmallMode mode;
  BeamList beams;
  std::vector<KmallSector> sectors;  ///< in the order of the file
  unsigned fan = 0, fans = 1;
  double least_tilt_deg = 0, largest_tilt_deg = 0;  ///< of the first sector
};

class Collector {
 public:
  explicit Collector(KmallSurvey& survey) : survey_(survey) {}

  void add_soundings_of(KmallFile& file) {
    for (const KmallRecord& record : file.records("#MRZ")) {
      stop_if_wanted();
      survey_.pings.push_back(read_kmall_ping(file, record));
      check_heads(file, record);
    }
    std::ranges::stable_sort(survey_.pings, {}, &KmallPing::time_s);
    if (survey_.pings.empty())
      throw InputError({file.path().string(), 0, 0}, "has no soundings (#MRZ), which contain the sectors");
    note_incomplete(file);
  }

  void add_columns_of(KmallFile& file) {
    const std::vector<KmallRecord>& records = file.records("#MWC");
    if (records.empty())
      throw InputError(
          {file.path().string(), 0, 0},
          "has no water column (#MWC): expected the file .kmwcd, or a .kmall with a water column");
    for (std::size_t k = 0; k < records.size(); ++k) {
      stop_if_wanted();
      add(file, records[k], k);
    }
    note_incomplete(file);
  }

  void add_soundings_as_pings() {
    for (const KmallPing& ping : survey_.pings) {
      const BeamList beams = listed<KmallSounding>(ping.soundings, &KmallSounding::water_column_angle_deg,
                                                   [](const KmallSounding& s) { return s.is_valid; });
      if (beams.angles_deg.empty() || !has_motion(ping.time_s)) continue;
      double last_s = 0;
      for (const KmallSounding& sounding : ping.soundings)
        if (sounding.is_valid) last_s = std::max(last_s, sounding.two_way_travel_time_s);
      // A margin of a half behind the last sounding.
      const double samples = 1.5 * last_s * ping.water_column_rate_hz;
      constexpr double most_samples = 1e7;
      if (!(samples >= 1) || samples > most_samples)
        throw InputError(
            {survey_.soundings_file.string(), 0, 0},
            fmt::format("ping {} has a travel time of {} s and {} samples per second: expected 1 "
                        "to {} samples",
                        ping.number, last_s, ping.water_column_rate_hz, most_samples));
      const auto end = static_cast<std::size_t>(samples) + 1;
      // Beams of soundings may change from ping to ping; the first ping of a mode defines them.
      CollectedMode& mode = mode_of(ping, beams, ping.water_column_rate_hz, ping.sectors, false);
      mode.mode.first_sample = 1;
      mode.mode.end_sample = std::max(mode.mode.end_sample, end);
      mode.mode.pings.push_back({ping.time_s, ping.number, {}});
    }
  }

  void finish() {
    if (without_motion_ > 0)
      survey_.notes.push_back(fmt::format("{} ping{} left out: no attitude (#SKM) within {} s",
                                          without_motion_, without_motion_ == 1 ? " is" : "s are",
                                          most_beyond_motion_s));
    if (without_soundings_ > 0)
      survey_.notes.push_back(fmt::format("{} ping{} left out: no soundings (#MRZ) of the same frequencies",
                                          without_soundings_, without_soundings_ == 1 ? " is" : "s are"));
    for (CollectedMode& collected : modes_) {
      complete(collected);
      survey_.modes.push_back(std::move(collected.mode));
    }
    if (survey_.modes.empty())
      throw InputError({survey_.soundings_file.string(), 0, 0},
                       "has no ping with beams, sectors and attitude: nothing can be simulated");
  }

 private:
  /// Throws if the last ping belongs to a transmitter or receiver that the installation lacks.
  void check_heads(const KmallFile& file, const KmallRecord& record) const {
    const KmallPing& ping = survey_.pings.back();
    const auto has = [](const auto& mountings, unsigned head) {
      return head < mountings.size() && mountings[head].has_value();
    };
    if (!has(survey_.installation.transmitters, ping.transmitter) ||
        !has(survey_.installation.receivers, ping.receiver))
      throw file.error(record,
                       fmt::format("belongs to transmitter {} and receiver {}, which the installation "
                                   "parameters do not contain",
                                   ping.transmitter + 1, ping.receiver + 1));
  }

  void note_incomplete(const KmallFile& file) {
    if (file.incomplete() > 0)
      survey_.notes.push_back(fmt::format("{}: {} datagrams are left out, because a part of them is missing",
                                          file.path().string(), file.incomplete()));
  }

  bool has_motion(double time_s) {
    const bool known = motion_at(survey_.motion, time_s).has_value();
    without_motion_ += known ? 0 : 1;
    return known;
  }

  void add(KmallFile& file, const KmallRecord& record, std::size_t number) {
    const KmallWaterColumn column = read_kmall_water_column(file, record);
    if (column.beams.empty() || !has_motion(column.time_s)) return;
    const KmallPing* soundings = nullptr;
    for (const KmallPing& ping : survey_.pings)
      if (have_equal_frequencies(ping.sectors, column.sectors) && ping.fan == column.fan &&
          ping.receiver == column.receiver &&
          (soundings == nullptr ||
           std::abs(ping.time_s - column.time_s) < std::abs(soundings->time_s - column.time_s)))
        soundings = &ping;
    if (soundings == nullptr) {
      ++without_soundings_;
      return;
    }
    std::vector<KmallSector> sectors = soundings->sectors;
    for (std::size_t t = 0; t < sectors.size(); ++t) {
      sectors[t].tilt_deg = column.sectors[t].tilt_deg;
      sectors[t].beam_width_along_deg = column.sectors[t].beam_width_along_deg;
    }
    const BeamList beams = listed<KmallWaterBeam>(column.beams, &KmallWaterBeam::angle_deg,
                                                  [](const KmallWaterBeam& b) { return !b.levels.empty(); });
    if (beams.angles_deg.empty()) return;
    CollectedMode& mode = mode_of(*soundings, beams, column.sample_rate_hz, sectors, true);
    if (mode.mode.pings.empty()) mode.mode.first_sample = column.beams[beams.numbers.front()].first_sample;
    for (const KmallWaterBeam& beam : column.beams) {
      if (beam.levels.empty()) continue;
      const std::size_t end = beam.first_sample + beam.levels.size();
      mode.mode.first_sample = std::min(mode.mode.first_sample, beam.first_sample);
      mode.mode.end_sample = std::max(mode.mode.end_sample, end);
    }
    mode.mode.pings.push_back({column.time_s, column.number, number});
  }

  /// Returns the mode of a ping, which is added if it is new.
  CollectedMode& mode_of(const KmallPing& ping, const BeamList& beams, double rate_hz,
                         const std::vector<KmallSector>& sectors, bool compares_beams) {
    constexpr double equal_rates_hz = 0.5;
    for (CollectedMode& known : modes_)
      if (have_equal_frequencies(known.sectors, sectors) && known.fan == ping.fan &&
          known.mode.receiver == ping.receiver &&
          std::abs(known.mode.sample_rate_hz - rate_hz) < equal_rates_hz &&
          (!compares_beams ||
           (are_equal(known.beams.angles_deg, beams.angles_deg) && known.beams.numbers == beams.numbers))) {
        const auto n = static_cast<double>(known.mode.pings.size());
        for (std::size_t t = 0; t < sectors.size(); ++t)
          known.sectors[t].tilt_deg = (known.sectors[t].tilt_deg * n + sectors[t].tilt_deg) / (n + 1);
        known.least_tilt_deg = std::min(known.least_tilt_deg, sectors[0].tilt_deg);
        known.largest_tilt_deg = std::max(known.largest_tilt_deg, sectors[0].tilt_deg);
        return known;
      }
    if (modes_.size() == most_kmall_modes)
      throw InputError(
          {survey_.soundings_file.string(), 0, 0},
          fmt::format("the pings have more than {} combinations of sectors and beam angles: divide the "
                      "file, or record with constant coverage",
                      most_kmall_modes));
    CollectedMode& mode = modes_.emplace_back();
    mode.beams = beams;
    mode.sectors = sectors;
    mode.fan = ping.fan;
    mode.fans = ping.fans;
    mode.least_tilt_deg = mode.largest_tilt_deg = sectors[0].tilt_deg;
    mode.mode.transmitter = ping.transmitter;
    mode.mode.receiver = ping.receiver;
    mode.mode.swath_from_deg = -ping.swath_port_deg;
    mode.mode.swath_to_deg = -ping.swath_starboard_deg;
    mode.mode.sample_rate_hz = rate_hz;
    mode.mode.transmit_width_deg = ping.transmit_width_deg;
    mode.mode.receive_width_deg = ping.receive_width_deg;
    return mode;
  }

  /// Orders the sectors from port to starboard, and sets names, edges and absorptions.
  void complete(CollectedMode& collected) {
    KmallMode& mode = collected.mode;
    const BeamList& beams = collected.beams;
    mode.beam_angles_deg = beams.angles_deg;
    mode.beam_numbers = beams.numbers;
    constexpr double farthest_deg = 89.9;
    std::vector<std::size_t> order;
    for (std::size_t k = 0; k < beams.sectors.size(); ++k) {
      const std::size_t sector = beams.sectors[k];
      if (!order.empty() && order.back() == sector) continue;
      if (std::ranges::find(order, sector) != order.end())
        throw InputError(
            {survey_.soundings_file.string(), 0, 0},
            fmt::format("the beams of sector {} are not adjacent: expected sectors side by side", sector));
      mode.sector_edges_deg.push_back(k == 0 ? std::max(-farthest_deg, beams.angles_deg.front() - 1)
                                             : (beams.angles_deg[k - 1] + beams.angles_deg[k]) / 2);
      order.push_back(sector);
    }
    mode.sector_edges_deg.push_back(std::min(farthest_deg, beams.angles_deg.back() + 1));
    std::string name = "mode";
    for (const std::size_t sector : order) {
      mode.sectors.push_back(collected.sectors.at(sector));
      mode.absorptions_db_per_km.push_back(absorption_of(collected, sector));
    }
    for (const KmallSector& sector : collected.sectors)
      name += fmt::format("-{:.0f}", sector.frequency_hz / 1000);
    if (collected.fans > 1) name += fmt::format("-fan-{}", collected.fan + 1);
    std::size_t copies = 0;
    for (const KmallMode& other : survey_.modes)
      copies += other.name == name || other.name.starts_with(name + "-variant-") ? 1 : 0;
    mode.name = copies == 0 ? name : fmt::format("{}-variant-{}", name, copies + 1);
    std::ranges::stable_sort(mode.pings, {}, &KmallModePing::time_s);
    constexpr double steady_deg = 0.05;
    if (collected.largest_tilt_deg - collected.least_tilt_deg > steady_deg)
      survey_.notes.push_back(
          fmt::format("{}: the tilts of the sectors vary from {:.3f} to {:.3f} degrees; the scene "
                      "has their mean",
                      mode.name, collected.least_tilt_deg, collected.largest_tilt_deg));
  }

  double absorption_of(const CollectedMode& collected, std::size_t sector) const {
    double sum = 0, count = 0;
    for (const KmallPing& ping : survey_.pings) {
      if (!have_equal_frequencies(ping.sectors, collected.sectors)) continue;
      for (const KmallSounding& sounding : ping.soundings)
        if (sounding.is_valid && sounding.sector == sector) {
          sum += sounding.absorption_db_per_km;
          ++count;
        }
    }
    return count > 0 ? sum / count : 0;
  }

  KmallSurvey& survey_;
  std::vector<CollectedMode> modes_;
  std::size_t without_motion_ = 0, without_soundings_ = 0;
};

/// Returns whether a file has a water column. A file .kmall may also contain it.
bool has_columns(const KmallFile& file) { return !file.records("#MWC").empty(); }

void note_skipped(KmallSurvey& survey, const KmallFile& file) {
  constexpr std::array<std::string_view, 6> used{"#IIP", "#SVP", "#SKM", "#SPO", "#MRZ", "#MWC"};
  std::string skipped;
  for (const auto& [type, count] : file.counts())
    if (std::ranges::find(used, type) == used.end())
      skipped += fmt::format("{}{} {}", skipped.empty() ? "" : ", ", count, type);
  if (!skipped.empty())
    survey.notes.push_back(fmt::format("{}: datagrams that are not used: {}", file.path().string(), skipped));
}

}  // namespace

std::vector<std::filesystem::path> KmallSurvey::inputs() const {
  std::vector<std::filesystem::path> files{soundings_file};
  if (column_file) files.push_back(*column_file);
  return files;
}

bool is_kmall_name(const std::filesystem::path& file) {
  return file.extension() == ".kmall" || file.extension() == ".kmwcd";
}

std::optional<KmallMotion> motion_at(const std::vector<KmallMotion>& motion, double time_s) {
  if (motion.size() < 2 || time_s < motion.front().time_s - most_beyond_motion_s ||
      time_s > motion.back().time_s + most_beyond_motion_s)
    return {};
  const auto sample_after = [&](double at_s) {
    const auto after = std::ranges::lower_bound(motion, at_s, {}, &KmallMotion::time_s);
    return std::clamp<std::ptrdiff_t>(after - motion.begin(), 1, std::ssize(motion) - 1);
  };
  // Beyond the samples, the rates are those of the last part of this length.
  constexpr double rate_s = 0.1;
  std::ptrdiff_t before = sample_after(time_s) - 1, behind = before + 1;
  if (time_s < motion.front().time_s) behind = sample_after(motion.front().time_s + rate_s);
  if (time_s > motion.back().time_s) before = sample_after(motion.back().time_s - rate_s) - 1;
  const KmallMotion &a = motion[std::size_t(before)], &b = motion[std::size_t(behind)];
  const double share = (time_s - a.time_s) / (b.time_s - a.time_s);
  const auto between = [&](double from, double to) { return from + share * (to - from); };
  return KmallMotion{time_s, between(a.roll_deg, b.roll_deg), between(a.pitch_deg, b.pitch_deg),
                     a.heading_deg + share * remainder_deg(b.heading_deg - a.heading_deg),
                     between(a.heave_m, b.heave_m)};
}

KmallSurvey read_kmall_survey(const std::filesystem::path& file, bool needs_column) {
  KmallSurvey survey;
  std::filesystem::path soundings = file, column = file;
  soundings.replace_extension(".kmall");
  column.replace_extension(".kmwcd");
  survey.soundings_file = soundings;
  if (!std::filesystem::exists(soundings))
    throw InputError(
        {file.string(), 0, 0},
        fmt::format("needs the file '{}' beside it, which contains sectors and attitude: copy it into the "
                    "same folder",
                    soundings.filename().string()));
  KmallFile kmall(soundings);
  const auto one = [&](std::string_view type, std::string_view contents) -> const KmallRecord& {
    if (kmall.records(type).empty())
      throw InputError({soundings.string(), 0, 0}, fmt::format("has no {} ({})", contents, type));
    return kmall.records(type).back();
  };
  survey.installation = read_kmall_installation(kmall, one("#IIP", "installation parameters"));
  one("#SKM", "attitude");
  for (const KmallRecord& record : kmall.records("#SKM"))
    for (const KmallMotion& sample : read_kmall_motion(kmall, record)) survey.motion.push_back(sample);
  std::ranges::stable_sort(survey.motion, {}, &KmallMotion::time_s);
  survey.motion.erase(
      std::unique(survey.motion.begin(), survey.motion.end(),
                  [](const KmallMotion& x, const KmallMotion& y) { return x.time_s == y.time_s; }),
      survey.motion.end());
  for (const KmallRecord& record : kmall.records("#SPO"))
    survey.positions.push_back(read_kmall_position(kmall, record));
  if (!kmall.records("#SVP").empty())
    survey.profile = read_kmall_profile(kmall, kmall.records("#SVP").back());
  note_skipped(survey, kmall);
  Collector collector(survey);
  collector.add_soundings_of(kmall);
  if (std::filesystem::exists(column)) {
    survey.column_file = column;
    KmallFile columns(column);
    collector.add_columns_of(columns);
  } else if (has_columns(kmall)) {
    survey.column_file = soundings;
    collector.add_columns_of(kmall);
  } else if (needs_column) {
    throw InputError({file.string(), 0, 0},
                     fmt::format("has no water column (#MWC), and there is no file '{}' beside it",
                                 column.filename().string()));
  } else {
    survey.notes.push_back(fmt::format("there is no water column '{}': the beams are those of the soundings",
                                       column.filename().string()));
    collector.add_soundings_as_pings();
  }
  collector.finish();
  return survey;
}

}  // namespace tubefoot
