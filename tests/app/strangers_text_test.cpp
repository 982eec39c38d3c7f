// SPDX-License-Identifier: GPL-3.0-or-later
// Tests text from untrusted sources: titles, names, file names and attributes of echo files. In all outputs
// the text controls no terminal, reverses no text direction, is no formula, and runs no script in a page.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "files/csv_file.hpp"
#include "files/input_error.hpp"
#include "files/shown.hpp"
#include "fixtures/foreign_echoes.hpp"
#include "fixtures/program.hpp"
#include "fixtures/scene_texts.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// U+009B 2 J clears the screen without an escape character. U+202E reverses the text direction.
constexpr const char *clear_screen = "\u009b2J", *backwards = "\u202e";

/// Returns the bytes that control a terminal or the text direction. No output may contain such bytes.
std::string obeyed(const std::string& text) {
  for (std::size_t k = 0; k < text.size(); ++k) {
    const auto byte = [&](std::size_t more) {
      return k + more < text.size() ? static_cast<unsigned char>(text[k + more]) : 0u;
    };
    const bool control = (byte(0) < 0x20 && text[k] != '\n' && text[k] != '\t') || byte(0) == 0x7f ||
                         (byte(0) == 0xc2 && byte(1) >= 0x80 && byte(1) < 0xa0);
    const bool turning = byte(0) == 0xe2 && ((byte(1) == 0x80 && byte(2) >= 0xa8 && byte(2) <= 0xae) ||
                                             (byte(1) == 0x81 && byte(2) >= 0xa6 && byte(2) <= 0xa9));
    const bool alone =
        byte(0) >= 0x80 && byte(0) < 0xc0 && (k == 0 || static_cast<unsigned char>(text[k - 1]) < 0x80);
    if (control || turning || alone) return fmt::format("byte {} of: {}", k, harmless(text));
  }
  return {};
}

struct StrangersText : testing::Test {
  TestFolder folder;
  StrangersText() { folder.write("thing.obj", tetrahedron); }

  static Outcome run(const std::vector<std::string>& words) {
    const Outcome outcome = run_program(words);
    EXPECT_EQ(obeyed(outcome.out), "");
    EXPECT_EQ(obeyed(outcome.err), "");
    return outcome;
  }
  /// Makes the small scene with malicious titles and names.
  fs::path scene_of(const std::string& title, const std::string& sand, const std::string& thing) const {
    std::string scene = replaced(small_scene, "A tetrahedron", title);
    scene = replaced(scene, "\"sand\"", "\"" + sand + "\"");
    scene = replaced(scene, "\"thing\"", "\"" + thing + "\"");
    return folder.write("scene.toml", scene);
  }
};

TEST(ShownText, EscapesWhatTerminalsObeyAndWhatTurnsText) {
  EXPECT_EQ(harmless("plain, \u00fc \u20ac \U0001f600\n\tand so on"),
            "plain, \u00fc \u20ac \U0001f600\n\tand so on");
  EXPECT_EQ(harmless("a\x1b[2J\x7f\r"), "a\\x1b[2J\\x7f\\x0d");
  for (unsigned code = 0x80; code < 0xa0; ++code)
    EXPECT_EQ(harmless(std::string{'\xc2', static_cast<char>(code)}), fmt::format("\\u{:04x}", code));
  for (const char* mark : {"\u202a", "\u202b", "\u202c", "\u202d", "\u202e", "\u2066", "\u2067", "\u2068",
                           "\u2069", "\u200e", "\u200f", "\u061c", "\u2028", "\u2029"}) {
    const std::string shown_mark = harmless(mark);
    EXPECT_EQ(shown_mark.substr(0, 2), "\\u") << mark;
    EXPECT_EQ(shown_mark.size(), 6u);
  }
  EXPECT_EQ(harmless("\u00a0\u2027\u202f\u2065\u206a"), "\u00a0\u2027\u202f\u2065\u206a")
      << "their neighbours";
}

