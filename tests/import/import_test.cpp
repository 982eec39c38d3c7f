// SPDX-License-Identifier: GPL-3.0-or-later
// Tests `tubefoot import`. Pictures are made from a reference with known distortions, and the import
// recovers its energies. It detects wrong assumptions, and rejects unreadable files.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "files/file_hash.hpp"
#include "fixtures/foreign_echoes.hpp"
#include "fixtures/world/echoes.hpp"
#include "foreign_arrays.hpp"
#include "import/bin_axes.hpp"
#include "sensors/recordings/whole_echo_file.hpp"

namespace tubefoot {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

using Words = std::vector<std::string>;

/// A seabed with a block and a sphere that are not mirror images of each other, seen ahead. `keys`: further
/// keys of the sonar.
std::string scene_with(const std::string& keys) {
  return R"(title = "Blocks"
[[materials]]
name = "sand"
lambert_db = -22
[[materials]]
name = "rock"
lambert_db = -10
[[terrain]]
kind = "fractal"
material = "sand"
width_m = 30
length_m = 30
cell_m = 0.3
rms_height_m = 0.05
largest_wavelength_m = 4
seed = 3
[[objects]]
name = "block"
shape = "box"
material = "rock"
size_m = [1.2, 0.8, 1.2]
position_m = [-2.5, 6, 0.4]
heading_deg = 30
[[objects]]
name = "ball"
shape = "sphere"
material = "rock"
radius_m = 0.5
position_m = [1.5, 8, 0.3]
[trajectory]
kind = "fixed"
position_m = [0, 0, 2.5]
[[sensors]]
name = "sonar"
kind = "imaging"
horizontal_deg = 100
beams = 48
samples = 120
range_min_m = 2
range_max_m = 12
tilt_deg = 15
)" + keys;
}

/// The scene, which runs once for all tests.
struct Reference {
  TestFolder folder;
  std::string scene, file, tangent;
  Echoes echoes, equidistant;

  Reference() {
    scene = folder.write("scene.toml", scene_with("")).string();
    const auto run = [&](const std::string& of, const char* name) {
      const std::string out = (folder / name).string();
      const Outcome outcome = run_program({"run", of, "-o", out, "--pictures", "none", "--quiet"});
      if (outcome.exit_code != 0) throw std::runtime_error(outcome.err);
      return out + "/echoes.nc";
    };
    file = run(scene, "even");
    tangent = run(folder.write("tangent.toml", scene_with("spacing = \"distance\"\n")).string(), "tangent");
    echoes = read_echoes(file);
    equidistant = read_echoes(tangent);
  }
};

const Reference& reference() {
  static const Reference made;
  return made;
}

/// A picture whose rows are ranges, the nearest first, and whose columns are beams, port first.
struct Picture {
  std::size_t rows, columns;
  std::vector<double> values;

  explicit Picture(const Echoes& of, double to = 1) : rows(of.samples), columns(of.beams) {
    const double most = *std::ranges::max_element(of.energy);
    for (std::size_t s = 0; s < rows; ++s)
      for (std::size_t b = 0; b < columns; ++b)
        values.push_back(to > 0 ? of.at(0, b, s) / most * to : of.at(0, b, s));
  }
  Picture& flip_beams() {
    for (std::size_t s = 0; s < rows; ++s)
      std::reverse(values.begin() + long(s * columns), values.begin() + long((s + 1) * columns));
    return *this;
  }
  Picture& flip_range() {
    for (std::size_t s = 0; s < rows / 2; ++s)
      std::swap_ranges(values.begin() + long(s * columns), values.begin() + long((s + 1) * columns),
                       values.begin() + long((rows - 1 - s) * columns));
    return *this;
  }
  Picture& turn() {
    std::vector<double> turned;
    for (std::size_t b = 0; b < columns; ++b)
      for (std::size_t s = 0; s < rows; ++s) turned.push_back(values[s * columns + b]);
    values = std::move(turned);
    std::swap(rows, columns);
    return *this;
  }
  template <class Change>
  Picture& each(Change change) {
    for (double& value : values) value = change(value);
    return *this;
  }
  std::string npy(const char* type = "<f8") const { return npy_bytes(type, {rows, columns}, values); }
};

