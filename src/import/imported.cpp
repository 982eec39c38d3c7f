// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the pictures of another engine, tests the assumptions about their order, scale and axes against the
// reference, and returns a candidate for `compare` (docs/engine-validation.md).
#include "import/imported.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "files/memory_at_hand.hpp"
#include "files/usage_error.hpp"
#include "files/words.hpp"
#include "geometry/steps/stop.hpp"
#include "import/arrangement.hpp"
#include "import/assumptions.hpp"
#include "import/cartesian.hpp"
#include "import/foreign_file.hpp"

namespace tubefoot {
namespace {

/// Largest number of bins for the tests.
constexpr std::size_t most_bins = 400'000;

struct Frame {
  ForeignFrame picture;
  SourcePlace place;
};

/// Order, direction and scale in which pictures are read.
struct Reading {
  std::string order, forward, scale;
  bool flip_beams = false, flip_range = false;
};

class Importer {
 public:
  Importer(ImportOptions options, std::vector<Frame> frames, Imported& result)
      : options_(std::move(options)), frames_(std::move(frames)), result_(result) {}

  std::size_t pings() const {
    if (options_.order != "two-sided") return frames_.size();
    std::size_t rows = 0;
    for (const Frame& frame : frames_) rows += frame.picture.rows;
    return rows;
  }

  void read(const ImportReference& reference) {
    echoes_ = &reference.file.contents.sensors.at(reference.sensor);
    axes_ = axes_of(reference.file, reference.sensor);
    assumed_ = {options_.order, options_.forward.empty() ? "up" : options_.forward, options_.scale,
                options_.flip_beams.value_or(false), options_.flip_range.value_or(false)};
    if (!is_cartesian()) assumed_.order = order_of(frames_.front().picture, options_.order, axes_);
    CandidateEchoes& candidate = result_.candidate;
    candidate.pings = pings();
    require_pings(candidate.pings);
    std::size_t outside = 0;
    const BinAxes declared = declared_axes(assumed_, &result_.told);
    tell_reading();
    const bool same = same_axes(declared, axes_);
    candidate.axes = options_.resample || same ? axes_ : declared;
    require_memory(2.0 * sizeof(double) * static_cast<double>(candidate.pings * bins_of(candidate.axes)),
                   frames_.front().place, "the energies", "import fewer pings at once");
    candidate.energy = energies(assumed_, candidate.pings, 1, declared, candidate.axes, &outside);
    if (!same) axes_differ(declared);
    if (outside > 0)
      result_.warnings.push_back(fmt::format(
          "{} bins lie mostly outside of their pictures: their values are 0 or the mean of the part inside",
          outside));
    test(declared);
  }

 private:
  bool is_cartesian() const { return !options_.cartesian.empty(); }
  static std::size_t bins_of(const BinAxes& axes) { return axes.beams.count() * axes.samples.count(); }

  void require_pings(std::size_t pings) {
    if (pings % echoes_->pings != 0)
      throw UsageError(
          fmt::format("there are {} pictures, but the reference has {} pings of '{}': import the same number "
                      "of pictures for each ping, or use a reference of these pings (tubefoot run --pings)",
                      pings, echoes_->pings, echoes_->name));
    frames_a_ping_ = pings / echoes_->pings;
    for (std::size_t ping = 0; ping < pings; ++ping)
      result_.candidate.ping_of_reference.push_back(ping / frames_a_ping_);
    if (frames_a_ping_ > 1)
      result_.told.push_back(
          fmt::format("each ping has {} pictures: compare with --frames {}", frames_a_ping_, frames_a_ping_));
  }

  void tell_reading() {
    const char* turned = is_cartesian()                    ? ""
                         : assumed_.order == "range-first" ? "a row is a range"
                         : assumed_.order == "beam-first"  ? "a row is a beam"
                                                           : "a row is a ping, with port on the left";
    result_.told.push_back(is_cartesian()
                               ? fmt::format("a fan in pixels with forward {}{}, resampled onto {} beams x "
                                             "{} samples as means over the area of each bin",
                                             assumed_.forward, assumed_.flip_beams ? ", mirrored" : "",
                                             axes_.beams.count(), axes_.samples.count())
                               : fmt::format("{}{}{}", turned, assumed_.flip_beams ? ", beams reversed" : "",
                                             assumed_.flip_range ? ", ranges reversed" : ""));
  }

