// SPDX-License-Identifier: GPL-3.0-or-later
// Tests signals of a transmission over mirrors: the mirrors of the scene, the requested orders, and the
// energies of the scene.
#include "run/signal_paths.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <set>

#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"
#include "fixtures/world/echoes.hpp"
#include "sensors/kinds/scene_file.hpp"

namespace tubefoot {
namespace {

using testing::HasSubstr;

/// The sonar has a nearly omnidirectional view from 5 m below a rough surface, over a small seabed.
std::string under_the_surface(const std::string& paths, const std::string& water = still_water()) {
  return water + "[sea_surface]\nloss_db = 1.5\nrms_roughness_m = 0.03\n[paths]\n" + paths +
         lambert_material("bed", -10) + flat_terrain(16, 16, "centre_m = [0, 0, -20]\n") +
         fixed_at(0, 0, -5) + R"([[sensors]]
name = "camera"
kind = "didson"
frequency_khz = 5
beams = 3
horizontal_deg = 170
vertical_deg = 170
tilt_deg = 0
samples = 100
window_start_m = 0
window_length_m = 50
)";
}

struct OneTransmission {
  explicit OneTransmission(const std::string& text)
      : survey(open_survey(read_scene_file(folder.write("scene.toml", text)))),
        transmissions(*survey, request_of(survey->scene.description.run)),
        transmission(transmissions.received_by(0, 0, 0)),
        at(transmission.pose().position_m) {}
  TestFolder folder;
  std::unique_ptr<const Survey> survey;
  Transmissions transmissions;
  Transmission transmission;
  glm::dvec3 at;
};

TEST(SignalPaths, HaveTheEnergiesOfARun) {
  const OneTransmission one(under_the_surface("order = 3\n"));
  CoherentReceiver receiver;
  receiver.channels = {{one.at, one.at}};
  receiver.pulse = gaussian_pulse(1e-3);
  receiver.times = {0, 2100, 150};
  receiver.carrier_hz = 5000;
  receiver.sound_speed_m_s = 1500;
  std::vector<SignalSample> samples;
  for (std::uint32_t n = 0; n < receiver.times.count; ++n) samples.push_back({0, n});
  std::array<double, 4> energy{};
  for_signal_paths(one.transmission, 0, receiver.channels,
                   {[&](const CoherentPath& path) {
                      CoherentReceiver own = receiver;
                      own.channels = path.channels;
                      const CovarianceMatrix r =
                          signal_covariances(path.patches, own, samples, path.model, 1e-5);
                      for (std::size_t n = 0; n < samples.size(); ++n)
                        energy[path.order] += r.at(n, n).real() / receiver.times.rate_hz;
                      // The surface reverses the phase at each reflection.
                      EXPECT_EQ(path.phase, path.order == 2 ? -1.0 : 1.0);
                    },
                    [&](const CoherentArrival& arrival) {
                      energy[arrival.order] += std::norm(arrival.waves.at(0).amplitude);
                    }});
  for (const std::size_t order : {1, 2, 3}) {
    double expected =
        echoes_of(under_the_surface(fmt::format("order = 3\nonly_order = {}\n", order))).total();
    if (order == 1) {  // the scattered part is that of the transmission itself
      expected = 0;
      EXPECT_EQ(energy[1], 0) << "nothing arrives through the camera's sides";
    }
    EXPECT_NEAR(energy[order], expected, 1e-4 * expected) << order;
  }
  EXPECT_GT(energy[2], 0);
}

TEST(SignalPaths, AreOfTheOrdersThatAreRequested) {
  const auto orders = [](const std::string& paths, double tilt_deg) {
    std::string text = under_the_surface(paths);
    text.replace(text.find("tilt_deg = 0"), 12, fmt::format("tilt_deg = {}", tilt_deg));
    const OneTransmission one(text);
    const std::array<SignalChannel, 1> channels{{{one.at, one.at}}};
    std::multiset<std::string> found;
    for_signal_paths(
        one.transmission, 0, channels,
        {[&](const CoherentPath& path) { found.insert(fmt::format("{}", path.order)); },
         [&](const CoherentArrival& arrival) { found.insert(fmt::format("{}!", arrival.order)); }});
    return found;
  };
  using Found = std::multiset<std::string>;
  EXPECT_EQ(orders("order = 1\n", 0), Found{});
  EXPECT_EQ(orders("order = 2\n", 0), (Found{"2", "2"}));
  EXPECT_EQ(orders("order = 3\n", 0), (Found{"2", "2", "3"}));
  EXPECT_EQ(orders("order = 3\nonly_order = 3\n", 0), (Found{"3"}));
  // Upwards: the surface itself, and the seabed over it.
  EXPECT_EQ(orders("order = 3\n", -90), (Found{"1!", "3"}));
}

TEST(SignalPaths, AreNoneWithoutMirrorsAndRefuseWhatHasNoPhase) {
  std::string plain = under_the_surface("order = 1\n");
  plain.replace(plain.find("[sea_surface]"), plain.find("[paths]") - plain.find("[sea_surface]"), "");
  const auto ask = [](const std::string& text) {
    const OneTransmission one(text);
    const std::array<SignalChannel, 1> channels{{{one.at, one.at}}};
    const auto never = [](const auto&) { ADD_FAILURE(); };
    for_signal_paths(one.transmission, 0, channels, {never, never});
  };
  ask(plain);
  const auto message = [&](const std::string& text) -> std::string {
    try {
      ask(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing";
  };
  EXPECT_THAT(message(under_the_surface("order = 3\nscatterings = 2\n")), HasSubstr("scatterings = 1"));
  EXPECT_THAT(message(under_the_surface("order = 2\n",
                                        "[water]\nprofile = \"gradient\"\nsound_speed_m_s = 1500\n"
                                        "gradient_per_s = 0.1\nprofile_bottom_m = 40\n")),
              HasSubstr("profile = \"constant\""));
}

}  // namespace
}  // namespace tubefoot
