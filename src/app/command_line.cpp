// SPDX-License-Identifier: GPL-3.0-or-later
// Entry point of the program: parses the command line, calls the command, and converts exceptions to
// messages and exit codes. It also accepts renamed options and reports unknown commands.
#include "app/command_line.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <functional>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "app/command_options.hpp"
#include "app/commands.hpp"
#include "app/help_formatter.hpp"
#include "app/library_versions.hpp"
#include "files/absolute_path.hpp"
#include "files/input_error.hpp"
#include "files/library_settings.hpp"
#include "files/shown.hpp"
#include "files/usage_error.hpp"
#include "files/words.hpp"
#include "geometry/steps/stop.hpp"
#include "run/checkpoint/build_identity.hpp"
#include "run/console/exhausted.hpp"
#include "run/console/interrupt.hpp"
#include "run/console/say.hpp"
#include "run/ranks/rank_link.hpp"

namespace tubefoot {

CLI::Validator finite_number(double least, bool above) {
  return CLI::Validator(
      [least, above](std::string& text) -> std::string {
        double value = 0;
        const bool number = CLI::detail::lexical_cast(text, value) && std::isfinite(value);
        if (number && (above ? value > least : value >= least)) return {};
        return fmt::format("invalid value '{}': expected a number {} {:g}", text,
                           above ? "above" : "of at least", least);
      },
      "NUMBER");
}

CLI::Validator echoes_of_run() {
  return CLI::Validator(
      [](std::string& text) -> std::string {
        const std::filesystem::path inside = std::filesystem::path(text) / "echoes.nc";
        std::error_code unknown;
        if (std::filesystem::is_regular_file(inside, unknown)) text = inside.string();
        return {};
      },
      "");
}

void add_common(CLI::App& command, CommonOptions& options, const std::string& group) {
  command.add_option("SCENE", options.scene, "scene file (docs/scene-keys.md)")->required();
  command
      .add_option("--arithmetic", options.arithmetic,
                  "number type of exact visibility (default: 'arithmetic' of the scene)")
      ->check(CLI::IsMember({"fixed", "filtered", "rational", "double"}))
      ->group(group);
  command
      .add_option("--threads", options.threads,
                  "number of threads (default: 'threads' of the scene, else all cores)")
      ->check(CLI::Range(1, 4096))
      ->group(group);
  add_scene_flags(command, options, group);
}

namespace {

constexpr int done = 0, failed = 1, wrong_input = 2;

/// Opens /dev/null for each closed standard stream. Otherwise the first file that is opened would take the
/// number of the stream and receive its output.
void hold_closed_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(stream, F_GETFD) < 0 && errno == EBADF && open("/dev/null", O_RDONLY) < 0) return;
}

/// An option of an earlier version. It keeps its meaning and causes a warning.
struct RenamedOption {
  std::string_view before, now;
};
constexpr std::array renamed_options{RenamedOption{"--truth", "--labels"},
                                     RenamedOption{"--recipe", "--output-model"},
                                     RenamedOption{"--part", "--shard"},
                                     RenamedOption{"--keep-parts", "--keep-shards"},
                                     RenamedOption{"--ping", "--pings"},
                                     RenamedOption{"--beam", "--beams"},
                                     RenamedOption{"--frequency", "--frequencies"},
                                     RenamedOption{"--azimuth", "--azimuths"},
                                     RenamedOption{"--elevation", "--elevations"}};

/// Returns the words of the command line with current option names and with `help COMMAND` as `COMMAND
/// --help`.
std::vector<std::string> present_words(int argc, char** argv) {
  std::vector<std::string> words(argv, argv + argc);
  const bool quiet = std::ranges::find(words, "--quiet") != words.end() || is_later_rank();
  for (std::size_t k = 2; k < words.size() && words[k] != "--"; ++k)
    for (const auto& [before, now] : renamed_options)
      if (words[k] == before || words[k].starts_with(fmt::format("{}=", before))) {
        words[k].replace(0, before.size(), now);
        if (!quiet) say("warning: {} is deprecated: use {}\n", before, now);
        break;
      }
  if (words.size() > 1 && words[1] == "pack") {
    words[1] = "suite";
    if (!quiet) say("warning: the command 'pack' is deprecated: use 'suite'\n");
  }
  if (words.size() > 1 && words[1] == "help") {
    words.erase(words.begin() + 1);
    words.resize(std::min<std::size_t>(words.size(), 2));
    words.emplace_back("--help");
  }
  return words;
}

