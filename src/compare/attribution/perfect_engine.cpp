// SPDX-License-Identifier: GPL-3.0-or-later
// Echoes of a perfect engine that samples each beam with few rays, and the expected error of random points.
// For N independent rays of weights w the variance of a bin of energy R is (N E[w^2] - R^2) / N.
// The number of rays in a bin is a Poisson variable of mean R^2 / variance.
#include "compare/attribution/perfect_engine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "compare/attribution/cut_tubes.hpp"
#include "engine/rays/ray_engine.hpp"
#include "files/usage_error.hpp"
#include "geometry/steps/stop.hpp"
#include "run/paths.hpp"
#include "run/simulation.hpp"
#include "run/tiles_in_view.hpp"
#include "run/transmission_rays.hpp"

namespace tubefoot {
namespace {

constexpr std::int64_t most_columns = 1000, most_rays = 100'000'000;

RunRequest request_for(const BeamSampling& sampling) {
  RunRequest request;
  request.engine = Engine::ray;
  request.rays = {sampling.columns > 0 ? RaySampling::column : RaySampling::random, sampling.rays,
                  RaySettings::Per::beam, 1};
  return request;
}

/// Returns whether the sensor receives only along the rays of its own tubes.
bool is_plain(const Survey& survey, std::size_t s) {
  const Sensor& sensor = *survey.sensors[s].sensor;
  return !sensor.has_separate_receiver() && !sensor.has_receiver_pair() &&
         !path_settings(survey.scene, sensor.frequency_khz());
}

/// Copies the energies of a sensor of the scene into those of a file.
class Copier {
 public:
  Copier(SensorEchoes& to, const SensorPlace& place) : to_(to), place_(place) {}
  /// `energy`: [beam of the sonar][sample].
  void copy(std::size_t ping, std::span<const double> energy) {
    for (std::size_t b = 0; b < to_.beams; ++b)
      std::ranges::copy(
          energy.subspan(place_.beams[b] * to_.samples, to_.samples),
          to_.energy.begin() + static_cast<std::ptrdiff_t>((ping * to_.beams + b) * to_.samples));
  }