  void axes_differ(const BinAxes& declared) {
    if (options_.resample) {
      result_.told.push_back(fmt::format(
          "resampled from {} beams x {} samples onto {} x {} of the reference as means over the area of each "
          "bin",
          declared.beams.count(), declared.samples.count(), axes_.beams.count(), axes_.samples.count()));
      return;
    }
    result_.warnings.push_back(
        "the bins of the picture differ from those of the reference, so 'compare' will reject them: compute "
        "a reference with these bins (spacing, beam_angles_deg, samples and ranges of the scene's sensor), "
        "or import with --resample");
  }

  std::vector<PolarPicture> pictures_of(const Frame& frame, const Reading& reading,
                                        std::size_t* outside) const {
    if (!is_cartesian())
      return arranged(frame.picture, reading.order, reading.flip_beams, reading.flip_range,
                      ValueScale(reading.scale), frame.place);
    const ForeignFrame turned = turned_up(frame.picture, reading.forward);
    PolarPicture fan =
        resampled_fan(ValueScale(reading.scale).energies(turned, frame.place), turned.rows, turned.columns,
                      fan_place(options_.cartesian, turned.rows, turned.columns, axes_), axes_, outside);
    if (reading.flip_beams) {
      PolarPicture mirrored = fan;
      for (std::size_t b = 0; b < fan.beams; ++b)
        std::copy_n(fan.energy.begin() + static_cast<std::ptrdiff_t>((fan.beams - 1 - b) * fan.samples),
                    fan.samples, mirrored.energy.begin() + static_cast<std::ptrdiff_t>(b * fan.samples));
      fan = std::move(mirrored);
    }
    return {std::move(fan)};
  }

  BinAxes declared_axes(const Reading& reading, std::vector<std::string>* told) const {
    if (is_cartesian()) return axes_;
    const PolarPicture first = pictures_of(frames_.front(), reading, nullptr).front();
    std::vector<std::string> words;
    BinAxes axes = picture_axes(first.beams, first.samples, first.axes, axes_, options_, words);
    if (told) told->insert(told->end(), words.begin(), words.end());
    return axes;
  }

  /// Returns the energies of `count` pings, every `step`-th one, on the bins `to`.
  std::vector<double> energies(const Reading& reading, std::size_t count, std::size_t step,
                               const BinAxes& declared, const BinAxes& to, std::size_t* outside) const {
    std::vector<double> all;
    all.reserve(count * bins_of(to));
    const bool as_is = is_cartesian() || same_axes(declared, to);
    std::size_t ping = 0;
    for (const Frame& frame : frames_) {
      stop_if_wanted();
      if (ping >= count * step) break;
      if (options_.order != "two-sided" && ping % step != 0) {
        ++ping;
        continue;
      }
      for (const PolarPicture& picture : pictures_of(frame, reading, outside)) {
        if (picture.beams != declared.beams.count() || picture.samples != declared.samples.count())
          throw InputError(
              frame.place,
              fmt::format("has {} beams x {} samples, but {} has {} x {}", picture.beams, picture.samples,
                          frames_.front().place.file, declared.beams.count(), declared.samples.count()));
        if (ping < count * step && ping++ % step == 0) {
          const std::vector<double> rows = as_is ? picture.energy : rebinned(picture.energy, declared, to);
          all.insert(all.end(), rows.begin(), rows.end());
        }
      }
    }
    return all;
  }

