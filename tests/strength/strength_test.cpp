// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the command `strength`: its options, its files with and without bounds, its warnings, and rejected
// input.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netcdf.h>

#include <cmath>
#include <complex>
#include <fstream>
#include <limits>
#include <sstream>

#include "files/input_error.hpp"
#include "files/usage_error.hpp"
#include "fixtures/program.hpp"
#include "fixtures/test_folder.hpp"
#include "scene/meshes/primitives.hpp"
#include "strength/strength_comparison.hpp"
#include "strength/strength_output.hpp"
#include "strength/strength_request.hpp"
#include "strength/strength_table.hpp"

namespace tubefoot {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const StrengthRequest request{{0, 45, 90}, {-10, 10}, {1e4, 2e4, 4e4}, 1500, {}, "rigid"};

std::string refusal(const std::function<void()>& task) {
  try {
    task();
  } catch (const UsageError& error) {
    return error.what();
  }
  return "nothing was refused";
}

TEST(StrengthRequest, RangesAndLists) {
  EXPECT_THAT(angles_of("0:90:30", "--azimuths"), ElementsAre(0, 30, 60, 90));
  EXPECT_THAT(angles_of("-1:1", "--azimuths"), ElementsAre(-1, 0, 1));
  EXPECT_THAT(angles_of("5", "--azimuths"), ElementsAre(5));
  EXPECT_EQ(angles_of("0:360:0.1", "--azimuths").size(), 3601U);
  EXPECT_THAT(frequencies_of("38kHz,0.12MHz,200e3,300000Hz"), ElementsAre(38e3, 120e3, 200e3, 300e3));
  EXPECT_THAT(frequencies_of("10kHz:30kHz:10kHz"), ElementsAre(10e3, 20e3, 30e3));
}

TEST(StrengthRequest, SaysWhatIsWrong) {
  for (const char* wrong : {"", "a", "1,,2", "2,1", "1,1", "0:10:0", "0:10:-1", "10:0:1", "1:2:3:4",
                            "0:1e9:1e-3", "nan", "inf", "1e999"})
    EXPECT_THAT(refusal([&] { angles_of(wrong, "--azimuths"); }),
                AllOf(HasSubstr("--azimuths"), HasSubstr("expected FIRST:LAST:STEP")))
        << wrong;
  for (const char* wrong :
       {"0", "-5", "38khz", "kHz", "1kHz:2kHz", "0:10:1", "1e305MHz", "1e305MHz:1e305MHz:1Hz"})
    EXPECT_THAT(refusal([&] { frequencies_of(wrong); }), AllOf(HasSubstr("--frequencies"), HasSubstr("Hz")))
        << wrong;
  for (const char* wrong :
       {"", "hard", "2", "-1.5", "nan", "fluid", "fluid:2", "fluid:0:1", "fluid:2:1:-1", "fluid:2:1:1:1"})
    EXPECT_THAT(refusal([&] { surface_of(wrong, 0); }), HasSubstr("expected rigid, soft")) << wrong;
  EXPECT_EQ(surface_of("soft", 0).reflection, -1.0);
  EXPECT_EQ(surface_of("0.5", 0.01).reflection, 0.5);
  EXPECT_EQ(surface_of("0.5", 0.01).roughness_m, 0.01);
  EXPECT_EQ(surface_of("fluid:2:1.1", 0).fluid->density_ratio, 2);
}

TEST(StrengthWarnings, OpenCrowdedAndCoarse) {
  ComponentMesh sphere = sphere_facets({0.5}, 5e-3, {});
  EXPECT_THAT(warnings_of(sphere, 1e3, 1500), IsEmpty());
  EXPECT_THAT(too_small_for(box_facets({{1, 1, 1}}, {}), 500, 1500).value_or(""),
              HasSubstr("0.58 wavelengths across at 500 Hz"));
  EXPECT_FALSE(too_small_for(box_facets({{1, 1, 1}}, {}), 1000, 1500));
  EXPECT_THAT(warnings_of(sphere, 100e3, 1500), ElementsAre(HasSubstr("deviate from a curved surface")));
  EXPECT_THAT(warnings_of(box_facets({{1, 1, 1}}, {}), 1e6, 1500), IsEmpty());
  sphere.triangles.pop_back();
  EXPECT_THAT(warnings_of(sphere, 1e3, 1500), ElementsAre(HasSubstr("the mesh is open: 3 of its")));
  ComponentMesh box = box_facets({{1, 1, 1}}, {});
  box.triangles.push_back(box.triangles[0]);
  EXPECT_THAT(warnings_of(box, 1e3, 1500), ElementsAre(HasSubstr("belong to more than two facets")));
  EXPECT_THAT(warnings_of(box_facets({{100, 10, 10}}, {}), 10e6, 1500),
              ElementsAre(HasSubstr("phase errors")));
  // The result is the same for formats that repeat corners for each facet.
  ComponentMesh random_triangles;
  for (const auto& t : box_facets({{1, 1, 1}}, {}).triangles) {
    const auto n = static_cast<std::uint32_t>(random_triangles.points_m.size());
    for (const std::uint32_t corner : t) random_triangles.points_m.push_back(box.points_m[corner]);
    random_triangles.triangles.push_back({n, n + 1, n + 2});
  }
  EXPECT_THAT(warnings_of(random_triangles, 1e6, 1500), IsEmpty());
}

// Each direction and frequency has its own number, in both files.
TEST(StrengthFiles, HoldTheTable) {
  const TestFolder folder;
  const StrengthTable table = strength_of(box_facets({{1, 2, 3}}, {}), "box.obj", request, true);
  ASSERT_EQ(table.length_m.size(), 18U);
  EXPECT_NEAR(table.silhouette_m2[0], std::cos(std::acos(-1) / 18) * 6 + std::sin(std::acos(-1) / 18) * 2,
              1e-6);
  std::istringstream lines(to_csv(table));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(
      line,
      "elevation_deg,azimuth_deg,frequency_hz,target_strength_db,length_re_m,length_im_m,silhouette_m2");
  std::size_t rows = 0;
  for (; std::getline(lines, line); ++rows) {
    double e = 0, a = 0, f = 0, db = 0, re = 0, im = 0, area = 0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf,%lf", &e, &a, &f, &db, &re, &im, &area), 7);
    EXPECT_EQ(e, request.elevations_deg[rows / 9]);
    EXPECT_EQ(a, request.azimuths_deg[rows / 3 % 3]);
    EXPECT_EQ(f, request.frequencies_hz[rows % 3]);
    EXPECT_NEAR(db, 10 * std::log10(re * re + im * im), 1e-5);
    EXPECT_NEAR(re, table.length_m[rows].real(), 1e-8);
  }
  EXPECT_EQ(rows, 18U);
  const std::filesystem::path file = folder / "strength.nc";
  write_netcdf(table, file);
  int id = 0, variable = 0;
  ASSERT_EQ(nc_open(file.c_str(), NC_NOWRITE, &id), NC_NOERR);
  ASSERT_EQ(nc_inq_varid(id, "length_im", &variable), NC_NOERR);
  std::vector<double> imaginary(18);
  ASSERT_EQ(nc_get_var_double(id, variable, imaginary.data()), NC_NOERR);
  for (std::size_t k = 0; k < 18; ++k) EXPECT_EQ(imaginary[k], table.length_m[k].imag());
  nc_close(id);
  write_picture(table, folder / "map.png");
  EXPECT_GT(std::filesystem::file_size(folder / "map.png"), 1000U);
}

// Both files contain the bounds next to the numbers, and results in doubles lie within them.
TEST(StrengthFiles, HoldBounds) {
  const TestFolder folder;
  StrengthRequest certified = request;
  certified.tolerance = 1e-3;
  const ComponentMesh box = box_facets({{1, 2, 3}}, {});
  const StrengthTable table = strength_of(box, "box.obj", certified, true),
                      doubles = strength_of(box, "box.obj", request, true);
  ASSERT_EQ(table.bound_m.size(), 18U);
  EXPECT_FALSE(doubles.certified());
  std::istringstream lines(to_csv(table));
  std::string line;
  std::getline(lines, line);
  EXPECT_THAT(line, testing::EndsWith(",silhouette_m2,length_bound_m,target_strength_bound_db"));
  for (std::size_t k = 0; k < 18; ++k) {
    EXPECT_LE(std::abs(table.length_m[k] - doubles.length_m[k]), table.bound_m[k]);
    EXPECT_GT(table.bound_m[k], 0);
    ASSERT_TRUE(std::getline(lines, line));
    double e = 0, a = 0, f = 0, db = 0, re = 0, im = 0, area = 0, bound = 0, bound_db = 0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf", &e, &a, &f, &db, &re, &im,
                          &area, &bound, &bound_db),
              9);
    // All digits: writing loses nothing of the bound.
    EXPECT_EQ(std::complex(re, im), table.length_m[k]);
    EXPECT_EQ(bound, table.bound_m[k]);
    EXPECT_NEAR(bound_db, -20 * std::log10(1 - bound / std::hypot(re, im)), 1e-9);
    EXPECT_NEAR(db, 20 * std::log10(std::hypot(re, im)), 1e-12);
  }
  const auto read = [](const std::filesystem::path& file, const char* name) {
    int id = 0, variable = 0;
    EXPECT_EQ(nc_open(file.c_str(), NC_NOWRITE, &id), NC_NOERR);
    std::vector<double> values;
    if (nc_inq_varid(id, name, &variable) == NC_NOERR) {
      values.resize(18);
      EXPECT_EQ(nc_get_var_double(id, variable, values.data()), NC_NOERR) << name;
    }
    nc_close(id);
    return values;
  };
  write_netcdf(table, folder / "strength.nc");
  EXPECT_EQ(read(folder / "strength.nc", "length_bound"), table.bound_m);
  EXPECT_EQ(read(folder / "strength.nc", "length_grid_bound"), table.grid_bound_m);
  const std::vector<double> bound_db = read(folder / "strength.nc", "target_strength_bound");
  ASSERT_EQ(bound_db.size(), 18U);
  for (const double bound : bound_db) EXPECT_GT(bound, 0);
  write_netcdf(doubles, folder / "doubles.nc");
  EXPECT_TRUE(read(folder / "doubles.nc", "length_bound").empty());
}

