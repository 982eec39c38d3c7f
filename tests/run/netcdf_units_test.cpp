// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the units and conventions that netCDF files claim, with UDUNITS, the library that the CF
// conventions name.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netcdf.h>
#include <udunits2.h>

#include <memory>
#include <set>

#include "fixtures/program.hpp"

namespace tubefoot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr const char* units_scene = R"(
[georeference]
origin_lat_lon_deg = [59.0, 10.0]
[run]
start_utc = "2024-06-01T12:30:00.5Z"
[[materials]]
name = "bed"
[[terrain]]
kind = "flat"
width_m = 60
length_m = 60
centre_m = [0, 0, -12]
[trajectory]
kind = "fixed"
position_m = [0, 0, -2]
[[sensors]]
name = "sonar"
kind = "multibeam"
beams = 5
source_level_db = 210
range_max_m = 20
samples = 100
pings = 2
first_ping_s = 1.25
)";

/// Returns a text attribute, which netCDF stores as characters or as one string.
std::string text_of(int group, int variable, const char* name) {
  nc_type type = NC_NAT;
  std::size_t size = 0;
  if (nc_inq_att(group, variable, name, &type, &size) != NC_NOERR) return "";
  if (type == NC_STRING) {
    char* one = nullptr;
    nc_get_att_string(group, variable, name, &one);
    const std::string text = one;
    nc_free_string(1, &one);
    return text;
  }
  std::string text(size, ' ');
  nc_get_att_text(group, variable, name, text.data());
  return text;
}

class Units {
 public:
  Units() : system_((ut_set_error_message_handler(ut_ignore), ut_read_xml(nullptr)), &ut_free_system) {
    if (!system_) throw std::runtime_error("no database of units");
  }
  bool knows(const std::string& text) const {
    const std::unique_ptr<ut_unit, decltype(&ut_free)> unit(ut_parse(system_.get(), text.c_str(), UT_UTF8),
                                                            &ut_free);
    return unit != nullptr;
  }

 private:
  std::unique_ptr<ut_system, decltype(&ut_free_system)> system_;
};

/// Collects the units of all variables of a group and of its subgroups.
void gather(int group, std::set<std::string>& units) {
  int variables = 0, groups = 0;
  nc_inq_nvars(group, &variables);
  for (int id = 0; id < variables; ++id)
    if (const std::string text = text_of(group, id, "units"); !text.empty()) units.insert(text);
  nc_inq_grps(group, &groups, nullptr);
  std::vector<int> ids(static_cast<std::size_t>(groups));
  nc_inq_grps(group, nullptr, ids.data());
  for (const int id : ids) gather(id, units);
}

class NetcdfFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder.write("scene.toml", units_scene);
    const Outcome ran =
        run_program({"run", (folder / "scene.toml").string(), "-o", (folder / "out").string(), "--quiet"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const Outcome traced = run_program({"footprints", (folder / "scene.toml").string(), "--sensor", "sonar",
                                        "-o", (folder / "footprints.nc").string(), "--quiet"});
    ASSERT_EQ(traced.exit_code, 0) << traced.err;
  }
  /// Returns the units that UDUNITS does not know.
  std::set<std::string> unknown_units(const std::filesystem::path& path, std::string* conventions = nullptr) {
    int file = -1;
    if (nc_open(path.c_str(), NC_NOWRITE, &file) != NC_NOERR) throw std::runtime_error("no " + path.string());
    std::set<std::string> units;
    gather(file, units);
    if (conventions != nullptr) *conventions = text_of(file, NC_GLOBAL, "Conventions");
    nc_close(file);
    EXPECT_GE(units.size(), 2u);
    std::erase_if(units, [this](const std::string& text) { return known.knows(text); });
    return units;
  }
  TestFolder folder;
  Units known;
};

TEST_F(NetcdfFiles, ThatClaimCfHaveUnitsThatItsLibraryKnows) {
  std::string conventions;
  EXPECT_THAT(unknown_units(folder / "footprints.nc", &conventions), IsEmpty());
  EXPECT_EQ(conventions, "CF-1.8");
  EXPECT_THAT(unknown_units(folder / "out/echoes.nc"), IsEmpty());
  // SONAR-netCDF4 requires decibels, which UDUNITS does not know. A file with decibels does not claim CF.
  EXPECT_THAT(unknown_units(folder / "out/sonar-sonar.nc", &conventions), ElementsAre("dB", "dB/km", "dB/m"));
  EXPECT_THAT(conventions, HasSubstr("SONAR-netCDF4-2.0"));
  EXPECT_THAT(conventions, Not(HasSubstr("CF-")));
}

TEST_F(NetcdfFiles, EchoesSayWhenAndWhereTheyWereReceived) {
  int file = -1;
  ASSERT_EQ(nc_open((folder / "out/echoes.nc").c_str(), NC_NOWRITE, &file), NC_NOERR);
  EXPECT_EQ(text_of(file, NC_GLOBAL, "start_utc"), "2024-06-01T12:30:00.5Z");
  EXPECT_THAT(text_of(file, NC_GLOBAL, "map_crs_wkt"), HasSubstr("Tangent plane at 59, 10"));
  double height = -1;
  EXPECT_EQ(nc_get_att_double(file, NC_GLOBAL, "height_of_origin_m", &height), NC_NOERR);
  EXPECT_EQ(height, 0);
  const auto values = [&](const char* name) {
    int id = -1;
    std::vector<double> both(2);
    EXPECT_EQ(nc_inq_varid(file, name, &id), NC_NOERR) << name;
    EXPECT_EQ(nc_get_var_double(file, id, both.data()), NC_NOERR);
    return both;
  };
  int id = -1;
  ASSERT_EQ(nc_inq_varid(file, "ping_utc", &id), NC_NOERR);
  EXPECT_EQ(text_of(file, id, "units"), "seconds since 2024-06-01T12:30:00.5Z");
  EXPECT_EQ(text_of(file, id, "standard_name"), "time");
  EXPECT_EQ(values("ping_utc"), values("ping_time"));
  EXPECT_EQ(values("ping_utc")[0], 1.25);
  EXPECT_NEAR(values("sensor_longitude")[0], 10, 1e-12);
  EXPECT_NEAR(values("sensor_latitude")[1], 59, 1e-12);
  EXPECT_NEAR(values("sensor_height")[0], -2, 1e-8);
  EXPECT_NEAR(values("sensor_true_heading")[0], 0, 1e-9);
  nc_close(file);
}

}  // namespace
}  // namespace tubefoot