struct Import : testing::Test {
  TestFolder folder;
  std::string out = (folder / "candidate.nc").string();

  Outcome import_file(const std::string& name, const std::string& bytes, const Words& options,
                      const std::string& like = reference().file) const {
    Words words{"import", folder.write(name, bytes).string(), "--like", like, "-o", out};
    words.insert(words.end(), options.begin(), options.end());
    return run_program(words);
  }
  /// Imports without warnings. The energies then agree with the reference except for a gain, to `within`.
  void expect_truth(const std::string& bytes, const Words& options, double within, double gain = 0,
                    const char* name = "picture.npy") const {
    SCOPED_TRACE(fmt::format("{}", fmt::join(options, " ")));
    const Outcome outcome = import_file(name, bytes, options);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, Not(HasSubstr("warning"))) << outcome.out;
    const Echoes candidate = read_echoes(out), &truth = reference().echoes;
    const double scale = gain > 0 ? gain : truth.total() / candidate.total();
    const double most = *std::ranges::max_element(truth.energy);
    ASSERT_EQ(candidate.energy.size(), truth.energy.size());
    for (std::size_t k = 0; k < truth.energy.size(); ++k)
      ASSERT_NEAR(candidate.energy[k] * scale, truth.energy[k], within * most) << k;
    const Outcome compared = run_program({"compare", reference().file, out, "--fit", "gain", "--within",
                                          fmt::format("{}", std::max(1e-9, 60 * within))});
    EXPECT_EQ(compared.exit_code, 0) << compared.out << compared.err;
  }
  std::string refusal(const std::string& bytes, const Words& options,
                      const char* name = "picture.npy") const {
    const Outcome outcome = import_file(name, bytes, options);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
    EXPECT_FALSE(std::filesystem::exists(out));
    EXPECT_FALSE(std::filesystem::exists(folder / "candidate.originals"));
    return outcome.err;
  }
  std::string attribute(const std::string& name) const {
    const WholeEchoFile file = read_whole_echo_file(out);
    for (const auto* list : {&file.attributes, &file.more.at(0).attributes})
      for (const EchoAttribute& a : *list)
        if (a.name == name) return std::get<std::string>(a.value);
    return "none";
  }
};

TEST_F(Import, EnergiesComeBackFromEveryOrder) {
  const Echoes& truth = reference().echoes;
  expect_truth(Picture(truth, 0).npy(), {"--scale", "energy"}, 1e-15, 1);
  EXPECT_EQ(attribute("import_unit"), "J m-2");
  expect_truth(Picture(truth, 0).turn().npy(), {"--scale", "energy"}, 1e-15, 1);
  expect_truth(Picture(truth, 0).flip_beams().npy(), {"--scale", "energy", "--flip-beams"}, 1e-15, 1);
  expect_truth(Picture(truth, 0).flip_range().npy(), {"--scale", "energy", "--flip-range"}, 1e-15, 1);
  expect_truth(Picture(truth, 0).flip_beams().flip_range().turn().npy(">f4"),
               {"--scale", "energy", "--flip-beams", "--flip-range", "--order", "beam-first"}, 1e-7, 1);
}