  void test(const BinAxes& declared) {
    const std::size_t bins = bins_of(axes_),
                      pings = std::clamp<std::size_t>(most_bins / bins, 1, echoes_->pings);
    const EchoShape shape{pings, axes_.beams.count(), axes_.samples.count()};
    const std::vector<double> truth(echoes_->energy.begin(),
                                    echoes_->energy.begin() + static_cast<std::ptrdiff_t>(shape.bins()));
    std::vector<Hypothesis> hypotheses;
    const auto energies_of = [this, pings](const Reading& reading) {
      return [this, reading, pings] {
        try {
          return energies(reading, pings, frames_a_ping_, declared_axes(reading, nullptr), axes_, nullptr);
        } catch (const std::runtime_error&) {  // the pictures cannot be read in this way
          return std::vector<double>();
        }
      };
    };
    for (const Reading& reading : readings()) {
      const auto [name, remedy] = words_for(reading);
      Reading otherwise = reading;
      otherwise.scale = other_scale();
      hypotheses.push_back({name, remedy, energies_of(reading), otherwise.scale, energies_of(otherwise)});
    }
    Verdict verdict = tested(shape, axes_, truth, hypotheses, declared);
    result_.found = std::move(verdict.found);
    for (std::string& words : verdict.refuted) {
      refuted_ = true;
      result_.warnings.push_back(std::move(words));
    }
    for (std::string& words : verdict.ambiguous) result_.warnings.push_back(std::move(words));
    if (refuted_ && options_.strict)
      throw InputError(frames_.front().place,
                       fmt::format("the reference contradicts the assumed interpretation (--strict): {}",
                                   fmt::join(result_.warnings, "; ")));
  }

  /// Returns all orders that the shape of the pictures permits, the assumed one first.
  std::vector<Reading> readings() const {
    std::vector<Reading> all{assumed_};
    const bool square = frames_.front().picture.rows == frames_.front().picture.columns;
    for (const bool turned : {false, true})
      for (const bool beams : {false, true})
        for (const bool range : {false, true}) {
          const bool as_assumed = !turned && !beams && !range;
          if (as_assumed || (is_cartesian() && range)) continue;
          if (turned && !(is_cartesian() || (square && assumed_.order != "two-sided"))) continue;
          Reading reading = assumed_;
          if (beams) reading.flip_beams = !reading.flip_beams;
          if (range) reading.flip_range = !reading.flip_range;
          if (turned && is_cartesian()) reading.forward = opposite(assumed_.forward);
          if (turned && !is_cartesian())
            reading.order = assumed_.order == "range-first" ? "beam-first" : "range-first";
          all.push_back(reading);
        }
    return all;
  }

  /// Returns another plausible scale of the numbers, or an empty string.
  std::string other_scale() const {
    if (assumed_.scale == "amplitude") return "energy";
    return assumed_.scale == "energy" || assumed_.scale == "8bit" ? "amplitude" : "";
  }

  static std::string opposite(const std::string& forward) {
    if (forward == "up" || forward == "down") return forward == "up" ? "down" : "up";
    return forward == "left" ? "right" : "left";
  }

  /// Returns the name of a reading relative to the assumed one, and the options that select it.
  std::pair<std::string, std::string> words_for(const Reading& reading) const {
    std::vector<std::string> name, remedy;
    const auto add = [&](bool differs, const std::string& word, const std::string& option) {
      if (!differs) return;
      name.push_back(word);
      remedy.push_back(option);
    };
    add(reading.order != assumed_.order, "rows and columns exchanged", "--order " + reading.order);
    add(reading.forward != assumed_.forward, "upside down", "--forward " + reading.forward);
    add(reading.flip_beams != assumed_.flip_beams, "mirrored",
        reading.flip_beams ? "--flip-beams" : "--no-flip-beams");
    add(reading.flip_range != assumed_.flip_range, "ranges reversed",
        reading.flip_range ? "--flip-range" : "--no-flip-range");
    if (name.empty()) return {"the assumed interpretation", ""};
    return {fmt::format("{}", fmt::join(name, " and ")), fmt::format("{}", fmt::join(remedy, " "))};
  }

