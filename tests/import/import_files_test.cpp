// SPDX-License-Identifier: GPL-3.0-or-later
// Tests files of other engines, which the test writes byte by byte. The reader recognises their kinds and
// reports errors: truncation at each length, excessive sizes, Python objects, and colours.
#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "bags/recordings.hpp"
#include "files/usage_error.hpp"
#include "fixtures/foreign_echoes.hpp"
#include "fixtures/test_folder.hpp"
#include "foreign_arrays.hpp"
#include "import/foreign_file.hpp"

namespace tubefoot {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pointwise;

struct ImportFiles : testing::Test {
  TestFolder folder;

  ForeignData read(const char* name, const std::string& bytes, const ReadOptions& options = {}) const {
    return read_foreign_file(folder.write(name, bytes), options);
  }
  ForeignFrame one(const char* name, const std::string& bytes, const ReadOptions& options = {}) const {
    ForeignData data = read(name, bytes, options);
    EXPECT_EQ(data.frames.size(), 1u);
    return data.frames.at(0);
  }
  std::string refusal(const char* name, const std::string& bytes, const ReadOptions& options = {}) const {
    try {
      read(name, bytes, options);
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr((folder / name).string()));
      return error.what();
    } catch (const UsageError& error) {  // a prefix of another kind rejects the options
      EXPECT_THAT(error.what(), HasSubstr((folder / name).string()));
      return error.what();
    }
    return "not refused";
  }
  /// Expects that each prefix of a file is rejected with a message.
  void expect_refused_at_every_length(const char* name, const std::string& bytes) const {
    for (std::size_t length = 0; length < bytes.size(); ++length)
      EXPECT_NE(refusal(name, bytes.substr(0, length)), "not refused") << length << " of " << bytes.size();
  }
  std::string picture(const char* name, int rows, int columns, int channels, OIIO::TypeDesc type,
                      const std::vector<double>& values) const {
    const std::filesystem::path file = folder / name;
    const auto output = OIIO::ImageOutput::create(file.string());
    OIIO::ImageSpec spec(columns, rows, channels, type);
    spec.attribute("oiio:UnassociatedAlpha", 1);
    EXPECT_TRUE(output->open(file.string(), spec));
    if (type == OIIO::TypeDesc::UINT8) {
      const std::vector<unsigned char> bytes(values.begin(), values.end());
      EXPECT_TRUE(output->write_image(type, bytes.data()));
    } else if (type == OIIO::TypeDesc::UINT16) {
      const std::vector<std::uint16_t> words(values.begin(), values.end());
      EXPECT_TRUE(output->write_image(type, words.data()));
    } else {
      const std::vector<float> floats(values.begin(), values.end());
      EXPECT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, floats.data()));
    }
    EXPECT_TRUE(output->close());
    return bytes_of(file);
  }
};

TEST_F(ImportFiles, NumbersOfAllTypesInBothOrdersOfBytes) {
  for (const char* type : {"<f8", ">f8", "<f4", ">f4", "<i4", ">i2", "|u1", "<u8", "|i1", "<f2", ">f2"}) {
    SCOPED_TRACE(type);
    const ForeignFrame frame = one("a.npy", npy_bytes(type, {2, 3}, {0, 1, 2, 3, 4, 100}));
    EXPECT_EQ(frame.rows, 2u);
    EXPECT_EQ(frame.columns, 3u);
    EXPECT_THAT(frame.values, ElementsAre(0, 1, 2, 3, 4, 100));
    EXPECT_EQ(frame.eight_bits, std::string(type) == "|u1");
  }
}

TEST_F(ImportFiles, HalfPrecisionHasItsSmallestAndItsLargestNumbers) {
  std::string bytes = npy_bytes("<u2", {1, 4}, {0x0001, 0x7bff, 0x3555, 0xc000});
  bytes.replace(bytes.find("<u2"), 3, "<f2");
  EXPECT_THAT(one("a.npy", bytes).values,
              Pointwise(testing::DoubleEq(), {std::ldexp(1, -24), 65504.0, 1365.0 / 4096, -2.0}));
}

TEST_F(ImportFiles, ComplexNumbersCountByTheirMagnitude) {
  EXPECT_THAT(one("a.npy", npy_bytes("<c16", {1, 2}, {3, 4, -5, 12})).values, ElementsAre(5, 13));
}