TEST_F(Import, EnergiesComeBackFromEveryScale) {
  const Echoes& truth = reference().echoes;
  const double most = *std::ranges::max_element(truth.energy);
  expect_truth(Picture(truth, 0).each([](double e) { return std::sqrt(e); }).npy(), {"--scale", "amplitude"},
               1e-14, 1);
  expect_truth(Picture(truth).each([](double e) { return 10 * std::log10(e); }).npy(),
               {"--scale", fmt::format("db:{}", most)}, 1e-12, 1);
  EXPECT_EQ(attribute("import_unit"), "J m-2");
  expect_truth(Picture(truth).each([](double e) { return 10 * std::log10(e); }).npy(), {"--scale", "db"},
               1e-12, most);
  EXPECT_EQ(attribute("import_unit"), "none");
  const Outcome outcome =
      import_file("picture.npy", Picture(truth, 255).each([](double e) { return std::round(e); }).npy("|u1"),
                  {"--scale", "8bit"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("--fit gain"));
  EXPECT_EQ(attribute("arithmetic"), "8 bits, no unit");
  const Echoes bytes = read_echoes(out);
  for (std::size_t k = 0; k < bytes.energy.size(); ++k)
    ASSERT_NEAR(bytes.energy[k], truth.energy[k] / most, 0.5 / 255 + 1e-12);
}

TEST_F(Import, NumbersThatAreNoneOfTheirScaleAreRefused) {
  Picture picture(reference().echoes, 255);
  picture.values[50] = -1;  // row 1, column 2
  EXPECT_THAT(refusal(picture.npy(), {"--scale", "energy"}), HasSubstr("has -1 at row 1, column 2"));
  picture.values[50] = 0.5;
  EXPECT_THAT(refusal(picture.each([](double e) { return std::floor(e) + 0.5; }).npy(), {"--scale", "8bit"}),
              HasSubstr("whole number"));
  picture.values[50] = NAN;
  for (const char* scale : {"energy", "amplitude", "db"})
    EXPECT_THAT(refusal(picture.npy(), {"--scale", scale}), HasSubstr("has nan at row 1, column 2"));
  EXPECT_THAT(refusal(picture.npy(), {"--scale", "loud"}), HasSubstr("--scale 'loud'"));
  EXPECT_THAT(refusal(picture.npy(), {"--scale", "db:-1"}), HasSubstr("db:REFERENCE"));
  EXPECT_THAT(refusal(picture.npy(), {}), HasSubstr("--scale must name the kind"));
}

TEST_F(Import, WrongOrderIsFoundByTheTruth) {
  const Echoes& truth = reference().echoes;
  const auto warned = [&](Picture picture, const std::string& words, Words options = {}) {
    SCOPED_TRACE(words);
    options.insert(options.end(), {"--scale", "energy"});
    const Outcome outcome = import_file("picture.npy", picture.npy(), options);
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("warning: "), HasSubstr(words)));
    EXPECT_THAT(attribute("import_warnings"), HasSubstr(words));
    std::filesystem::remove(out);
    std::filesystem::remove_all(folder / "candidate.originals");
    options.push_back("--strict");
    EXPECT_THAT(refusal(picture.npy(), options), HasSubstr(words));
  };
  warned(Picture(truth).flip_beams(), "mirrored: corr 1.00, compared with");
  warned(Picture(truth).flip_beams(), "use --flip-beams");
  warned(Picture(truth).flip_range(), "use --flip-range");
  warned(Picture(truth).flip_range().flip_beams(), "use --flip-beams --flip-range");
  warned(Picture(truth), "use --no-flip-beams", {"--flip-beams"});
  warned(Picture(truth).each([](double) { return 0; }), "no echoes where the reference has some");
  // Values unrelated to the scene.
  std::size_t k = 0;
  warned(Picture(truth).each([&](double) { return double(++k * 7919 % 101); }), "is it the same scene");
}

TEST_F(Import, AnotherScaleIsReportedAndNeverRefuses) {
  // A mean per bin differs from a sum in the same way as an energy from its square root. The reference
  // cannot decide between them.
  const Echoes& truth = reference().echoes;
  const Picture roots = Picture(truth).each([](double e) { return std::sqrt(e); });
  const Words words = {"--scale", "energy", "--strict"};
  const Outcome outcome = import_file("picture.npy", roots.npy(), words);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("warning: with --scale amplitude the pictures agree better"),
                                 HasSubstr("corr 1.00")));
  EXPECT_THAT(attribute("import_warnings"), HasSubstr("--scale amplitude"));
  EXPECT_THAT(import_file("picture.npy", Picture(truth).npy(), words).err, Not(HasSubstr("--scale")));
  std::filesystem::remove(out);
  std::filesystem::remove_all(folder / "candidate.originals");
  // A wrong order is detected for any scale.
  EXPECT_THAT(refusal(Picture(roots).flip_beams().npy(), words), HasSubstr("use --flip-beams"));
}

