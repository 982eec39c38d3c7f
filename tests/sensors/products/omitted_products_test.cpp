// SPDX-License-Identifier: GPL-3.0-or-later
// Tests of products that a run omits, for each kind of sensor. Exactly the files of an omitted product are
// missing, and the others keep their bytes.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <set>

#include "fixtures/world/irregular_surveys.hpp"
#include "sensors/recordings/sensor_kind.hpp"

namespace tubefoot {
namespace {

using Files = std::map<std::string, std::string>;  ///< bytes by name

/// Energies that no one may read.
class UnreadEnergies : public PackedPings {
 public:
  PingEnergies values(std::size_t, std::size_t) const override {
    throw std::logic_error("energies are read");
  }
  std::vector<unsigned char> chunk(std::size_t, std::size_t) const override {
    throw std::logic_error("energies are read");
  }
};

Files files_without(const Recording& recording, const OmittedProducts& omitted) {
  const TestFolder folder;
  RunContext run;
  run.frame = samples::tangent_frame();
  run.start_unix_s = 1735689600;
  run.seed = 5;
  run.pictures.animated = true;
  run.omitted = omitted;
  std::vector<std::string> warnings;
  Files files;
  for (const auto& file :
       kind_of(recording.sensor->description()).write_products(folder.path(), recording, run, warnings))
    files[file.string()] = bytes_of(folder.path() / file);
  std::set<std::string> names;
  for (const auto& [name, bytes] : files) names.insert(name);
  EXPECT_EQ(names_below(folder.path()), names);
  return files;
}

/// The product of a file: its name without the sensor, and without numbers of pings and lines.
std::string product_of(const std::string& file, const std::string& sensor) {
  EXPECT_TRUE(file.starts_with(sensor)) << file;
  const std::string rest =
      std::regex_replace(file.substr(sensor.size()), std::regex("^(-line-\\d\\d|-\\d{4})"), "");
  return rest.substr(1);
}

/// `rare`: products that this recording does not have.
void expect_omits(const samples::OwnedRecording& made, const std::set<std::string>& rare) {
  const Recording& recording = made.recording;
  const std::string& sensor = made.sensor->description().name;
  const std::vector<std::string> products = kind_of(made.sensor->description()).products();
  const Files all = files_without(recording, {});
  std::set<std::string> written;
  for (const auto& [file, bytes] : all) written.insert(product_of(file, sensor));
  std::set<std::string> expected(products.begin(), products.end());
  for (const std::string& product : rare) EXPECT_EQ(expected.erase(product), 1u) << product;
  EXPECT_EQ(written, expected);
  for (const std::string& product : products) {
    Files kept;
    for (const auto& [file, bytes] : all)
      if (product_of(file, sensor) != product) kept.emplace(file, bytes);
    EXPECT_TRUE(files_without(recording, {product}) == kept) << product;
    Files alone;
    OmittedProducts others(products.begin(), products.end());
    others.erase(product);
    for (const auto& [file, bytes] : all)
      if (product_of(file, sensor) == product) alone.emplace(file, bytes);
    EXPECT_TRUE(files_without(recording, others) == alone) << product << " alone";
  }
  Recording unread = recording;
  unread.packed_energy = std::make_shared<const UnreadEnergies>();
  unread.energy = {};
  EXPECT_THROW(files_without(unread, {}), std::logic_error);
  EXPECT_TRUE(files_without(unread, OmittedProducts(products.begin(), products.end())).empty());
}

TEST(OmittedProducts, OfACamera) {
  expect_omits(samples::irregular_survey(
                   samples::sonar("camera", samples::camera(48, 512).kind.as<DidsonDescription>()), 3),
               {"aris"});
}

TEST(OmittedProducts, OfAnImagingSonar) {
  ImagingDescription fan;
  fan.beams = 8;
  fan.samples = 40;
  expect_omits(samples::irregular_survey(samples::sonar("imaging", fan), 3), {});
}

TEST(OmittedProducts, OfAScanningSonar) {
  ScanningDescription scan;
  scan.step_deg = 20;
  scan.samples = 40;
  expect_omits(samples::irregular_survey(samples::sonar("scanning", scan), 3), {});
}

TEST(OmittedProducts, OfASidescan) {
  expect_omits(samples::irregular_survey(
                   samples::sonar("sidescan", samples::sidescan(100).kind.as<SidescanDescription>()), 20),
               {});
}

TEST(OmittedProducts, OfAnInterferometricSonar) {
  InterferometricDescription pair;
  pair.samples = 60;
  pair.phase_noise = true;
  expect_omits(samples::irregular_survey(samples::sonar("pair", pair), 10), {});
}

TEST(OmittedProducts, OfAnEchosounder) {
  EchosounderDescription sounder;
  sounder.samples = 100;
  expect_omits(samples::irregular_survey(samples::sonar("sounder", sounder), 20), {});
}

TEST(OmittedProducts, OfAMultibeam) {
  MultibeamDescription fan;
  fan.beams = 31;
  fan.samples = 300;
  fan.range_max_m = 20;
  expect_omits(samples::irregular_survey(samples::sonar("fan", fan), 40), {});
}

}  // namespace
}  // namespace tubefoot