 private:
  SensorEchoes& to_;
  const SensorPlace& place_;
};

/// Runs the ray engine, which supports every scene.
void run_rays(const Survey& survey, const SensorPlace& place, const BeamSampling& sampling, SensorEchoes& to,
              bool quiet) {
  RunRequest request = request_for(sampling);
  const auto [first, last] = std::ranges::minmax(place.pings);
  request.selection = {survey.sensors[place.sensor].sensor->description().name,
                       fmt::format("{}:{}", first, last), std::nullopt};
  SimulationStats stats;
  const std::vector<Recording> recordings = simulate(survey, request, stats, {quiet, nullptr});
  Copier copier(to, place);
  for (std::size_t ping = 0; ping < place.pings.size(); ++ping) {
    const PingEnergies energy = recordings.front().energy_of(place.pings[ping] - first);
    copier.copy(ping, energy);
  }
}

/// Adds the solid angles of hits, divided by the square of the range of their bins, so that they have the
/// unit of an energy.
void add_solid_angles(const History& history, std::span<const std::uint32_t> beam_of_tube,
                      std::span<const std::uint32_t> beams, const RangeSamples& samples,
                      std::vector<double>& angles) {
  const auto count = static_cast<std::size_t>(samples.count);
  for (const RayHit hit : history.hits) {
    const double place = std::floor((hit.slant_range_m - samples.first_m) / samples.step_m);
    if (!(place >= 0 && place < samples.count)) continue;
    const double range_m = samples.first_m + (place + 0.5) * samples.step_m;
    angles[beams[beam_of_tube[hit.tube]] * count + static_cast<std::size_t>(place)] +=
        hit.solid_angle_sr / (range_m * range_m);
  }
}

/// Traces the rays of each transmission, in columns or at random points. Writes energies into `to` and solid
/// angles into `angles`, unless it is null.
void run_traced(const Survey& survey, const SensorPlace& place, const BeamSampling& sampling,
                SensorEchoes& to, SensorEchoes* angles, bool quiet) {
  const Sensor& sensor = *survey.sensors[place.sensor].sensor;
  const Transmissions transmissions(survey, RunRequest{});
  TransmissionsAround around(transmissions);
  Progress progress("pings", place.pings.size(), quiet);
  Copier copier(to, place);
  for (std::size_t p = 0; p < place.pings.size(); ++p) {
    stop_if_wanted();
    const Transmissions& near = around.at(survey.sensor_set->transmissions_of(place.sensor), place.pings[p]);
    std::vector<double> energy(sensor.beams().size() * to.samples), of_angles(angles ? energy.size() : 0);
    for (std::size_t number = 0; number < sensor.transmissions(); ++number) {
      const Transmission transmission = near.received_by(place.sensor, place.pings[p], number);
      const RaySurface rays(transmission);
      const SensorModel model = transmission.model(place.sensor);
      const TubeSet whole = transmission.tubes();
      const std::vector<std::uint32_t>& beam_of_tube = sensor.beam_of_tube(number);
      const auto& beams = sensor.beams_of_transmission(number);
      const auto add = [&](const History& history) {
        const Echo echo = transmission.echo(history, place.sensor, model.model);
        for (std::size_t b = 0; b < beams.size(); ++b)
          for (std::size_t k = 0; k < to.samples; ++k)
            energy[beams[b] * to.samples + k] += echo.energy[b * to.samples + k];
        if (angles) add_solid_angles(history, beam_of_tube, beams, sensor.samples(), of_angles);
      };
      if (sampling.columns == 0) {
        History history{whole, transmission.scene().grid.unit_m(), {}, {}};
        trace_rays(*rays, history, {RaySampling::random, sampling.rays, RaySettings::Per::beam, 1},
                   beam_of_tube, [&] { add(history); });
        continue;
      }
      const CutTubes cut = [&] {
        try {
          return cut_into_columns(whole, beam_of_tube, static_cast<std::size_t>(sampling.columns));
        } catch (const std::invalid_argument& error) {
          throw UsageError(fmt::format("--ideal {}x{}: in sensor '{}', {}", sampling.columns, sampling.rays,
                                       sensor.description().name, error.what()));
        }
      }();
      History parts{cut.set, transmission.scene().grid.unit_m(), {}, {}};
      trace_rays(*rays, parts, {RaySampling::column, sampling.rays, RaySettings::Per::beam, 1}, cut.column,
                 [&] {
                   History history{whole, parts.grid_unit_m, {}, {}};
                   for (RayHit hit : parts.hits) {
                     hit.tube = cut.whole[hit.tube];
                     history.hits.push_back(hit);
                   }
                   add(history);
                 });
    }
    copier.copy(p, energy);
    if (angles) Copier(*angles, place).copy(p, of_angles);
    progress.step();
  }
}

/// Returns the energy of each hit, integrated as if the hit were a beam of its own.
std::vector<double> energies_of_hits(const Transmission& transmission, std::size_t s, const EchoModel& model,
                                     const History& history) {
  const RangeSamples& samples = transmission.sensor(s).samples();
  History alone{{}, history.grid_unit_m, {}, {}};
  std::vector<std::uint32_t> beams(history.hits.size());
  std::iota(beams.begin(), beams.end(), 0U);
  for (RayHit hit : history.hits) {
    hit.tube = static_cast<std::uint32_t>(alone.hits.size());
    alone.hits.push_back(hit);
  }
  const RangeSamples as_one{samples.first_m, samples.step_m * samples.count, 1};
  return integrate_echo(alone, {static_cast<int>(beams.size()), beams}, as_one, model).energy;
}

/// By bin of a ping: sum over rays of energy^2 / solid angle. By beam: solid angle.
struct SecondMoments {
  std::vector<double> of_bin, solid_angle_sr;
};

SecondMoments second_moments(const Transmissions& near, std::size_t s, std::size_t ping) {
  const Sensor& sensor = *near.survey().sensors[s].sensor;
  const RangeSamples& samples = sensor.samples();
  const auto count = static_cast<std::size_t>(samples.count);
  SecondMoments moments{std::vector<double>(sensor.beams().size() * count),
                        std::vector<double>(sensor.beams().size())};
  for (std::size_t number = 0; number < sensor.transmissions(); ++number) {
    const Transmission transmission = near.received_by(s, ping, number);
    const RaySurface rays(transmission);
    const SensorModel model = transmission.model(s);
    History history{transmission.tubes(), transmission.scene().grid.unit_m(), {}, {}};
    const auto& beam_of_tube = sensor.beam_of_tube(number);
    const auto& beams = sensor.beams_of_transmission(number);
    for (std::size_t t = 0; t < history.tubes.tubes.size(); ++t)
      moments.solid_angle_sr[beams[beam_of_tube[t]]] +=
          RayPatch(history.tubes, history.tubes.tubes[t]).solid_angle(0, 1, 0, 1);
    const std::int64_t rays_a_beam = std::max<std::int64_t>(100 * samples.count, 20'000);
    trace_rays(*rays, history, {RaySampling::stratified, rays_a_beam, RaySettings::Per::beam, 1},
               beam_of_tube, [&] {
                 const std::vector<double> energy = energies_of_hits(transmission, s, model.model, history);
                 std::size_t number_of_hit = 0;
                 for (const RayHit hit : history.hits) {
                   const double own = energy[number_of_hit++];
                   const double place = std::floor((hit.slant_range_m - samples.first_m) / samples.step_m);
                   if (!(place >= 0 && place < samples.count && hit.solid_angle_sr > 0)) continue;
                   moments.of_bin[beams[beam_of_tube[hit.tube]] * count + static_cast<std::size_t>(place)] +=
                       own * own / hit.solid_angle_sr;
                 }
               });
  }
  return moments;
}

}  // namespace

std::string BeamSampling::words() const {
  return columns > 0 ? fmt::format("{} x {} rays per beam", columns, rays)
                     : fmt::format("{} random points per beam", rays);
}

std::string BeamSampling::option() const {
  return columns > 0 ? fmt::format("{}x{}", columns, rays) : fmt::format("points:{}", rays);
}

std::optional<BeamSampling> beam_sampling(const std::string& words) {
  const auto number = [](std::string_view text) -> std::optional<std::int64_t> {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || error != std::errc() || end != text.data() + text.size() || text.front() == '-')
      return std::nullopt;
    return value;
  };
  BeamSampling sampling;
  constexpr std::string_view points = "points:";
  if (words.starts_with(points)) {
    const auto rays = number(std::string_view(words).substr(points.size()));
    if (!rays)
      throw UsageError(
          fmt::format("--ideal {}: expected a number of points per beam, as in points:512", words));
    sampling.rays = *rays;
  } else {
    const std::size_t by = words.find('x');
    if (by == std::string::npos) return std::nullopt;
    const auto columns = number(std::string_view(words).substr(0, by)),
               rays = number(std::string_view(words).substr(by + 1));
    if (!columns || !rays) return std::nullopt;
    if (*columns < 1 || *columns > most_columns)
      throw UsageError(
          fmt::format("--ideal {}: expected 1 to {} columns of rays per beam", words, most_columns));
    sampling = {*columns, *rays};
  }
  if (sampling.rays < 1 || sampling.rays > most_rays)
    throw UsageError(fmt::format("--ideal {}: expected 1 to {} rays per beam", words, most_rays));
  return sampling;
}

PerfectEchoes perfect_echoes(const SceneAtHand& scene, const EchoContents& reference,
                             const BeamSampling& sampling, const std::optional<std::string>& only,
                             bool with_solid_angles, bool quiet) {
  PerfectEchoes ideal{reference, std::nullopt};
  if (only) std::erase_if(ideal.energies.sensors, [&](const SensorEchoes& s) { return s.name != *only; });
  for (SensorEchoes& sensor : ideal.energies.sensors) sensor.energy_bound.clear();
  if (with_solid_angles) ideal.solid_angles = ideal.energies;
  for (std::size_t k = 0; k < ideal.energies.sensors.size(); ++k) {
    stop_if_wanted();
    SensorEchoes& sensor = ideal.energies.sensors[k];
    const SensorPlace place = scene.place_of(sensor);
    const bool traced = sampling.columns > 1 || with_solid_angles;
    if (traced && !is_plain(scene.survey(), place.sensor))
      throw UsageError(fmt::format(
          fmt::runtime(with_solid_angles
                           ? "--ideal {}: an output model with means needs the solid angles of rays, which "
                             "are not defined for all paths of sensor '{}': use an output model without means"
                           : "--ideal {}: columns of rays cannot follow all paths of sensor '{}': use one "
                             "column, or points:N"),
          sampling.option(), sensor.name));
    if (traced)
      run_traced(scene.survey(), place, sampling, sensor,
                 with_solid_angles ? &ideal.solid_angles->sensors[k] : nullptr, quiet);
    else
      run_rays(scene.survey(), place, sampling, sensor, quiet);
  }
  return ideal;
}

double IdealShare::explained() const {
  const double perfect = forecast ? forecast->l1 : l1;
  return yours_l1 > perfect ? perfect / yours_l1 : 1;
}

std::string ideal_text(const IdealShare& share) {
  const auto& forecast = share.forecast;
  return fmt::format(
      "  a perfect engine with {} would have L1 {:.3g}{} (RMS {:.3g} dB); the candidate has {:.3g}: sampling "
      "explains {}\n",
      share.sampling, forecast ? forecast->l1 : share.l1,
      forecast ? fmt::format(" +- {:.2g}", forecast->l1_deviation) : "",
      forecast ? forecast->rms_db : share.rms_db, share.yours_l1,
      share.explained() == 1 ? "the whole error"
                             : fmt::format("{:.0f} % of the error", 100 * share.explained()));
}

nlohmann::ordered_json ideal_json(const IdealShare& share) {
  nlohmann::ordered_json json{{"sampling", share.sampling},
                              {"l1_error", share.l1},
                              {"rms_db_error", share.rms_db},
                              {"explains", share.explained()},
                              {"forecast", nullptr}};
  if (const auto& forecast = share.forecast)
    json["forecast"] = {{"l1_error", forecast->l1},
                        {"l1_deviation", forecast->l1_deviation},
                        {"rms_db_error", forecast->rms_db},
                        {"empty_where_lit", forecast->empty_where_lit}};
  return json;
}

namespace {

/// Computes ln k!. The last bit of lgamma of the C library depends on the processor.
double log_factorial(double k) {
  using Doubles = boost::math::policies::policy<boost::math::policies::promote_double<false>>;
  return boost::math::lgamma(k + 1, Doubles());
}

}  // namespace

double poisson_mean_deviation(double mean) {
  if (!(mean > 0)) return 0;
  // E|X - m| = 2 m^(k + 1) exp(-m) / k!, where k is the integer part of m.
  const double whole = std::floor(mean);
  return 2 * std::exp(whole * std::log(mean) - mean - log_factorial(whole));
}

double poisson_square_db(double mean) {
  if (!(mean > 0)) return 0;
  constexpr double large = 1000;
  const double db = 10 / std::numbers::ln10;
  if (mean > large) return db * db / mean;
  double sum = 0;
  const double last = mean + 12 * std::sqrt(mean) + 20;
  for (double k = 0; k <= last; ++k) {
    const double chance = std::exp(k * std::log(mean) - mean - log_factorial(k)),
                 error = decibel_error(mean, k);
    sum += chance * error * error;
  }
  return sum;
}

std::optional<PointsForecast> points_forecast(const SceneAtHand& scene, const SensorEchoes& reference,
                                              const BeamSampling& sampling) {
  const SensorPlace place = scene.place_of(reference);
  const Survey& survey = scene.survey();
  if (sampling.columns > 0 || !is_plain(survey, place.sensor) ||
      survey.sensors[place.sensor].sensor->has_patterns())
    return std::nullopt;
  const Transmissions transmissions(survey, RunRequest{});
  TransmissionsAround around(transmissions);
  const double threshold = lit_threshold(reference.energy);
  double error = 0, square_error = 0, square_db = 0, empty = 0, total = 0, lit = 0;
  for (std::size_t p = 0; p < place.pings.size(); ++p) {
    stop_if_wanted();
    const SecondMoments moments =
        second_moments(around.at(survey.sensor_set->transmissions_of(place.sensor), place.pings[p]),
                       place.sensor, place.pings[p]);
    for (std::size_t b = 0; b < reference.beams; ++b)
      for (std::size_t k = 0; k < reference.samples; ++k) {
        const double energy = reference.at(p, b, k);
        if (!(energy > 0)) continue;
        total += energy;
        const std::size_t beam = place.beams[b];
        const double integral = moments.of_bin[beam * reference.samples + k] * moments.solid_angle_sr[beam];
        // If none of many rays hit a bin, few rays will not hit it either.
        const double variance =
            (std::max(integral, energy * energy) - energy * energy) / double(sampling.rays);
        if (integral == 0) {
          error += 2 * energy;
          square_db += energy > threshold ? largest_error_db * largest_error_db : 0;
          empty += energy > threshold;
          lit += energy > threshold;
          continue;
        }
        if (variance == 0) {
          lit += energy > threshold;
          continue;
        }
        const double points = energy * energy / variance;
        const double mean = energy * poisson_mean_deviation(points);
        error += mean;
        square_error += variance - mean * mean;
        if (energy <= threshold) continue;
        ++lit;
        square_db += poisson_square_db(points);
        empty += std::exp(-points);
      }
  }
  return PointsForecast{total > 0 ? error / total : 0, total > 0 ? std::sqrt(square_error) / total : 0,
                        lit > 0 ? std::sqrt(square_db / lit) : 0, empty};
}

}  // namespace tubefoot