TEST_F(Import, AnOutputModelBringsTheReferenceToItsMeasure) {
  // A picture in amplitudes with a correct declaration: with its output model there is no warning, and the
  // output is the same.
  const Picture roots = Picture(reference().echoes).each([](double e) { return std::sqrt(e); });
  const std::string output_model = folder / "recipe.toml";
  std::ofstream(output_model) << "[[steps]]\nstep = \"amplitude\"\n";
  const Outcome without = import_file("picture.npy", roots.npy(), {"--scale", "energy"});
  EXPECT_THAT(without.err, HasSubstr("with --scale amplitude the pictures agree better"));
  const std::vector<double> written = read_echoes(out).energy;
  const Outcome with =
      import_file("picture.npy", roots.npy(), {"--scale", "energy", "--output-model", output_model});
  EXPECT_EQ(with.exit_code, 0);
  EXPECT_THAT(with.err, Not(HasSubstr("warning"))) << with.out;
  EXPECT_THAT(with.out, AllOf(HasSubstr("in the units of"), HasSubstr("corr 1.00")));
  EXPECT_EQ(read_echoes(out).energy, written);
  // The import also detects a wrong order here, and reports an invalid output model.
  EXPECT_THAT(import_file("picture.npy", Picture(roots).flip_beams().npy(),
                          {"--scale", "energy", "--output-model", output_model})
                  .err,
              HasSubstr("use --flip-beams"));
  std::ofstream(output_model) << "[[steps]]\nstep = \"amplify\"\n";
  const Outcome wrong =
      import_file("picture.npy", roots.npy(), {"--scale", "energy", "--output-model", output_model});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("recipe.toml:2"));
}

TEST(ImportBins, ACutHasThePicturesOwnNumbers) {
  // 0 to 1.1 in steps of 0.1, of which 0.3 to 1.1 is requested: edges are equal except for rounding.
  std::vector<double> edges, wanted, values;
  for (int k = 0; k <= 11; ++k) edges.push_back(k * 0.1);
  for (int k = 0; k <= 8; ++k) wanted.push_back(0.3 + k * (1.1 - 0.3) / 8);
  for (int k = 0; k < 11; ++k) values.push_back(std::sqrt(k));
  const Bins beam = bin_intervals({0, 1});
  EXPECT_EQ(rebinned(values, {beam, bin_intervals(edges)}, {beam, bin_intervals(wanted)}),
            std::vector<double>(values.begin() + 3, values.end()));
}

TEST_F(Import, WhatLooksLikeNothingDoesNotHold) {
  std::size_t k = 0;
  Picture picture(reference().echoes);
  picture.each([&](double) { return double(++k * 7919 % 101); });
  const Outcome outcome = import_file("picture.npy", picture.npy(), {"--scale", "energy"});
  EXPECT_THAT(outcome.err, HasSubstr("is it the same scene"));
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("the assumed interpretation: corr "), Not(HasSubstr("holds"))));
}

TEST_F(Import, RangesByTheirEdgesAreFound) {
  // Each bin is half a bin farther: the mean of itself and the previous bin.
  Picture picture(reference().echoes);
  for (std::size_t s = picture.rows - 1; s > 0; --s)
    for (std::size_t b = 0; b < picture.columns; ++b) {
      double& value = picture.values[s * picture.columns + b];
      value = (value + picture.values[(s - 1) * picture.columns + b]) / 2;
    }
  const Outcome outcome = import_file("picture.npy", picture.npy(), {"--scale", "energy"});
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("+0.5"), HasSubstr("edges of bins are used as centres"),
                                 HasSubstr("--ranges 1.9")));
}