// A bound is relative to the length, or to the floor if the floor is higher.
TEST(StrengthBounds, AreHeldAgainstTheTolerance) {
  StrengthTable table{request, "box.obj", {}, {}};
  table.request.azimuths_deg = {0, 90};
  table.request.elevations_deg = {5};
  table.request.frequencies_hz = {1e3, 2e3};
  table.request.tolerance = 0.01;
  using Length = std::complex<double>;
  table.length_m = {100, Length(0, 1), Length(0, 1e-4), 2};
  table.bound_m = {0.5, 0.002, 0.0009, 0.02};
  table.grid_bound_m = {0.25, 0.001, 0.0009, 0.01};
  BoundsHeld held = bounds_held(table);
  EXPECT_EQ(held.over, 0U);
  EXPECT_NEAR(held.worst_ratio, 1, 1e-12);  // of 2
  EXPECT_EQ(held.most_m, 0.5);
  EXPECT_EQ(held.most_grid, 1);
  EXPECT_THAT(in_words(held, table), HasSubstr("each bound is at most 0.01 times the length"));
  // 1e-4 counts as 0.1, of which 0.01 is 0.001.
  table.bound_m[2] = 0.003;
  table.bound_m[1] = 0.011;
  held = bounds_held(table);
  EXPECT_EQ(held.over, 2U);
  EXPECT_NEAR(held.worst_ratio, 3, 1e-12);
  EXPECT_THAT(in_words(held, table),
              HasSubstr("2 of 4 lengths have bounds wider than 0.01; the widest is 3 "
                        "times the requested bound, at elevation 5, azimuth 90, 1000 Hz"));
  table.bound_m[3] = std::numeric_limits<double>::infinity();
  EXPECT_THAT(in_words(bounds_held(table), table), HasSubstr("the widest is inf times"));
  // A direction without echo and without open samples does not count.
  table.length_m.assign(4, 0);
  table.bound_m.assign(4, 0);
  EXPECT_EQ(bounds_held(table).over, 0U);
}