TEST_F(ImportFiles, FortransOrderIsTurned) {
  EXPECT_THAT(one("a.npy", npy_bytes("<f8", {2, 3}, {0, 10, 1, 11, 2, 12}, true)).values,
              ElementsAre(0, 1, 2, 10, 11, 12));
}

TEST_F(ImportFiles, ThreeAxesAreSeveralPictures) {
  const ForeignData data = read("a.npy", npy_bytes("<f4", {2, 1, 2}, {1, 2, 3, 4}));
  // The axis of length one is removed, so that this file has one picture of two rows.
  ASSERT_EQ(data.frames.size(), 1u);
  const ForeignData two = read("b.npy", npy_bytes("<f4", {2, 2, 2}, {1, 2, 3, 4, 5, 6, 7, 8}));
  ASSERT_EQ(two.frames.size(), 2u);
  EXPECT_THAT(two.frames[1].values, ElementsAre(5, 6, 7, 8));
}

TEST_F(ImportFiles, PointsSayWhereTheyAre) {
  // Rows at 2 and 3 m, columns at 120, 90 and 60 degrees from starboard: the order of OceanSim.
  std::vector<double> values;
  for (const double range : {2.0, 3.0})
    for (const double angle : {60.0, 90.0, 120.0}) {
      const double radians = angle * M_PI / 180;
      values.insert(values.end(), {range * std::cos(radians), range * std::sin(radians), range + angle});
    }
  ReadOptions points;
  points.arrays.points = true;
  const ForeignFrame frame = one("a.npy", npy_bytes("<f8", {2, 3, 3}, values), points);
  EXPECT_THAT(frame.values, ElementsAre(62, 92, 122, 63, 93, 123));
  EXPECT_THAT(frame.range_m, Pointwise(DoubleNear(1e-12), {2.0, 3.0}));
  EXPECT_THAT(frame.azimuth_rad, Pointwise(DoubleNear(1e-12), {M_PI / 6, 0.0, -M_PI / 6}));
  values[0] += 0.5;
  EXPECT_THAT(refusal("a.npy", npy_bytes("<f8", {2, 3, 3}, values), points), HasSubstr("is not a fan"));
}

TEST_F(ImportFiles, ArchivesHaveTheirArraysByName) {
  const std::string bytes = npz_bytes({{"image", npy_bytes("<f8", {2, 3}, {1, 2, 3, 4, 5, 6})},
                                       {"ranges", npy_bytes("<f8", {2}, {7, 8})},
                                       {"azimuths", npy_bytes("<f8", {3}, {-1, 0, 1})}});
  ReadOptions axes;
  axes.arrays = {"", "ranges", "azimuths", false};
  const ForeignFrame frame = one("a.npz", bytes, axes);
  EXPECT_THAT(frame.values, ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_THAT(frame.range_m, ElementsAre(7, 8));
  EXPECT_THAT(frame.azimuth_rad, ElementsAre(-1, 0, 1));
  axes.arrays.variable = "picture";
  EXPECT_THAT(refusal("a.npz", bytes, axes),
              HasSubstr("has no 'picture'; it has 'image', 'ranges' or 'azimuths'"));
  EXPECT_THAT(refusal("b.npz", npz_bytes({{"a", npy_bytes("<f8", {1, 2}, {1, 2})},
                                          {"b", npy_bytes("<f8", {1, 2}, {1, 2})}})),
              HasSubstr("--variable"));
}

TEST_F(ImportFiles, BadArraysAreRefused) {
  const std::string good = npy_bytes("<f4", {3, 2}, {1, 2, 3, 4, 5, 6});
  expect_refused_at_every_length("a.npy", good);
  EXPECT_THAT(refusal("a.npy", good + "x"), HasSubstr("3 x 2 values of 4 bytes, but has 25 bytes"));
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string bytes = good;
    bytes.replace(bytes.find(from), to.size(), to);
    return bytes;
  };
  EXPECT_THAT(refusal("a.npy", with("'<f4'", "'|O' ")), HasSubstr("Python objects"));
  EXPECT_THAT(refusal("a.npy", with("'<f4'", "'<U4'")), HasSubstr("'<U4'"));
  EXPECT_THAT(refusal("a.npy", with("'<f4'", "[<f4]")), HasSubstr("several types"));
  EXPECT_THAT(refusal("a.npy", with("(3, 2)", "(-3,2)")), HasSubstr("'shape'"));
  // The shape is as large as the number of values by a product that overflows.
  EXPECT_THAT(refusal("b.npy", npy_of_shape("<f8", "(4294967296, 4294967296, 2)")),
              HasSubstr("an impossible number"));
  EXPECT_THAT(refusal("b.npy", npy_of_shape("<f8", "(1000000000, 1000000000)")), HasSubstr("declares"));
  EXPECT_THAT(refusal("b.npy", npy_of_shape("<f8", "(0, 5)")), HasSubstr("empty"));
  EXPECT_THAT(refusal("b.npy", npy_bytes("<f8", {1, 1, 1, 2, 2, 2, 2}, std::vector<double>(16, 1))),
              HasSubstr("is not a picture"));
}