TEST_F(Import, EquidistantBeamsAreFound) {
  const Picture picture(reference().equidistant);
  const Outcome wrong = import_file("picture.npy", picture.npy(), {"--scale", "energy"});
  EXPECT_THAT(wrong.err, HasSubstr("--azimuths tangent"));
  // With the declaration, the axes are those of a scene with equidistant beams.
  const Outcome right = import_file("picture.npy", picture.npy(),
                                    {"--scale", "energy", "--azimuths", "tangent"}, reference().tangent);
  EXPECT_EQ(right.exit_code, 0) << right.err;
  EXPECT_THAT(right.err, Not(HasSubstr("warning")));
  // Relative to equiangular beams these are other bins. `compare` rejects them, unless they are resampled.
  const Outcome other =
      import_file("picture.npy", picture.npy(), {"--scale", "energy", "--azimuths", "tangent"});
  EXPECT_THAT(other.err, HasSubstr("'compare' will reject them"));
  EXPECT_EQ(run_program({"compare", reference().file, out}).exit_code, 2);
  const Outcome resampled =
      import_file("picture.npy", picture.npy(), {"--scale", "energy", "--azimuths", "tangent", "--resample"});
  EXPECT_THAT(resampled.out, HasSubstr("resampled"));
  EXPECT_THAT(resampled.err, Not(HasSubstr("tangent")));
  EXPECT_EQ(run_program({"compare", reference().file, out, "--fit", "gain", "--within", "0.35"}).exit_code,
            0);
}

TEST_F(Import, ProfilesHoldOrAreRefuted) {
  const Echoes& truth = reference().echoes;
  const auto amplitude = [](double e) { return std::sqrt(e); };
  expect_truth(Picture(truth).npy("<f4"), {"--profile", "holoocean"}, 1e-6);
  expect_truth(Picture(truth).flip_beams().each(amplitude).npy(), {"--profile", "dave"}, 1e-12);
  expect_truth(Picture(truth).flip_beams().npy(), {"--profile", "oceansim"}, 1e-12);
  EXPECT_EQ(attribute("engine"), "oceansim");
  EXPECT_EQ(attribute("import_unit"), "none");
  expect_truth(Picture(truth).flip_range().npy(), {"--profile", "stonefish", "--azimuths", "even"}, 1e-12);
  const Outcome tangent =
      import_file("picture.npy", Picture(reference().equidistant).flip_range().npy(),
                  {"--profile", "stonefish", "--azimuths", "tangent"}, reference().tangent);
  EXPECT_THAT(tangent.err, Not(HasSubstr("warning")));
  EXPECT_EQ(run_program({"compare", reference().tangent, out, "--fit", "gain", "--within", "1e-9"}).exit_code,
            0);
  const auto refuted = [&](const char* profile, const std::string& bytes, const std::string& words) {
    const Outcome outcome = import_file("picture.npy", bytes, {"--profile", profile});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(words)) << profile;
  };
  refuted("holoocean", Picture(truth).flip_beams().npy(), "use --flip-beams");
  refuted("dave", Picture(truth).each(amplitude).npy(), "use --no-flip-beams");
  refuted("oceansim", Picture(truth).npy(), "use --no-flip-beams");
  refuted("stonefish", Picture(reference().equidistant).npy(), "use --no-flip-range");
  EXPECT_THAT(run_program({"import", "x", "--like", reference().file, "-o", out, "--profile", "other"}).err,
              HasSubstr("holoocean"));
}