TEST(StrengthCommand, WritesAFolderAndRefusesWhatIsWrong) {
  const TestFolder folder;
  const std::filesystem::path mesh = folder / "plate.obj";
  std::ofstream(mesh) << "v -0.05 -0.03 0\nv 0.05 -0.03 0\nv 0.05 0.03 0\nv -0.05 0.03 0\nf 1 2 3 4\n";
  const auto run = [&](const std::string& rest) {
    std::vector<std::string> arguments{"strength", mesh.string()};
    std::istringstream words(rest);
    for (std::string word; words >> word;) arguments.push_back(word);
    return run_program(arguments);
  };
  const auto good = run("--frequencies 100kHz --elevations 90 --azimuths 0 -o " + (folder / "out").string());
  EXPECT_EQ(good.exit_code, 0) << good.err;
  EXPECT_THAT(good.out, HasSubstr("strength       -7.96 to -7.96 dB re 1 m2"));
  EXPECT_THAT(good.err, HasSubstr("the mesh is open"));
  for (const char* name : {"strength.csv", "strength.nc", "strength.png"})
    EXPECT_TRUE(std::filesystem::exists(folder / "out" / name)) << name;
  // In millimetres it is a millionth of the area.
  const auto small = run("--frequencies 100kHz --elevations 90 --azimuths 0 --unit 1e-3 -o " +
                         (folder / "small.csv").string());
  EXPECT_THAT(small.out, HasSubstr("-127.96"));
  EXPECT_EQ(run("--frequencies 100kHz --elevations 91 -o " + (folder / "x.csv").string()).exit_code, 2);
  EXPECT_EQ(run("--frequencies 100kHz -o " + (folder / "x.txt").string()).exit_code, 2);
  EXPECT_EQ(run("--frequencies 100kHz -o " + mesh.string()).exit_code, 2);
  EXPECT_EQ(run("-o " + (folder / "x.csv").string()).exit_code, 2);
  EXPECT_EQ(run("--frequencies 1:1e5:1 --azimuths 0:359:0.1 -o " + (folder / "x.csv").string()).exit_code, 2);
  // Numbers out of range, and invalid directions.
  for (const char* wrong :
       {"--frequencies 1e300", "--frequencies 1e-300", "--frequencies 1kHz --sound-speed 1e-300",
        "--frequencies 1kHz --azimuths 1e18", "--frequencies 1kHz --azimuths -400:0:10"}) {
    const auto outcome = run(std::string(wrong) + " -o " + (folder / "x.csv").string());
    EXPECT_EQ(outcome.exit_code, 2) << wrong;
    EXPECT_THAT(outcome.err, testing::AnyOf(HasSubstr("wavelength"), HasSubstr("-360 to 360"))) << wrong;
  }
  // A mesh without visible facets is reported.
  const std::filesystem::path line = folder.write("line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  EXPECT_THAT(
      run_program({"strength", line.string(), "--frequencies", "10kHz", "-o", (folder / "line.csv").string()})
          .err,
      HasSubstr("no facet is visible"));
  EXPECT_THAT(
      run("--frequencies 100kHz --elevations 0 --azimuths 0 -o " + (folder / "edge.csv").string()).err,
      HasSubstr("no facet is visible"));
  EXPECT_THAT(good.err, testing::Not(HasSubstr("no facet is visible")));
  // Certified results that keep the tolerance and that do not.
  const std::string plate = "--frequencies 100kHz --elevations 90 --azimuths 0 --reference ";
  const auto kept = run(plate + "-o " + (folder / "kept.csv").string());
  EXPECT_EQ(kept.exit_code, 0) << kept.err;
  EXPECT_THAT(kept.out, AllOf(HasSubstr("reference: certified; each bound is at most 0.001 times the length"),
                              HasSubstr("bounds")));
  EXPECT_THAT(run(plate + "--tolerance 1e-12 -o " + (folder / "wide.csv").string()).out,
              HasSubstr("1 of 1 lengths have bounds wider than 1e-12"));
  for (const char* wrong : {"1", "1e-13", "nan", "0.1dB"})
    EXPECT_EQ(run(plate + "--tolerance " + wrong + " -o " + (folder / "x.csv").string()).exit_code, 2)
        << wrong;
  EXPECT_EQ(
      run("--frequencies 100kHz --azimuths 0 --tolerance 1e-3 -o " + (folder / "x.csv").string()).exit_code,
      2);
  const std::filesystem::path point = folder.write("point.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n");
  const auto none =
      run_program({"strength", point.string(), "--frequencies", "1kHz", "-o", (folder / "x.csv").string()});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, HasSubstr("point.obj"));
  EXPECT_FALSE(std::filesystem::exists(folder / "x.csv"));
}