/// Reports a missing or unknown command. Returns whether there is a command to parse.
bool has_command(const CLI::App& app, const std::vector<std::string>& words) {
  if (words.size() < 2) {
    say("{}", app.help());
    return false;
  }
  std::vector<std::string> names;
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(sub->get_name());
  if (words[1].starts_with('-') || std::ranges::find(names, words[1]) != names.end()) return true;
  const std::string_view meant = nearest(words[1], names);
  say("tubefoot: unknown command '{}': {}'tubefoot help' lists the commands\n", shown(words[1]),
      meant.empty() ? std::string() : fmt::format("did you mean '{}'? ", meant));
  return false;
}

/// Calls the command and converts its exceptions to a message and an exit code.
int called(const std::function<int()>& command) {
  try {
    return command();
  } catch (const Interrupted&) {
    say("tubefoot: interrupted: nothing was written\n");
    return failed;
  } catch (const InputError& error) {
    // A library may have run out of memory while it read a valid file.
    if (const std::string_view words = exhaustion_in_words(error); !words.empty()) {
      say("tubefoot: {}\n", words);
      return failed;
    }
    say("{}\n", error.what());
    return wrong_input;
  } catch (const UsageError& error) {
    say("tubefoot: {}\n", shown(error.what()));
    return wrong_input;
  } catch (const std::filesystem::filesystem_error& error) {
    say("tubefoot: {}\n", shown(message_of(error)));
    return failed;
  } catch (const std::exception& error) {
    if (const std::string_view words = exhaustion_in_words(error); !words.empty()) {
      say("tubefoot: {}\n", words);
      return failed;
    }
    // A failure of stdout is reported once, at the end.
    if (std::ferror(stdout) == 0) say("tubefoot: {}\n", shown(error.what()));
    return failed;
  }
}

int obeyed(int argc, char** argv) {
  CLI::App app{"tubefoot: a sonar simulator that measures footprints instead of sampling them.", "tubefoot"};
  app.set_version_flag(
      "--version", [] { return "tubefoot " TUBEFOOT_VERSION "\n" + build_in_words() + library_versions(); });
  app.require_subcommand(1);
  const auto formatter = std::make_shared<HelpFormatter>();
  formatter->column_width(16);
  app.formatter(formatter);
  app.footer(
      "Exit status:\n  0  done\n  1  the run failed\n  2  the input or the command line is wrong\n  3  a "
      "comparison found a larger error than allowed");
  CommandOptions requested;
  for (const auto add : {add_run, add_join, add_check, add_audit, add_footprints, add_coverage, add_strength,
                         add_rays, add_view, add_refine, add_export, add_import_scene, add_compare,
                         add_import, add_chart, add_advise, add_presets, add_keys, add_suite})
    add(app, requested);
  std::vector<std::string> words = present_words(argc, argv);
  if (!has_command(app, words)) return wrong_input;
  try {
    std::vector<const char*> pointers;
    for (const std::string& word : words) pointers.push_back(word.c_str());
    app.parse(static_cast<int>(pointers.size()), pointers.data());
  } catch (const CLI::ParseError& error) {
    // Several ranks parse the same command line; only the first reports the error.
    if (argc > 1 && std::string_view(argv[1]) == "run" && is_later_rank()) return done;
    // CLI11 throws --help and --version as errors of code 0.
    std::ostringstream answer, complaint;
    const int code = app.exit(error, answer, complaint);
    tell("{}", answer.str());
    say("{}", complaint.str());
    return code == 0 ? done : wrong_input;
  }
  return called(requested.command);
}

}  // namespace

int run_command_line(int argc, char** argv) {
  hold_closed_streams();
  remove_library_variables();
  configure_heap();
  take_signals();
  const int code = called([&] { return obeyed(argc, argv); });
  errno = tell_error;
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  const std::string why = errno != 0 ? fmt::format(": {}", std::strerror(errno)) : "";
  say("tubefoot: cannot write to standard output{}\n", why);
  return code == done ? failed : code;
}

}  // namespace tubefoot