TEST_F(Import, TablesAndPointsOfProfiles) {
  const Echoes& truth = reference().echoes;
  const double most = *std::ranges::max_element(truth.energy);
  std::string csv = "# First column is range vector\n";
  std::vector<double> points;
  for (std::size_t s = 0; s < truth.samples; ++s) {
    csv += fmt::format("{}", truth.slant_range_m[s]);
    for (std::size_t b = 0; b < truth.beams; ++b) {
      const double amplitude = std::sqrt(truth.at(0, b, s) / most);
      csv += fmt::format(",{}{:+}i", 0.6 * amplitude, -0.8 * amplitude);
    }
    csv += "\n";
    for (std::size_t b = truth.beams; b-- > 0;) {  // from starboard, by near edges
      const double angle = std::numbers::pi / 2 - truth.beam_azimuth_deg[b] * std::numbers::pi / 180;
      const double range = truth.first_m(s);
      points.insert(points.end(),
                    {range * std::cos(angle), range * std::sin(angle), truth.at(0, b, s) / most});
    }
  }
  expect_truth(csv, {"--profile", "dave"}, 1e-9, 0, "SonarRawData_000001.csv");
  expect_truth(npy_bytes("<f8", {truth.samples, truth.beams, 3}, points), {"--profile", "oceansim"}, 1e-12);
}

TEST_F(Import, AFanInPixelsComesBack) {
  // Pixels smaller than most bins.
  const Echoes& truth = reference().echoes;
  const double far = 12, pixel = 0.02, half = 50 * std::numbers::pi / 180;
  const auto columns = static_cast<std::size_t>(std::round(2 * far * std::sin(half) / pixel));
  const auto rows = static_cast<std::size_t>(std::round(far / pixel));
  std::vector<double> up(rows * columns, 0);
  const double most = *std::ranges::max_element(truth.energy);
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t column = 0; column < columns; ++column) {
      const double x = (double(column) + 0.5 - double(columns) / 2) * pixel,
                   y = far - (double(row) + 0.5) * pixel;
      const double azimuth = std::atan2(x, y), range = std::hypot(x, y);
      const auto beam = std::floor((azimuth + half) / (2 * half) * double(truth.beams)),
                 sample = std::floor((range - 2) / 10 * double(truth.samples));
      if (beam >= 0 && beam < double(truth.beams) && sample >= 0 && sample < double(truth.samples))
        up[row * columns + column] = truth.at(0, std::size_t(beam), std::size_t(sample)) / most;
    }
  const std::string bytes = npy_bytes("<f4", {rows, columns}, up);
  const auto l1 = [&](const Words& options) {
    const Outcome outcome = import_file("fan.npy", bytes, options);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("resampled onto 48 beams x 120 samples"));
    const Echoes candidate = read_echoes(out);
    double off = 0;
    for (std::size_t k = 0; k < truth.energy.size(); ++k)
      off += std::abs(candidate.energy[k] * most - truth.energy[k]);
    return off / truth.total();
  };
  EXPECT_LT(l1({"--scale", "energy", "--cartesian", "fan"}), 0.06);
  EXPECT_LT(
      l1({"--scale", "energy", "--cartesian", fmt::format("{}:{}:{}", double(columns) / 2, rows, pixel)}),
      0.06);
  EXPECT_GT(l1({"--scale", "energy", "--cartesian",
                fmt::format("{}:{}:{}", double(columns) / 2 + 15, rows, pixel)}),
            0.2);
  // Rotated so that ahead is left, or right.
  std::vector<double> left, right;
  for (std::size_t row = 0; row < columns; ++row)
    for (std::size_t column = 0; column < rows; ++column) {
      left.push_back(up[column * columns + columns - 1 - row]);
      right.push_back(up[(rows - 1 - column) * columns + row]);
    }
  for (const auto& [forward, turned] : {std::pair("left", left), std::pair("right", right)}) {
    const Outcome outcome = import_file("fan.npy", npy_bytes("<f4", {columns, rows}, turned),
                                        {"--scale", "energy", "--cartesian", "fan", "--forward", forward});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, Not(HasSubstr("warning"))) << forward;
  }
  std::ranges::reverse(up);
  const Outcome down = import_file("fan.npy", npy_bytes("<f4", {rows, columns}, up),
                                   {"--scale", "energy", "--cartesian", "fan"});
  EXPECT_THAT(down.err, HasSubstr("use --forward down"));
  std::filesystem::remove(out);
  std::filesystem::remove_all(folder / "candidate.originals");
  EXPECT_THAT(refusal(npy_bytes("<f4", {rows / 2, columns}, std::vector<double>(rows / 2 * columns, 1)),
                      {"--scale", "energy", "--cartesian", "fan"}),
              HasSubstr("give COLUMN:ROW:METRES"));
  EXPECT_THAT(refusal(bytes, {"--scale", "energy", "--cartesian", "1:2"}), HasSubstr("--cartesian '1:2'"));
}