// Values of the file appear at their directions and frequencies, and differences follow from them.
TEST(StrengthComparison, AssignsRowsToDirections) {
  const TestFolder folder;
  const std::filesystem::path file = folder.write(
      "other.csv",
      "frequency_hz,azimuth_deg,target_strength_db\n10000,0,-3\n10000,360.0000001,-4\n20000,0,-5\n");
  const auto read = [&](const std::filesystem::path& from, const StrengthRequest& requested) {
    try {
      read_comparison(from, requested);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("nothing was refused");
  };
  EXPECT_THAT(read(file, request), HasSubstr("other.csv: no row has a requested direction and frequency"));
  StrengthRequest level{{-90, 0, 90, 270}, {0}, {1e4, 4e4}, 1500, {}, "rigid"};
  EXPECT_THAT(read(file, level), AllOf(HasSubstr("other.csv:3:"), HasSubstr("second value for elevation 0")));
  const std::filesystem::path good = folder.write(
      "good.csv",
      "elevation_deg,azimuth_deg,frequency_hz,target_strength_db\n0,0,1e4,-3\n0,270,1e4,-6\n5,0,1e4,-9\n");
  const StrengthComparison comparison = read_comparison(good, level);
  ASSERT_EQ(comparison.strength_db.size(), 8U);
  EXPECT_EQ(comparison.name, "good.csv");
  EXPECT_EQ(comparison.strength_db[0], -6);  // -90 is 270 degrees
  EXPECT_EQ(comparison.strength_db[2], -3);
  EXPECT_EQ(comparison.strength_db[6], -6);
  for (const std::size_t k : {1U, 3U, 4U, 5U, 7U}) EXPECT_TRUE(std::isnan(comparison.strength_db[k])) << k;
  for (const char* wrong :
       {"", "azimuth_deg,frequency_hz\n0,1e4\n", "azimuth_deg,frequency_hz,target_strength_db\n0,1e4,nan\n",
        "azimuth_deg,frequency_hz,target_strength_db\n0,x,1\n"})
    EXPECT_THAT(read(folder.write("wrong.csv", wrong), level), HasSubstr("wrong.csv")) << wrong;
}

TEST(StrengthComparison, SummarisesDifferences) {
  StrengthTable table{request, "box.obj", {}, {}};
  table.request.azimuths_deg = {0, 90, 180};
  table.request.elevations_deg = {5};
  table.request.frequencies_hz = {1e3, 2e3};
  using Length = std::complex<double>;
  table.length_m = {1, 1, Length(0, 10), 1, 0.1, 1};
  table.silhouette_m2 = {1, 1, 1};
  const double none = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(difference_db(table, 0, 0, 0)));
  table.comparison = StrengthComparison{"other.csv", {-1, none, 22, none, -20, none}};
  EXPECT_NEAR(difference_db(table, 0, 1, 0), -2, 1e-12);
  const std::vector<StrengthDifference> differences = differences_of(table);
  ASSERT_EQ(differences.size(), 2U);
  EXPECT_EQ(differences[0].directions, 3U);
  EXPECT_NEAR(differences[0].median_db, 1, 1e-12);
  EXPECT_NEAR(differences[0].largest_db, 2, 1e-12);
  EXPECT_EQ(differences[0].largest_azimuth, 1U);
  EXPECT_NEAR(differences[0].mean_db,
              10 * std::log10(101.01 / (std::pow(10, -0.1) + std::pow(10, 2.2) + 0.01)), 1e-12);
  EXPECT_EQ(differences[1].directions, 0U);
  EXPECT_THAT(in_words(differences, table), AllOf(HasSubstr("1000 Hz: 3 directions, median 1.00 dB"),
                                                  HasSubstr("largest 2.00 dB at elevation 5, azimuth 90"),
                                                  HasSubstr("2000 Hz: the file has no value")));
  const std::string csv = to_csv(table);
  EXPECT_THAT(csv, HasSubstr(",compared_strength_db,difference_db\n"));
  EXPECT_THAT(csv, HasSubstr(",22.000000,-2.000000\n"));
  EXPECT_THAT(csv, HasSubstr(",,\n"));
  const TestFolder folder;
  write_netcdf(table, folder / "compared.nc");
  int id = 0, variable = 0;
  ASSERT_EQ(nc_open((folder / "compared.nc").c_str(), NC_NOWRITE, &id), NC_NOERR);
  std::vector<double> compared(6);
  ASSERT_EQ(nc_inq_varid(id, "compared_strength", &variable), NC_NOERR);
  EXPECT_EQ(nc_get_var_double(id, variable, compared.data()), NC_NOERR);
  nc_close(id);
  EXPECT_EQ(compared[2], 22);
  EXPECT_TRUE(std::isnan(compared[1]));
}