TEST(ShownText, EscapesBytesThatAreNoUtf8) {
  EXPECT_EQ(harmless("a\x9b"
                     "2J\xff\xfe"),
            "a\\x9b2J\\xff\\xfe");
  EXPECT_EQ(harmless("\xc2"), "\\xc2") << "cut off";
  EXPECT_EQ(harmless("\xe2\x80"), "\\xe2\\x80");
  EXPECT_EQ(harmless("\xe2\x80x"), "\\xe2\\x80x");
  EXPECT_EQ(harmless("\xc0\x9b\xc1\xbf"), "\\xc0\\x9b\\xc1\\xbf") << "longer than they need be";
  EXPECT_EQ(harmless("\xe0\x82\x9b"), "\\xe0\\x82\\x9b");
  EXPECT_EQ(harmless("\xf0\x80\x82\x9b"), "\\xf0\\x80\\x82\\x9b");
  EXPECT_EQ(harmless("\xed\xa0\x80"), "\\xed\\xa0\\x80") << "half of a pair";
  EXPECT_EQ(harmless("\xf4\x90\x80\x80\xf5"), "\\xf4\\x90\\x80\\x80\\xf5") << "beyond the last character";
}

TEST(ShownText, OfALineIsOneLineAndNoLongerThanALine) {
  EXPECT_EQ(shown_line("a\nb\tc"), "a\\x0ab\\x09c");
  EXPECT_EQ(shown_line(std::string(200, 'x')), std::string(200, 'x'));
  EXPECT_EQ(shown_line(std::string(3'000'000, 'x')), std::string(200, 'x') + "...");
  std::string wide = "x";
  while (wide.size() < 1000) wide += "\u20ac";
  EXPECT_EQ(shown_line(wide), wide.substr(0, 199) + "...") << "not through a character";
}

TEST(ShownText, OfAPageHoldsNoTagAndNoEndOfAnAttribute) {
  EXPECT_EQ(shown_markup("<b a=\"1\" c='2'>&amp;\u202e"), "&lt;b a=&quot;1&quot; c='2'&gt;&amp;amp;\\u202e");
}

TEST(CsvText, IsNoFormula) {
  EXPECT_EQ(csv_text("sand"), "sand");
  EXPECT_EQ(csv_text("a, \"b\""), "\"a, \"\"b\"\"\"");
  EXPECT_EQ(csv_text("=cmd|' /C calc'!A0"), "\"'=cmd|' /C calc'!A0\"");
  for (const char begin : {'=', '+', '-', '@', '\t', '\r'})
    EXPECT_EQ(csv_text(std::string{begin} + "x"), fmt::format("\"'{}x\"", begin));
  EXPECT_EQ(csv_text(""), "");
  EXPECT_EQ(csv_text("a=b"), "a=b");
}

TEST_F(StrangersText, ControlsOfC1AndMarksAreEscapedInMessagesAndTables) {
  const std::string title = fmt::format("clear{} and turn {}txt.exe", clear_screen, backwards);
  const fs::path scene = scene_of(title, fmt::format("sand{}", backwards), fmt::format("a{}b", clear_screen));
  const Outcome checked = run({"check", scene.string()});
  EXPECT_EQ(checked.exit_code, 0) << checked.err;
  EXPECT_THAT(checked.out, AllOf(HasSubstr("clear\\u009b2J and turn \\u202etxt.exe"),
                                 HasSubstr("sand\\u202e"), HasSubstr("a\\u009b2Jb")));
  const Outcome unknown = run({"footprints", scene.string(), "--sensor", clear_screen, "-o", "x.csv"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("\\u009b2J"));
}

TEST_F(StrangersText, BytesThatAreNoUtf8AreEscapedInFilesNames) {
  const std::string name =
      "no\x9b"
      "2J\xff.toml";
  folder.write(name, "title = ");
  const Outcome outcome = run({"check", (folder / name).string()});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("no\\x9b2J\\xff.toml"));
  EXPECT_EQ(run({"check", (folder / "none\xff.toml").string()}).exit_code, 2);
  EXPECT_EQ(run({"\x9b"
                 "2J"})
                .exit_code,
            2);
  EXPECT_EQ(run({"check",
                 "--\x9b"
                 "2J"})
                .exit_code,
            2);
}

TEST_F(StrangersText, WhatIsTooLongIsRefusedOrCut) {
  for (const auto& [title, sand, word] :
       {std::tuple{std::string(3'000'000, 'x'), std::string("sand"), "'title' has 3000000 bytes"},
        std::tuple{std::string("t"), std::string(300, 'x'), "'name' has 300 bytes, expected at most 200"}}) {
    const Outcome outcome = run({"check", scene_of(title, sand, "thing").string()});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, HasSubstr(word));
    EXPECT_LT(outcome.err.size(), 5000u);
  }
  const Outcome outcome =
      run({"check", scene_of(std::string(1000, 'x'), std::string(200, 'y'), "thing").string()});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
}