TEST_F(Import, OriginalsAreKeptByTheirHash) {
  const std::string bytes = Picture(reference().echoes).npy();
  ASSERT_EQ(import_file("picture.npy", bytes, {"--profile", "holoocean"}).exit_code, 0);
  Sha256 hash;
  hash.update(bytes);
  const std::string name = hash.hex_digest();
  EXPECT_EQ(bytes_of(folder / "candidate.originals" / (name + ".npy")), bytes);
  EXPECT_EQ(bytes_of(folder / "candidate.originals" / "list.txt"), name + "  picture.npy\n");
  EXPECT_EQ(attribute("import_originals"), name + "  picture.npy\n");
  EXPECT_THAT(attribute("import_options"), HasSubstr("--profile holoocean"));
  // Imports the kept originals again with the kept options.
  const Echoes first = read_echoes(out);
  const std::string again = (folder / "again.nc").string();
  ASSERT_EQ(run_program({"import", (folder / "candidate.originals" / (name + ".npy")).string(), "--like",
                         reference().file, "-o", again, "--profile", "holoocean"})
                .exit_code,
            0);
  EXPECT_EQ(read_echoes(again).energy, first.energy);
  EXPECT_EQ(read_echoes(again).beam_azimuth_deg, reference().echoes.beam_azimuth_deg);
}

TEST_F(Import, AzimuthsOfAListAreKeptToo) {
  std::string list = "azimuth_deg\n";
  for (const double azimuth : reference().echoes.beam_azimuth_deg) list += fmt::format("{}\n", azimuth);
  const std::string csv = folder.write("beams.csv", list).string();
  expect_truth(Picture(reference().echoes, 0).npy(), {"--scale", "energy", "--azimuths", csv}, 1e-15, 1);
  EXPECT_THAT(bytes_of(folder / "candidate.originals" / "list.txt"),
              AllOf(HasSubstr("  picture.npy\n"), HasSubstr("  beams.csv\n")));
  std::filesystem::remove(out);
  std::filesystem::remove_all(folder / "candidate.originals");
  folder.write("beams.csv", "azimuth_deg\n3\n2\n");
  EXPECT_THAT(refusal(Picture(reference().echoes, 0).npy(), {"--scale", "energy", "--azimuths", csv}),
              HasSubstr("beams.csv:3:1: azimuths must increase"));
}

TEST_F(Import, SeveralPicturesAreFramesOfAPing) {
  Picture picture(reference().echoes, 0);
  folder.write("f10.npy", picture.npy());
  const Words like{"--like", reference().file, "-o", out, "--scale", "energy"};
  Words words{"import", (folder / "f10.npy").string(),
              folder.write("f9.npy", picture.each([](double e) { return 3 * e; }).npy()).string()};
  words.insert(words.end(), like.begin(), like.end());
  const Outcome outcome = run_program(words);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("--frames 2"));
  const Echoes candidate = read_echoes(out), &truth = reference().echoes;
  ASSERT_EQ(candidate.pings, 2u);
  const std::size_t bins = truth.energy.size();
  for (std::size_t k = 0; k < bins; ++k) {
    ASSERT_DOUBLE_EQ(candidate.energy[k], 3 * truth.energy[k]);  // frame 9 comes before frame 10
    ASSERT_DOUBLE_EQ(candidate.energy[bins + k], truth.energy[k]);
  }
}