// The output of the command can be compared with itself. The picture then has two diagrams per frequency.
TEST(StrengthCommand, ComparesWithItsOwnTable) {
  const TestFolder folder;
  const std::filesystem::path mesh = folder / "plate.obj", own = folder / "own.csv",
                              picture = folder / "own.png";
  std::ofstream(mesh) << "v -0.05 -0.03 0\nv 0.05 -0.03 0\nv 0.05 0.03 0\nv -0.05 0.03 0\nf 1 2 3 4\n";
  const auto run = [&](const std::filesystem::path& output, std::vector<std::string> more) {
    std::vector<std::string> arguments{"strength",     mesh.string(), "--frequencies", "100kHz,200kHz",
                                       "--elevations", "60",          "--azimuths",    "0:90:10",
                                       "--quiet",      "-o",          output.string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_program(arguments);
  };
  ASSERT_EQ(run(own, {}).exit_code, 0);
  const auto compared = run(picture, {"--compare", own.string()});
  EXPECT_EQ(compared.exit_code, 0) << compared.err;
  EXPECT_THAT(compared.out,
              HasSubstr("difference     200000 Hz: 10 directions, median 0.00 dB, 90 % below 0.00 dB"));
  const std::string png = bytes_of(picture);
  ASSERT_GT(png.size(), 24U);
  const auto number = [&](std::size_t at) {
    unsigned value = 0;
    for (std::size_t k = 0; k < 4; ++k) value = value << 8 | static_cast<unsigned char>(png[at + k]);
    return value;
  };
  EXPECT_EQ(number(16), 2280U);  // two diagrams of 760 pixels, times 1.5
  EXPECT_EQ(number(20), 1560U);  // one row of 520 pixels per frequency
  // The compared file is an input, which the output may not replace.
  EXPECT_EQ(run(own, {"--compare", own.string()}).exit_code, 2);
  EXPECT_EQ(run(picture, {"--compare", (folder / "none.csv").string()}).exit_code, 2);
}

}  // namespace
}  // namespace tubefoot