TEST_F(StrangersText, NamesAreNoFormulasInTables) {
  const fs::path scene = scene_of("t", "=HYPERLINK(0)", "@thing");
  for (const char* command : {"footprints", "coverage"}) {
    SCOPED_TRACE(command);
    const fs::path table = folder / (std::string(command) + ".csv");
    const Outcome outcome = run({command, scene.string(), "--sensor", "camera", "-o", table.string()});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const std::string text = bytes_of(table);
    EXPECT_THAT(text, AllOf(HasSubstr("\"'=HYPERLINK(0)\""), HasSubstr("\"'@thing\"")));
    EXPECT_THAT(text, AllOf(Not(HasSubstr(",=")), Not(HasSubstr(",@")), Not(HasSubstr(",\"=")),
                            Not(HasSubstr("\n=")), Not(HasSubstr(",\"@"))));
  }
}

TEST_F(StrangersText, RunsInNoPage) {
  const std::string tag = "</script><img src=x onerror=alert(1)>";
  const fs::path scene = scene_of(tag + backwards, "sand" + std::string(backwards), tag + clear_screen);
  const fs::path page = folder / "page.html";
  const Outcome outcome = run({"view", scene.string(), "-o", page.string()});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string html = bytes_of(page);
  EXPECT_THAT(html, AllOf(Not(HasSubstr("<img")), HasSubstr("&lt;/script&gt;&lt;img"), HasSubstr("\\u202e")));
  EXPECT_THAT(html, AllOf(Not(HasSubstr(backwards)), Not(HasSubstr(clear_screen))));
  EXPECT_THAT(html, AllOf(HasSubstr("sand\\\\u202e"), HasSubstr("\\\\u009b2J")))
      << "and not turned by the script that reads it";

  // A chart names scenes by their file names.
  const std::string name = "<img src=x onerror=alert(1)>\u202e=1";
  fs::rename(scene, folder / (name + ".toml"));
  const fs::path chart = folder / "chart";
  const Outcome charted = run({"chart", (folder / (name + ".toml")).string(), "-o", chart.string(),
                               "--seconds", "0.001", "--repeats", "1", "--quiet"});
  ASSERT_EQ(charted.exit_code, 0) << charted.err;
  EXPECT_THAT(bytes_of(chart / "index.html"),
              AllOf(Not(HasSubstr("<img")), HasSubstr("&lt;img"), Not(HasSubstr(backwards))));
  for (const std::string& file : names_below(chart)) {
    if (!file.ends_with(".svg")) continue;
    EXPECT_THAT(bytes_of(chart / file), AllOf(Not(HasSubstr("<img")), Not(HasSubstr(backwards)))) << file;
  }
}

// Another person may have written the attributes of an echo file.
TEST_F(StrangersText, OfEchoFilesIsEscapedAndCut) {
  ForeignGroup echoes = least_echoes();
  const fs::path plain = write_foreign(folder / "plain.nc", echoes);
  const std::string engine = std::string("tube\x9b") + "2J" + clear_screen + backwards;
  echoes.attributes = {{"engine", engine},
                       {"version", std::string(60000, 'v')},
                       {"title", std::string("turned ") + backwards},
                       {"sensor_name", std::string("camera") + backwards}};
  const fs::path strange = write_foreign(folder / "strange.nc", echoes), picture = folder / "compared.png";
  const Outcome compared = run({"compare", strange.string(), plain.string(), "--png", picture.string()});
  EXPECT_EQ(compared.exit_code, 0) << compared.err;
  EXPECT_THAT(compared.out, AllOf(HasSubstr("tube\\x9b2J\\u009b2J\\u202e"), HasSubstr("camera\\u202e")));
  EXPECT_LT(compared.out.size(), 10000u);
  EXPECT_LT(fs::file_size(picture), 5'000'000u);
  const Outcome json = run({"compare", strange.string(), plain.string(), "--json", "-"});
  EXPECT_EQ(json.exit_code, 0) << json.err;
  EXPECT_THAT(json.out, HasSubstr("turned \\u202e"));
}

}  // namespace
}  // namespace tubefoot