TEST_F(Import, BothSidesOfASidescanInOneRow) {
  // The minimal reference: no names and no poses. Energies of three pings follow a rule that no flip
  // preserves.
  ForeignGroup group;
  group.dimensions = {{"ping", 3}, {"beam", 2}, {"sample", 40}};
  std::vector<double> energies, ranges;
  for (int k = 0; k < 3 * 2 * 40; ++k) energies.push_back(1e-9 * (1 + k * 7919 % 101));
  for (int k = 0; k < 40; ++k) ranges.push_back(5 + 0.5 * k);
  group.variables = {{"energy", {{"ping", "beam", "sample"}, "J", energies}},
                     {"slant_range", {{"sample"}, "m", ranges}},
                     {"beam_azimuth", {{"beam"}, "degree", {-90, 90}}}};
  const std::string like = write_foreign(folder / "sides.nc", group).string();
  std::vector<double> rows;
  for (std::size_t ping = 0; ping < 3; ++ping) {
    for (std::size_t s = 40; s-- > 0;) rows.push_back(energies[(2 * ping) * 40 + s]);
    for (std::size_t s = 0; s < 40; ++s) rows.push_back(energies[(2 * ping + 1) * 40 + s]);
  }
  const Outcome outcome = import_file("rows.npy", npy_bytes("<f8", {3, 80}, rows),
                                      {"--scale", "energy", "--order", "two-sided"}, like);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, Not(HasSubstr("warning")));
  EXPECT_EQ(read_echo_file(out).sensors.at(0).energy, energies);
  EXPECT_EQ(run_program({"compare", like, out, "--within", "0"}).exit_code, 0);
  const Outcome swapped = import_file("rows.npy", npy_bytes("<f8", {3, 80}, rows),
                                      {"--scale", "energy", "--order", "two-sided", "--flip-beams"}, like);
  EXPECT_THAT(swapped.err, HasSubstr("use --no-flip-beams"));
}

TEST_F(Import, ASceneIsRunForItsTruth) {
  const Outcome outcome = run_program(
      {"import", folder.write("picture.npy", Picture(reference().echoes).flip_beams().npy()).string(),
       "--scene", reference().scene, "--profile", "holoocean", "-o", out});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("mirrored: corr 1.00"));
  EXPECT_EQ(run_program({"compare", reference().file, out}).exit_code, 0) << "of the same scene_hash";
}

TEST_F(Import, WhatCannotBeIsRefused) {
  const std::string picture = Picture(reference().echoes).npy();
  const Outcome none = run_program({"import", folder.write("p.npy", picture).string(), "-o", out});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, HasSubstr("--like"));
  EXPECT_THAT(refusal(npy_bytes("<f8", {7, 5}, std::vector<double>(35, 1)), {"--scale", "energy"}),
              HasSubstr("--order"));
  EXPECT_THAT(refusal(npy_bytes("<f8", {7, 5}, std::vector<double>(35, 1)),
                      {"--scale", "energy", "--order", "range-first"}),
              HasSubstr("--azimuths"));
  EXPECT_THAT(refusal(npy_bytes("<f8", {7, 48}, std::vector<double>(7 * 48, 1)),
                      {"--scale", "energy", "--order", "range-first"}),
              AllOf(HasSubstr("--ranges"), HasSubstr("2 to 12 m")));
  EXPECT_THAT(refusal(picture, {"--scale", "energy", "--ranges", "5:2"}), HasSubstr("--ranges '5:2'"));
  EXPECT_THAT(refusal(picture, {"--scale", "energy", "--azimuths", "x"}), HasSubstr("--azimuths 'x'"));
  EXPECT_THAT(refusal(picture, {"--scale", "energy", "--sensor", "other"}), HasSubstr("no sensor 'other'"));
  EXPECT_THAT(refusal("", {"--scale", "energy"}), HasSubstr("contains no numbers"));
  const Outcome onto_itself =
      run_program({"import", folder.write("own.nc", "x").string(), "--like", reference().file, "-o",
                   (folder / "own.nc").string(), "--scale", "energy"});
  EXPECT_EQ(onto_itself.exit_code, 2);
  EXPECT_EQ(bytes_of(folder / "own.nc"), "x");
}

}  // namespace
}  // namespace tubefoot