  ImportOptions options_;
  std::vector<Frame> frames_;
  Imported& result_;
  const SensorEchoes* echoes_ = nullptr;
  BinAxes axes_;
  Reading assumed_;
  std::size_t frames_a_ping_ = 1;
  bool refuted_ = false;
};

/// Rejects options of pictures in beams and ranges, which do not apply to Cartesian pictures.
void refuse_beside_cartesian(const ImportOptions& o) {
  if (o.cartesian.empty()) return;
  const std::pair<const char*, bool> idle[] = {{"--order", !o.order.empty()},
                                               {"--azimuths", !o.azimuths.empty()},
                                               {"--ranges", !o.ranges.empty()},
                                               {"--range-origin", !o.range_origin.empty()},
                                               {"--flip-range", o.flip_range.value_or(false)},
                                               {"--no-flip-range", !o.flip_range.value_or(true)},
                                               {"--resample", o.resample},
                                               {"--range-variable", !o.range_variable.empty()},
                                               {"--azimuth-variable", !o.azimuth_variable.empty()}};
  for (const auto& [option, given] : idle)
    if (given)
      throw UsageError(
          fmt::format("{} has no effect with --cartesian, which resamples pixels onto the bins of the "
                      "reference: omit the option",
                      option));
}

std::vector<Frame> frames_of_files(const ImportOptions& options,
                                   const std::vector<std::filesystem::path>& files,
                                   std::vector<std::string>& told) {
  const ReadOptions how{
      {options.variable, options.range_variable, options.azimuth_variable, options.profile == "oceansim"},
      options.topic};
  std::vector<Frame> frames;
  double bytes = 0;
  for (const std::filesystem::path& file : files) {
    stop_if_wanted();
    ForeignData data = read_foreign_file(file, how);
    for (const std::string& words : data.noticed)
      if (std::ranges::find(told, words) == told.end()) told.push_back(words);
    if (data.frames.empty())
      throw InputError({file.string()}, "contains no picture: there is nothing to import");
    for (ForeignFrame& frame : data.frames) {
      bytes += 3.0 * sizeof(double) * static_cast<double>(frame.values.size());
      frames.push_back({std::move(frame), {file.string()}});
    }
    require_memory(bytes, {file.string()}, "the pictures", "import fewer pictures at once");
  }
  return frames;
}

}  // namespace

std::size_t sensor_of(const WholeEchoFile& reference, const std::optional<std::string>& name) {
  const std::vector<SensorEchoes>& sensors = reference.contents.sensors;
  std::vector<std::string> names;
  for (const SensorEchoes& sensor : sensors) names.push_back(sensor.name);
  if (!name && sensors.size() == 1) return 0;
  const auto found = name ? std::ranges::find(names, *name) : names.end();
  if (found == names.end())
    throw UsageError(fmt::format("{}name the sensor of the pictures with --sensor: {}",
                                 name ? fmt::format("the reference has no sensor '{}': ", *name) : "",
                                 one_of(names, '\'')));
  return static_cast<std::size_t>(found - names.begin());
}

Imported imported(ImportOptions options, const std::vector<std::filesystem::path>& files,
                  const std::function<const ImportReference&(std::size_t pings)>& reference_of) {
  refuse_beside_cartesian(options);
  Imported result;
  std::vector<Frame> frames = frames_of_files(options, files, result.told);
  if (!options.range_origin.empty() && options.ranges.empty() && frames.front().picture.range_m.empty())
    throw UsageError(
        fmt::format("--range-origin needs ranges, but {} has none: add --ranges, or omit --range-origin",
                    frames.front().place.file));
  const std::vector<std::string> assumed = apply_profile(options, frames.front().picture);
  result.told.insert(result.told.begin(), assumed.begin(), assumed.end());
  const bool eight_bits = std::ranges::any_of(frames, [](const Frame&f) { return f.picture.eight_bits; }) ||
                          options.scale == "8bit",
             joules = !eight_bits && options.profile.empty() && options.scale != "db";
  Importer importer(options, std::move(frames), result);
  importer.read(reference_of(importer.pings()));
  result.candidate.attributes = {{"engine", options.profile.empty() ? "imported" : options.profile},
                                 {"arithmetic", joules       ? "as stored"
                                                : eight_bits ? "8 bits, no unit"
                                                             : "as stored, no unit"},
                                 {"import_profile", options.profile},
                                 {"import_options", words_of(options)},
                                 {"import_unit", joules ? "J m-2" : "none"},
                                 {"import_found", fmt::format("{}", fmt::join(result.found, "; "))},
                                 {"import_warnings", fmt::format("{}", fmt::join(result.warnings, "; "))}};
  if (!joules)
    result.told.emplace_back(
        "the unit of the numbers is unknown: compare with --fit gain or --fit gain,range,offset");
  return result;
}

}  // namespace tubefoot