TEST_F(ImportFiles, BadArchivesAreRefused) {
  const std::string good = npz_bytes({{"image", npy_bytes("<f4", {2, 2}, {1, 2, 3, 4})}});
  expect_refused_at_every_length("a.npz", good);
  std::string damaged = good;
  damaged[damaged.find("NUMPY") + 100] ^= 1;  // of the values, which a checksum protects
  EXPECT_NE(refusal("a.npz", damaged), "not refused");
  EXPECT_THAT(refusal("b.npz", npz_bytes({{"no array", ""}})), HasSubstr("NPY"));
  EXPECT_THAT(refusal("c.npz", bursting_npz()),
              testing::AnyOf(HasSubstr("which is impossible"), HasSubstr("memory")));
}

// No member claims more than deflate can make of its bytes. All members together do.
TEST_F(ImportFiles, MembersThatUnpackToFarMoreThanTheArchiveAreRefused) {
  const std::string packed(70'000, 'x');
  const std::uint32_t claimed = std::uint32_t{1} << 26;
  std::vector<ZipMember> members;
  for (int k = 0; k < 100; ++k) members.push_back({"a" + std::to_string(k) + ".npy", packed, claimed});
  EXPECT_THAT(refusal("a.npz", zip_bytes(members)), HasSubstr("too many for its size"));
  members.resize(2);
  EXPECT_THAT(refusal("b.npz", zip_bytes(members)), HasSubstr("damaged"));
}

TEST_F(ImportFiles, MatricesInText) {
  EXPECT_THAT(one("a.csv", "# a comment\n1,2.5,3e-3\n\n4 , 5,+6\n").values,
              ElementsAre(1, 2.5, 3e-3, 4, 5, 6));
  EXPECT_THAT(one("a.txt", "  1   2\n3\t4\n").values.size(), 4u);
  EXPECT_THAT(one("a.txt", " 1   2\n3 4 \n").values, ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(one("a.csv", "1;2\n3;4\n").values, ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(refusal("a.csv", "1,2\n3\n"), HasSubstr("a.csv:2: has 1 values, but the first row has 2"));
  EXPECT_THAT(refusal("a.csv", "1,2\n3,nan\n"), HasSubstr("a.csv:2:3: 'nan'"));
  EXPECT_THAT(refusal("a.csv", "beam,range\n1,2\n"), HasSubstr("a.csv:1:1: 'beam'"));
  EXPECT_THAT(refusal("a.csv", "1,1e999\n"), HasSubstr("'1e999'"));
  EXPECT_THAT(refusal("a.csv", "# nothing\n"), HasSubstr("contains no numbers"));
}

TEST_F(ImportFiles, TablesOfDave) {
  // As the code of the engine writes them: a plus only if the imaginary part is above 0.
  const ForeignData data =
      read("raw.csv",
           "# Raw Sonar Data Log (Row: beams, Col: time series data)\n# First column is range "
           "vector\n#  nBeams : 3\n2.5,3+4i,-3-4i,1.50i\n3,1e-05+0.5i,0-2i,-20i\n");
  const ForeignFrame& frame = data.frames.at(0);
  EXPECT_EQ(frame.columns, 3u);
  EXPECT_THAT(frame.range_m, ElementsAre(2.5, 3));
  EXPECT_THAT(frame.values, Pointwise(DoubleNear(1e-9), {5.0, 5.0, 1.5, 0.5, 2.0, 2.0}));
  EXPECT_THAT(data.noticed, testing::Contains(HasSubstr("complex")));
}

TEST_F(ImportFiles, PicturesAsTheyAreStored) {
  const std::vector<double> eight{0, 1, 127, 128, 254, 255}, sixteen{0, 1, 255, 256, 40000, 65535},
      floats{0, 0.25, 1, 2, 1e-9f, 1e9f};
  for (const char* name : {"a.png", "a.tif"}) {
    const ForeignFrame bytes = one(name, picture(name, 2, 3, 1, OIIO::TypeDesc::UINT8, eight));
    EXPECT_EQ(bytes.rows, 2u);
    EXPECT_TRUE(bytes.eight_bits);
    EXPECT_EQ(bytes.values, eight) << name;
    const ForeignFrame words = one(name, picture(name, 2, 3, 1, OIIO::TypeDesc::UINT16, sixteen));
    EXPECT_FALSE(words.eight_bits);
    EXPECT_EQ(words.values, sixteen) << name;
  }
  for (const char* name : {"a.exr", "a.tif"})
    EXPECT_EQ(one(name, picture(name, 2, 3, 1, OIIO::TypeDesc::FLOAT, floats)).values, floats) << name;
}

TEST_F(ImportFiles, ColoursAreNoMeasure) {
  const std::string grey = picture("a.png", 1, 2, 3, OIIO::TypeDesc::UINT8, {7, 7, 7, 9, 9, 9}),
                    coloured = picture("a.png", 1, 2, 3, OIIO::TypeDesc::UINT8, {7, 7, 7, 9, 8, 9}),
                    clear = picture("a.png", 1, 2, 4, OIIO::TypeDesc::UINT8, {7, 7, 7, 255, 9, 9, 9, 10});
  EXPECT_THAT(one("a.png", grey).values, ElementsAre(7, 9));
  EXPECT_THAT(one("a.png", clear).values, ElementsAre(7, 9)) << "alpha must not dim";
  EXPECT_THAT(refusal("a.png", coloured), HasSubstr("in colours (row 0, column 1: red 9, green 8, blue 9)"));
  ReadOptions green;
  green.arrays.variable = "G";
  EXPECT_THAT(one("a.png", coloured, green).values, ElementsAre(7, 8));
  green.arrays.variable = "X";
  EXPECT_THAT(refusal("a.png", coloured, green), HasSubstr("has no channel 'X'"));
}

TEST_F(ImportFiles, CutOffPicturesAreRefused) {
  const std::vector<double> values(30 * 20, 77);
  for (const char* name : {"a.png", "a.tif", "a.exr"}) {
    const std::string whole =
        picture(name, 30, 20, 1, name[2] == 'e' ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UINT8, values);
    for (const std::size_t length : {std::size_t{4}, std::size_t{8}, whole.size() / 4, whole.size() / 2})
      EXPECT_NE(refusal(name, whole.substr(0, length)), "not refused") << name << " " << length;
  }
}

TEST_F(ImportFiles, APictureLargerThanAnyPingIsRefusedByItsHeader) {
  std::string png = picture("a.png", 2, 3, 1, OIIO::TypeDesc::UINT8, {1, 2, 3, 4, 5, 6});
  const std::size_t header = png.find("IHDR");
  png.replace(header + 4, 8, std::string("\0\0\xff\xff\0\0\xff\xff", 8));
  const std::uint32_t crc = crc32_of(png.substr(header, 17));
  for (int k = 0; k < 4; ++k)
    png[header + 17 + std::size_t(k)] = static_cast<char>(crc >> (24 - 8 * k) & 255);
  EXPECT_THAT(refusal("a.png", png), HasSubstr("65535 x 65535 pixels, more than any ping"));
}

TEST_F(ImportFiles, DamagedBytesAreReadOrRefused) {
  const std::vector<double> values(20 * 15, 77);
  std::map<std::string, std::string> whole{
      {"a.npy", npy_bytes("<f4", {3, 2}, {1, 2, 3, 4, 5, 6})},
      {"a.npz", npz_bytes({{"image", npy_bytes("<f4", {2, 2}, {1, 2, 3, 4})}})},
      {"a.csv", "# First column is range\n1,2.5+3i,3e-3\n4,5,+6\n"}};
  for (const char* name : {"a.png", "a.tif", "a.exr"})
    whole[name] =
        picture(name, 20, 15, 1, name[2] == 'e' ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UINT8, values);
  std::mt19937 random(1);
  for (const auto& [name, good] : whole)
    for (int k = 0; k < 300; ++k) {
      std::string bytes = good;
      for (int damages = 1 + k % 3; damages > 0; --damages)
        bytes[random() % bytes.size()] = static_cast<char>(k % 2 ? random() : 0xff);
      try {
        for (const ForeignFrame& frame : read(name.c_str(), bytes).frames)
          EXPECT_EQ(frame.values.size(), frame.rows * frame.columns) << name << k;
      } catch (const InputError&) {
      }
    }
}

TEST_F(ImportFiles, NetcdfOfOtherNamesPackedOrNot) {
  ForeignGroup group;
  group.dimensions = {{"row", 2}, {"column", 3}};
  group.variables = {{"sonar_image", {{"row", "column"}, {}, {1, 2, 3, 4, 5, 6}, NC_SHORT}},
                     {"r", {{"row"}, "m", {4, 5}}}};
  ReadOptions options;
  options.arrays = {"sonar_image", "r", "", false};
  for (const int mode : {NC_NETCDF4, 0}) {
    const auto file = write_foreign(folder / "a.nc", group, {}, mode);
    const ForeignFrame frame = read_foreign_file(file, options).frames.at(0);
    EXPECT_THAT(frame.values, ElementsAre(1, 2, 3, 4, 5, 6));
    EXPECT_THAT(frame.range_m, ElementsAre(4, 5));
  }
  int id = 0, variable = 0;
  ASSERT_EQ(nc_open((folder / "a.nc").c_str(), NC_WRITE, &id), NC_NOERR);
  nc_redef(id);
  nc_inq_varid(id, "sonar_image", &variable);
  const double scale = 0.5, offset = 10;
  nc_put_att_double(id, variable, "scale_factor", NC_DOUBLE, 1, &scale);
  nc_put_att_double(id, variable, "add_offset", NC_DOUBLE, 1, &offset);
  ASSERT_EQ(nc_close(id), NC_NOERR);
  EXPECT_THAT(read_foreign_file(folder / "a.nc", options).frames.at(0).values,
              ElementsAre(10.5, 11, 11.5, 12, 12.5, 13));
  const std::string whole = bytes_of(folder / "a.nc");
  for (std::size_t length = 0; length < whole.size(); length += 16)
    EXPECT_NE(refusal("b.nc", whole.substr(0, length), options), "not refused") << length;
}

TEST_F(ImportFiles, FilesComeInTheOrderOfTheirNumbers) {
  for (const char* name : {"f10.csv", "f9.csv", "f09b.csv", ".hidden"}) folder.write(name, "1,2\n");
  std::vector<std::string> names;
  for (const auto& file : files_in_order({folder.path()})) names.push_back(file.filename().string());
  EXPECT_THAT(names, ElementsAre("f9.csv", "f09b.csv", "f10.csv"));
}

TEST_F(ImportFiles, RecordingsOfRosAreReadByTheirTopic) {
  using namespace recordings;
  const std::string two = mcap::file(
      mcap::schema(1, projected_type) + mcap::channel(1, 1, "/port") + mcap::channel(2, 1, "/starboard") +
      mcap::message(1, 0, projected(small_sonar())) + mcap::message(2, 1, projected(small_sonar())));
  ReadOptions options;
  options.topic = "/starboard";
  const ForeignFrame frame = one("two.mcap", two, options);
  EXPECT_EQ(frame.rows, 3u);
  EXPECT_THAT(frame.range_m, ElementsAre(1, 1.5, 2, 2.5));
  EXPECT_THROW(read("two.mcap", two), UsageError) << "which topic?";
  EXPECT_NE(refusal("a.mcap", "x"), "not refused");
  EXPECT_NE(refusal("a.db3", "x"), "not refused");
}

}  // namespace
}  // namespace tubefoot
