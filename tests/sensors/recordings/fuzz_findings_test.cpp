// SPDX-License-Identifier: GPL-3.0-or-later
// Repeats the findings of fuzzing for readers of echo files (validation/fuzzing.md), minimised. The test
// names state the findings.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <fstream>

#include "files/input_error.hpp"
#include "fixtures/foreign_echoes.hpp"
#include "fixtures/world/read_scenes.hpp"
#include "sensors/recordings/echo_reader.hpp"

namespace tubefoot {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

// netCDF writes no such file, but reads it. It then returns all 64 values to a caller that requests one.
TEST(FuzzedRecordings, FillValueOfManyValuesIsRefusedBeforeItIsRead) {
  const TestFolder folder;
  const auto file = write_foreign(folder.path() / "echoes.nc", least_echoes(), {}, 0);
  EXPECT_EQ(read_echo_file(file).sensors.size(), 1u);
  constexpr std::array<double, 64> values{1};
  int id = 0, variable = 0;
  foreign::require(nc_open(file.c_str(), NC_WRITE, &id));
  foreign::require(nc_redef(id));
  foreign::require(nc_inq_varid(id, "energy", &variable));
  foreign::require(nc_put_att_double(id, variable, "_FillValuX", NC_DOUBLE, values.size(), values.data()));
  foreign::require(nc_close(id));
  std::ifstream in(file, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), {}};
  bytes.replace(bytes.find("_FillValuX"), 10, "_FillValue");
  std::ofstream(file, std::ios::binary) << bytes;
  EXPECT_THAT([&] { read_echo_file(file); },
              ThrowsMessage<InputError>(
                  HasSubstr("variable 'energy' has 64 values in attribute _FillValue, expected one")));
}

}  // namespace
}  // namespace tubefoot
