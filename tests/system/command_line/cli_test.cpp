// The command line's manners: each mistake gets one sentence, the exit status of the table, and
// leaves nothing behind.
// SPDX-License-Identifier: Apache-2.0
#include <pty.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <filesystem>
#include <regex>
#include <sstream>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/system/command_line/process_testing.h"

namespace kaz::test {
namespace {

using ::testing::AssertionFailure;
using ::testing::AssertionResult;
using ::testing::AssertionSuccess;

// One sentence on standard error that names each of `words`, nothing on standard output.
AssertionResult one_sentence(const Finished& finished, int exit_code,
                             const std::vector<std::string>& words) {
  if (finished.exit_code != exit_code) {
    return AssertionFailure() << "exit " << finished.exit_code << ", not " << exit_code << ": "
                              << finished.err;
  }
  if (std::count(finished.err.begin(), finished.err.end(), '\n') != 1) {
    return AssertionFailure() << "not one line: " << finished.err;
  }
  for (const auto& word : words) {
    if (finished.err.find(word) == std::string::npos) {
      return AssertionFailure() << "'" << word << "' is not named in: " << finished.err;
    }
  }
  // With --json the error is there, too; a result is not.
  const auto json = nlohmann::json::parse(finished.out, nullptr, false);
  if (!finished.out.empty() && !(json.is_object() && json.contains("error")))
    return AssertionFailure() << "on standard output: " << finished.out;
  return AssertionSuccess();
}

// The error message names each of `words` and the help of a verb.
AssertionResult refuses(const std::vector<std::string>& arguments, std::vector<std::string> words) {
  words.emplace_back("--help`");
  return one_sentence(run(kaz(arguments)), 2, words);
}

TEST(Cli, EachHelpHasItsOwnExamplesWithin100Columns) {
  const auto verbs = all_verbs();
  ASSERT_GT(verbs.size(), 30u);
  for (const auto& verb : verbs) {
    auto arguments = verb;
    arguments.push_back("--help");
    const Finished finished = run(kaz(arguments));
    EXPECT_EQ(finished.exit_code, 0);
    EXPECT_TRUE(finished.err.empty()) << finished.err;
    std::string example = "kaz";
    for (const auto& word : verb) example += " " + word;
    const auto examples = finished.out.find("Examples:\n");
    ASSERT_NE(examples, std::string::npos) << finished.out;
    EXPECT_NE(finished.out.find(example, examples), std::string::npos) << finished.out;
    // An example can be typed as it stands: no placeholder of the usage is in it.
    EXPECT_FALSE(std::regex_search(finished.out.substr(examples),
                                   std::regex(" (IMAGE|FILE|DIR|PATH|PORT)\\b")))
        << finished.out;
    // CLI11's notation: --no-start{false}, TEXT:{h8,native}.
    EXPECT_FALSE(std::regex_search(finished.out, std::regex("--[a-z-]+\\{|:\\{"))) << finished.out;
    std::istringstream lines(finished.out);
    for (std::string line; std::getline(lines, line);)
      EXPECT_LE(line.size(), 100u) << example << ": " << line;
    // A long example continues after a backslash.
    std::istringstream commands(finished.out.substr(examples));
    std::string before;
    for (std::string line; std::getline(commands, line); before = line)
      EXPECT_EQ(line.starts_with("      "), before.ends_with(" \\")) << before << "\n" << line;
  }
}

TEST(Cli, HelpOfARunDescribesTheNamedBehavior) {
  const auto help = [](std::vector<std::string> more) {
    more.insert(more.begin(), "run");
    more.push_back("--help");
    return run(kaz(more)).out;
  };
  const auto has = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  const std::string all = help({});
  EXPECT_LT(std::ranges::count(all, '\n'), 130);
  EXPECT_FALSE(has(all, "\n\n\n")) << all;
  EXPECT_TRUE(has(all, "`kaz run NAME --help` shows the options of a behavior")) << all;
  EXPECT_TRUE(has(all, "\n  navigate: map the floor")) << all;
  for (const char* of_some : {"planner", "  --goal", "  --poses", "  --duration"})
    EXPECT_FALSE(has(all, of_some)) << of_some;
  const std::string navigate = help({"navigate"});
  for (const char* part : {"planner (grid; grid|ompl)", "  --goal ", "  --duration ", "  --robot ",
                           "kaz run navigate --goal"})
    EXPECT_TRUE(has(navigate, part)) << part << "\n" << navigate;
  for (const char* part : {"--poses", "catch-ball: find", "kaz run search-ball"})
    EXPECT_FALSE(has(navigate, part)) << part << "\n" << navigate;
  EXPECT_TRUE(has(help({"play"}), "  --poses FILE"));
  // Without an example in the help of all, one is made.
  EXPECT_TRUE(has(help({"turn-left"}), "  kaz run turn-left --set angle=45\n"));
  EXPECT_TRUE(has(help({"get-up"}), "attempts (3; 1 to 10)"));
  // A plug-in is not loaded for it.
  EXPECT_EQ(help({"./none.so"}), all);
  EXPECT_EQ(help({"dance"}), all);
}

TEST(Cli, HelpSaysHowAnOptionIsTyped) {
  const auto help = [](std::vector<std::string> verb) {
    verb.push_back("--help");
    return run(kaz(verb)).out;
  };
  const std::pair<std::vector<std::string>, const char*> cases[] = {
      {{"flash", "write"}, "\n  --no-start  "},
      {{"mcu", "run"}, "\n  --trace[=FILE]  "},
      {{"mcu", "run"}, "\n  --max-insns N: 1 to 999999999999999999\n"},
      {{"mcu", "run"}, "(needs --flat)"},
      {{"mcu", "run"}, "\n  --at ADDRESS: 0 to 0xffffff  "},
      {{"demo"}, "\n  --mcu h8|native  "},
      {{"demo"}, "\n  --supply V: 1 to 20 V  "},
      {{"demo"}, "(default: 10)"},
      {{"sim"}, ": 0.000001 to 0.002 kg m2"},
      {{"conformance"}, "\n  --json [FILE]  "},
      // A positional argument that is also an option
      {{"recover"}, "\n  PORT  "},
      {{"recover"}, "\n  --robot KIND:PATH  "}};
  for (const auto& [verb, part] : cases)
    EXPECT_NE(help(verb).find(part), std::string::npos) << part << "\n" << help(verb);
  EXPECT_EQ(run(kaz({"help", "mcu", "run"})).out, help({"mcu", "run"}));
  EXPECT_EQ(run(kaz({"help", "run", "navigate"})).out, help({"run", "navigate"}));
}

TEST(Cli, EachHelpHasTheExitStatusBeforeTheExamples) {
  for (const auto& verb : {"demo", "flash write", "bench motor", "status", "evaluate"}) {
    const std::string help = run({"/bin/sh", "-c", kaz({}).front() + " " + verb + " --help"}).out;
    const auto status = help.find("\nExit status of every verb: 0 ");
    ASSERT_NE(status, std::string::npos) << help;
    EXPECT_LT(status, help.find("\nExamples:\n")) << help;
  }
}

TEST(Cli, ADryRunOfFlashingNeedsNoPort) {
  const Finished looked = run({"/bin/sh", "-c",
                               kaz({}).front() + " flash write $(dirname " + kaz({}).front() +
                                   ")/../firmware/kaz.mot --dry-run"});
  EXPECT_EQ(looked.exit_code, 0) << looked.err;
  EXPECT_NE(looked.out.find(" bytes in EB"), std::string::npos) << looked.out;
}

// What can be seen in the file alone is seen without a port.
TEST(Cli, ADryRunOfFlashingRefusesDamagedAndForeignImages) {
  const std::string image = "$(dirname " + kaz({}).front() + ")/../firmware/kaz.mot";
  for (const auto& [make, options, part] :
       {std::tuple<std::string, std::string, std::string>{"sed 500,520d " + image, "",
                                                          "the image is damaged"},
        {"head -c 4096 /dev/zero", "--format raw --at 0x2000",
         "is not an application for a Kaz board"}}) {
    const Finished looked =
        run({"/bin/sh", "-c",
             "f=$(mktemp) && " + make + " > $f && " + kaz({}).front() +
                 " flash write $f --dry-run " + options + "; status=$?; rm $f; exit $status"});
    EXPECT_EQ(looked.exit_code, 2) << looked.out;
    EXPECT_NE(looked.err.find(part), std::string::npos) << looked.err;
  }
}

TEST(Cli, AnErrorIsInTheJsonToo) {
  const std::vector<std::vector<std::string>> all{
      {"status", "/nowhere"},
      {"fuzz", "--port", "/nowhere"},
      {"flash", "info", "--port", "/nowhere"},
      {"recover", "--port", "/nowhere"},
      {"run", "stand", "--robot", "serial:/nowhere"},
      {"replay", "/nowhere"},
      {"compare", "/nowhere", "/nowhere"},
      {"mcu", "run", "/nowhere"},
      {"bus", "scan", "--port", "/nowhere"},
  };
  for (std::vector<std::string> words : all) {
    words.emplace_back("--json");
    SCOPED_TRACE(words.front());
    const Finished none = run(kaz(words));
    const auto json = nlohmann::json::parse(none.out, nullptr, false);
    ASSERT_TRUE(json.is_object()) << none.out;
    EXPECT_NE(json.value("error", "").find("/nowhere"), std::string::npos) << none.out;
    EXPECT_EQ(json.value("exit_code", none.exit_code), none.exit_code);
    EXPECT_NE(none.err, "");
  }
}

TEST(Cli, ATurnWithinItsToleranceIsRefused) {
  const Finished turn = run(kaz({"run", "turn-left", "--set", "angle=1"}));
  EXPECT_EQ(turn.exit_code, 2);
  EXPECT_NE(turn.err.find("a number from 5 to 360"), std::string::npos) << turn.err;
}

TEST(Cli, BashCompletesVerbsAndOptions) {
  // In bash itself: the words after "kaz", the last of them to be completed.
  const auto completed = [](const std::string& words, int last) {
    const std::string script =
        "source <(" + kaz({}).front() + " completion bash); COMP_WORDS=(kaz " + words +
        "); COMP_CWORD=" + std::to_string(last) + "; _kaz; echo \"${COMPREPLY[@]}\"";
    return run({"/bin/bash", "-c", script}).out;
  };
  EXPECT_EQ(completed("mcu comp", 2), "compare\n");
  EXPECT_EQ(completed("mcu compare --tic", 3), "--ticks\n");
  EXPECT_EQ(completed("run track-ball --cam", 3), "--camera\n");
  EXPECT_EQ(completed("demo --mcu ''", 3), "h8 native\n");
  EXPECT_EQ(completed("run tr", 2), "track-ball\n");
  EXPECT_EQ(completed("man mcu co", 3), "compare\n");
}

TEST(Cli, ManualPagesAreMadeOfTheHelp) {
  const Finished page = run(kaz({"man", "mcu", "compare"}));
  EXPECT_EQ(page.exit_code, 0) << page.err;
  EXPECT_EQ(page.out.rfind(".TH KAZ-MCU-COMPARE 1", 0), 0u) << page.out;
  EXPECT_NE(page.out.find("\\-\\-ticks"), std::string::npos) << page.out;
  EXPECT_NE(page.out.find("Exit status: 0 equal, 1 "), std::string::npos) << page.out;
  EXPECT_NE(page.out.find(".SH EXAMPLES\n"), std::string::npos) << page.out;
  EXPECT_NE(run(kaz({"man", "mcu", "run"})).out.find("kaz mcu run [OPTIONS] IMAGE\n"),
            std::string::npos);
  EXPECT_TRUE(one_sentence(run(kaz({"man", "walk"})), 2, {"no verb `walk`"}));
}

TEST(Cli, VersionSucceeds) {
  const Finished finished = run(kaz({"--version"}));
  EXPECT_EQ(finished.exit_code, 0);
  EXPECT_EQ(finished.out.rfind("kaz ", 0), 0u) << finished.out;
}

TEST(Cli, WrongOption) {
  EXPECT_TRUE(one_sentence(run(kaz({"demo", "--sed", "7"})), 2, {"--sed", "kaz demo --help"}));
  EXPECT_TRUE(one_sentence(run(kaz({"demo", "--seed", "many"})), 2, {"--seed", "many"}));
  EXPECT_TRUE(one_sentence(run(kaz({"dance"})), 2, {"dance", "kaz --help"}));
  EXPECT_TRUE(one_sentence(run(kaz({"run", "fly"})), 2, {"fly", "track-ball"}));
  EXPECT_TRUE(one_sentence(run(kaz({"demo", "--mcu", "z80"})), 2, {"z80", "h8", "native"}));
  EXPECT_TRUE(
      one_sentence(run(kaz({"run", "track-ball", "--robot", "usb:1"})), 2, {"usb:1", "serial:"}));
}

// Instead of being ignored.
TEST(Cli, OptionsThatCannotActAreRefused) {
  const TemporaryFolder folder;
  write_file(folder / "image.mot", "S10510001234A4\nS9031000EC\n");
  write_file(folder / "reset.mot", "S107000000001000E8\nS9031000EC\n");
  const struct {
    std::vector<std::string> arguments, words;
  } cases[] = {
      {{"mcu", "compare", "--wire", "--engine", "reference"}, {"--engine", "--wire"}},
      {{"mcu", "compare", "--wire", "--ticks", "5"}, {"--ticks", "--wire"}},
      {{"mcu", "run", folder / "image.mot", "--at", "5"}, {"image.mot", "--at", "raw"}},
      {{"mcu", "run", folder / "reset.mot", "--coverage", folder / "lcov"},
       {"--coverage", "COFF or ELF"}},
      {{"mcu", "run", folder / "reset.mot", "--input", folder / "none"}, {"--input", "none"}},
      {{"fuzz", "--image", "nope"}, {"--image", "h8"}},
      {{"fuzz", "--address", "3"}, {"--address", "port"}},
      {{"fuzz", "--wear-flash"}, {"--wear-flash", "port"}},
      {{"fuzz", "--allow-motion"}, {"--allow-motion", "port"}},
      {{"fuzz", "--seconds", "1", "--cases", "3"}, {"--seconds", "--cases"}},
      {{"fuzz", "--target", folder / "image.mot"}, {"image.mot", "--allow-motion"}},
      {{"flash", "info", "--port", "board", "--reset", "manual"}, {"--reset"}},
      {{"conformance", "--port", "board", "--bench"}, {"--bench"}},
      {{"vision", "run", "--in", folder / "a", "--out", "out", "--view", "60", "--calibration",
        "c"},
       {"--view", "--calibration"}},
      {{"vision", "run", "--in", folder / "a", "--out", "out", "--radius", "25"}, {"--radius"}},
      {{"vision", "run", "--in", "v4l2:a,b", "--calibration", "c", "--out", "out", "--modules",
        "depth", "--radius", "0.03"},
       {"--radius", "only valid with module color", "--modules depth"}},
      {{"run", "track-ball", "--goal", "1,0"}, {"--goal is only valid with navigate"}},
      {{"evaluate", "stand", "--out", folder / "lcov", "--obstacles", "4"},
       {"--obstacles is only valid with navigate"}},
      {{"conformance", "--virtual", "native", "--allow-motion"},
       {"--allow-motion is only valid with a board at a port", "every case"}},
      {{"conformance", "--virtual", "native", "--allow-flash"}, {"--allow-flash"}},
      {{"conformance", "--list", "--port", "board"}, {"--list", "--robot"}},
      {{"bench", "motor", "--allow-motion"}, {"--allow-motion", "--robot"}},
      {{"mcu", "run", folder / "reset.mot", "--flat", "--crystal", "1e6"}, {"--crystal", "--flat"}},
      {{"mcu", "run", folder / "reset.mot", "--gdb", "-", "--max-states", "5"},
       {"--gdb", "--max-states"}},
      {{"bench", "motor", "--port", "board", "--stand", "ctl:board.ctl", "--disc", "1e-4"},
       {"--disc", "--stand manual"}},
      {{"flash", "info", "--port", "board", "--writer", "x"}, {"--writer"}},
      {{"flash", "run", "--port", "board", "--boot-baud", "4800"}, {"--boot-baud"}},
      {{"run", "stand", "--robot", "serial:none", "--seed", "3"},
       {"--seed has no effect: stand uses no random numbers", "leave --seed out"}},
      {{"run", "stand", "--options", "--seed", "3"},
       {"--seed is not valid with --options", "leave --seed or --options out"}},
      {{"sim", "--write-calibration", folder / "lcov", "--record", folder / "r.mcap"},
       {"--record needs --serial"}},
      {{"sim", "--write-calibration", folder / "lcov", "--fast"}, {"--fast needs --serial"}},
      {{"sim", "--serial", "p", "--eyes", "real"},
       {"--eyes needs --cameras PATH, --record FILE or --view"}},
      {{"calibrate", "joints", "--gauge-error", "1"},
       {"--gauge-error is only valid with --gauge NAME=DEGREES"}},
      {{"calibrate", "joints", "--yes"},
       {"--yes is only valid with a robot at a port", "leave --yes out"}},
      {{"calibrate", "joints", "--robot", "serial:none", "--only", "gauge", "--yes"},
       {"--yes is not valid with a gauge", "leave --yes out"}},
      {{"calibrate", "joints", "--dry-run", "--json"}, {"--json is not valid with --dry-run"}},
      {{"calibrate", "joints", "--dry-run", "--out", folder / "lcov"}, {"--out", "--dry-run"}},
      {{"evaluate", "--seed", "3", "merge", folder / "a", folder / "b", "--out", folder / "lcov"},
       {"--seed is not valid before merge"}},
      {{"replay", folder / "a", "--view", "--json"}, {"--json", "--view"}},
      {{"compare", folder / "a", folder / "b", "--all", "--json"}, {"--all", "--json"}},
      {{"bench", "all", "--filter", "^link", "--joint", "l_knee"},
       {"--joint is only valid with motor measurements", "--filter ^link"}},
      {{"bench", "motor", "--port", "none", "--allow-motion", "--supply", "8"},
       {"--supply needs --stand"}},
  };
  for (const auto& one : cases) {
    auto arguments = one.arguments;
    if (arguments[0] == "fuzz") arguments.insert(arguments.end(), {"--out", folder / "failing"});
    EXPECT_TRUE(one_sentence(run(kaz(arguments)), 2, one.words)) << arguments.back();
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "lcov"));
}

// One spelling in every verb: --robot KIND:PATH. --port is an alias of it.
TEST(Cli, EveryVerbTakesRobotKindPath) {
  const TemporaryFolder folder;
  const std::vector<std::string> pendulum{"bench",    "pendulum", "--mass", "0.3",
                                          "--length", "0.15",     "--arm",  "0.02"};
  const std::vector<std::vector<std::string>> boards{
      {"status"},        {"recover"},
      {"flash", "info"}, {"bench", "link"},
      {"conformance"},   {"fuzz", "--cases", "1", "--allow-motion"},
      {"serve-port"},    {"can-bridge", "--can", "none"}},
      buses{{"bus", "scan", "--ids", "1"}, {"conformance"}, pendulum};
  const auto run_at = [&](std::vector<std::string> words, const char* option,
                          const std::string& robot) {
    words.insert(words.end(), {option, robot});
    if (words[0] == "bench" || words[0] == "fuzz")
      words.insert(words.end(), {"--out", folder / "out"});
    return run(kaz(words));
  };
  const std::string none = folder / "none";
  for (const auto& verb : boards) {
    SCOPED_TRACE(verb.back());
    for (const char* option : {"--robot", "--port"})
      EXPECT_TRUE(one_sentence(run_at(verb, option, "serial:" + none), 3, {none}));
    // The conformance suite has cases for servos, too.
    if (verb[0] == "conformance") continue;
    EXPECT_TRUE(one_sentence(run_at(verb, "--robot", "feetech:" + none), 2,
                             {"--robot feetech:" + none + ": a servo bus", "kaz bus status"}));
  }
  for (const auto& verb : buses) {
    SCOPED_TRACE(verb.back());
    for (const char* kind : {"feetech:", "dynamixel:"})
      EXPECT_TRUE(one_sentence(run_at(verb, "--robot", kind + none + "@57600"), 3, {none}));
  }
  EXPECT_TRUE(one_sentence(run_at(pendulum, "--robot", none), 2,
                           {"its protocol is missing; give feetech:" + none}));
}

// A mistyped engine must not lead to --allow-motion.
TEST(Cli, AFuzzersTargetThatIsNotThereIsNoRobot) {
  const TemporaryFolder folder;
  for (const auto& [target, words] :
       {std::pair<std::string, std::vector<std::string>>{
            "natvie", {"no such port: natvie", "; did you mean native?"}},
        {folder / "none", {"no such port: " + folder / "none"}}}) {
    const Finished end = run(kaz({"fuzz", "--target", target, "--out", folder / "failing"}));
    EXPECT_TRUE(one_sentence(end, 3, words)) << end.err;
    EXPECT_EQ(end.err.find("--allow-motion"), std::string::npos) << end.err;
  }
}

TEST(Cli, ACaseWithoutAByteIsNotReplayed) {
  const TemporaryFolder folder;
  write_file(folder / "empty", "");
  EXPECT_TRUE(one_sentence(run(kaz({"fuzz", "--replay", folder / "empty"})), 2,
                           {folder / "empty", "is empty", "give a case"}));
}

// Before anybody opens a browser on an empty page.
TEST(Cli, WithoutThePageOfViewTheTerminalNamesTheCommandForIt) {
  namespace fs = std::filesystem;
  const TemporaryFolder folder;
  const fs::path share = fs::path(kaz({}).front()).parent_path().parent_path() / "share/kaz";
  const auto said = [&folder] {
    const std::vector<std::string> command =
        kaz({"run", "stand", "--mcu", "native", "--view", "127.0.0.1:0"});
    std::vector<std::string> words{"/usr/bin/env", "KAZ_DATA=" + folder.path()};
    words.insert(words.end(), command.begin(), command.end());
    const Finished finished = run(words);
    EXPECT_EQ(finished.exit_code, 0) << finished.err;
    return finished.err;
  };
  for (const char* part : {"robot", "worlds"})
    fs::create_directory_symlink(fs::canonical(share / part), folder / part);
  const std::string dev = fs::canonical(share / "worlds").parent_path().parent_path() / "tools/dev";
  const std::string built = said();
  EXPECT_TRUE(built.starts_with("kaz run: the page of --view is not built; build it with: " + dev +
                                " build kaz_page\n"))
      << built;
  // An installed program has no tree.
  fs::remove(folder / "worlds");
  fs::copy(share / "worlds", folder / "worlds", fs::copy_options::recursive);
  const std::string installed = said();
  EXPECT_NE(installed.find("is not in " + folder.path() + "/view: Kaz was built without npm"),
            std::string::npos)
      << installed;
}

TEST(Cli, AloneItListsItsVerbs) {
  const Finished alone = run(kaz({}));
  EXPECT_EQ(alone.exit_code, 2);
  EXPECT_TRUE(alone.out.empty()) << alone.out;
  EXPECT_EQ(alone.err, run(kaz({"--help"})).out);
  EXPECT_NE(alone.err.find("\n  conformance "), std::string::npos) << alone.err;
}

TEST(Cli, WrongNamesGetTheNearest) {
  const std::pair<std::vector<std::string>, const char*> cases[] = {
      {{"demo", "--durations", "3"}, "there is no option --durations; did you mean --duration?"},
      {{"demo", "--nonsense=3"}, "there is no option --nonsense; see"},
      {{"--jsn"}, "there is no option --jsn; see"},
      {{"--seed", "3", "demo"}, "give --seed after the verb demo"},
      {{"dmo"}, "there is no verb `dmo`; did you mean demo?"},
      {{"mcu", "rnu", "--help"}, "there is no verb `rnu`; did you mean run?"},
      {{"help", "walk"}, "there is no verb `walk`; see"},
      {{"help", "bench", "list", "motor"}, "unexpected: `motor`"},
      {{"mcu"}, "the verb is missing; give one of: run, compare"},
      {{"evaluate", "mrge", "a", "b", "--out", "y"}, "unexpected: `a b`"},
      {{"demo", "sim", "status"}, "unexpected: `sim status`"}};
  for (const auto& [arguments, message] : cases) EXPECT_TRUE(refuses(arguments, {message}));
}

// The words around the option, its value and the valid values are CLI11's.
TEST(Cli, WrongValuesAreRefusedWithTheValidOnes) {
  const std::pair<std::vector<std::string>, std::vector<std::string>> cases[] = {
      {{"demo", "--supply", "30"}, {"--supply", "30", "1 to 20 V"}},
      {{"demo", "--supply", "much"}, {"--supply", "much", "1 to 20 V"}},
      {{"demo", "--mcu", "h9"}, {"--mcu", "h9", "h8", "native"}},
      {{"demo", "--eye-width", "wide"}, {"--eye-width", "wide", "320", "640"}},
      {{"demo", "--seed", "1e3"}, {"--seed", "1e3", "whole number", "0 to 999999999999999999"}},
      {{"demo", "--physics-step", "1ms"}, {"--physics-step", "1ms", "a number"}},
      {{"flash", "write", "x", "--no-start=2"}, {"no-start"}},
      {{"demo", "--seed"}, {"--seed", "N"}},
      {{"demo", "--out", ""}, {"--out", "empty"}},
      {{"run", "search-ball", "--duration"}, {"--duration", "SECONDS"}},
      {{"run", "stand", "--goal", "1,0", "--goal", "2,0"}, {"--goal", "2"}},
      {{"demo", "--seed", "1", "--seed", "2"}, {"--seed", "2"}},
      {{"evaluate", "stand", "--friction", "0.6"}, {"--friction", "2"}},
      {{"status", "a", "--address", "15"}, {"--address", "15", "whole number", "1 to 14"}},
      {{"flash", "erase", "--port", "a", "--blocks", "7,99"}, {"--blocks", "1 to 5", "7 to 9"}},
      {{"flash", "read", "--port", "a", "--out", "b", "--from", "0x20000"},
       {"--from", "0x20000", "0 to 0x1ffff"}},
      {{"evaluate", "stand", "--radii", "5"}, {"--radii", "5", "0.005 to 0.5 m"}},
      {{"evaluate", "stand", "--supply", "0", "5"}, {"--supply", "not 0", "1 to 20 V"}},
      {{"mcu", "compare", "--ticks", "0"}, {"--ticks", "1 to 1000000000000"}},
      {{"mcu", "run", "image", "--max-states", "0"}, {"--max-states", "1 to 999999999999999999"}},
      {{"monitor"}, {"--robot"}},
      {{"mcu", "run", "image", "--format", "hex"}, {"--format", "hex", "coff,elf,ihex,raw,srec"}},
      {{"bench", "link", "--mcu", "h8", "--port", "a"}, {"--robot", "--mcu"}},
      {{"mcu", "run", "image", "--mode", "4"}, {"--mode", "4", "2,3"}},
      {{"mcu", "run", "image", "--profile-format", "xml"},
       {"--profile-format", "xml", "text,json,callgrind"}},
      {{"mcu", "run", "image", "--semihost"}, {"--semihost", "--flat"}}};
  for (const auto& [arguments, words] : cases) EXPECT_TRUE(refuses(arguments, words));
  for (const char* value : {"maybe", "2", "-1", "yes", "on", "1.5"})
    EXPECT_TRUE(refuses({"demo", std::string("--imu=") + value}, {"imu"}));
  // What a motor stand does not have.
  for (const auto& [option, what] : {std::pair{"--world=ball", "world"},
                                     {"--eyes=real", "eyes"},
                                     {"--eye-width=640", "eyes"},
                                     {"--renderer=raster", "eyes"},
                                     {"--cameras=eyes", "eyes"},
                                     {"--dynamics=exact", "robot"},
                                     {"--robot-file=x.urdf", "robot"},
                                     {"--strict", "robot"},
                                     {"--verbose", "robot"},
                                     {"--physics-step=0.5", "robot"},
                                     {"--no-imu", "IMU"},
                                     {"--imu", "IMU"}})
    EXPECT_TRUE(one_sentence(run(kaz({"sim", "--serial", "nowhere", "--stand", option})), 2,
                             {std::string("a motor stand has no ") + what + "; leave "}));
  EXPECT_TRUE(one_sentence(run(kaz({"status", "no-such-port"})), 3, {"no-such-port"}));
}

// Nothing to do is no success.
TEST(Cli, EmptyJobsAreWrongUsage) {
  const TemporaryFolder folder;
  EXPECT_TRUE(one_sentence(run(kaz({"mcu", "compare", "--ticks", "0"})), 2, {"--ticks"}));
  EXPECT_TRUE(one_sentence(run(kaz({"fuzz", "--cases", "0"})), 2, {"--cases"}));
  for (const char* metres : {"0", "0.02", "-0.04"}) {
    const Finished still = run(kaz({"run", "go-forward", "--mcu", "native", "--world", "empty",
                                    "--set", std::string("distance=") + metres}));
    EXPECT_EQ(still.exit_code, 2) << metres << still.out;
    EXPECT_NE(still.err.find("at least 0.05 m"), std::string::npos) << still.err;
  }
}

// More digits than the type has would be taken as its largest number.
TEST(Cli, NumbersBeyondTheirTypeAreRefused) {
  const std::string many = "99999999999999999999";
  for (const auto& arguments : std::vector<std::vector<std::string>>{
           {"mcu", "compare", "--ticks", many},
           {"mcu", "compare", "--seed", many},
           {"mcu", "compare", "--state-every", many},
           {"mcu", "compare", "--wire", "--conversations", many},
           {"mcu", "compare", "--wire", "--first", many},
           {"mcu", "run", "image", "--max-states", many},
           {"fuzz", "--cases", many},
           {"fuzz", "--seed", many},
           {"bench", "link", "--seed", many},
           {"bench", "fit", "report", "--seed", many},
           {"conformance", "--virtual", "native", "--seed", many},
           {"replay", "file", "--seed", many},
           {"evaluate", "stand", "--out", "out", "--episodes", many},
           {"evaluate", "stand", "--out", "out", "--seed", many},
           {"demo", "--seed", many}})
    EXPECT_TRUE(one_sentence(run(kaz(arguments)), 2, {many})) << arguments.back();
  EXPECT_TRUE(one_sentence(run(kaz({"mcu", "compare", "--ticks", "1e3"})), 2, {"--ticks", "1e3"}));
  EXPECT_TRUE(one_sentence(run(kaz({"fuzz", "--seconds", "inf"})), 2, {"inf"}));
}

// Whatever the name of a file holds.
TEST(Cli, EachErrorIsOneLine) {
  EXPECT_TRUE(one_sentence(run(kaz({"replay", "a\nb\x1b[2J"})), 2, {"a b\\x1b[2J"}));
  EXPECT_TRUE(one_sentence(run(kaz({"dan\nce"})), 2, {"dan ce"}));
  EXPECT_TRUE(one_sentence(run(kaz({"run", "a\nb"})), 2, {"a b"}));
  EXPECT_TRUE(one_sentence(run(kaz({"status", "--port", "no\nport"})), 3, {"no port"}));
  EXPECT_TRUE(one_sentence(run(kaz({"flash", "info", "--port", "no\nport"})), 3, {"no port"}));
}

TEST(Cli, FuzzSaysWhatItTriedAndThatNothingWasWrong) {
  const TemporaryFolder folder;
  const Finished said = run(kaz({"fuzz", "--cases", "3", "--out", folder / "failing"}));
  EXPECT_EQ(said.exit_code, 0) << said.err;
  EXPECT_TRUE(std::regex_search(
      said.out,
      std::regex("tried: 3 cases in [0-9.]+ s \\([0-9.]+ s on the board's clock\\); sent: "
                 "[0-9]+ frames and [0-9]+ damaged frames; received: [0-9]+ replies")))
      << said.out;
  EXPECT_TRUE(std::regex_search(
      said.out, std::regex("\n[0-9]+ features seen \\(distinct reactions of the board, ")))
      << said.out;
  EXPECT_TRUE(said.out.ends_with("\nno case failed\n")) << said.out;
  const Finished json = run(kaz({"fuzz", "--cases", "3", "--out", folder / "failing", "--json"}));
  EXPECT_NE(json.out.find("\"ok\": true"), std::string::npos) << json.out;
  EXPECT_NE(json.out.find("\"command\": \"kaz fuzz --cases 3 "), std::string::npos) << json.out;
}

TEST(Cli, MissingPort) {
  const TemporaryFolder folder;
  const Finished finished = run(kaz({"run", "track-ball", "--robot", "serial:" + (folder / "none"),
                                     "--camera", folder / "eyes", "--out", folder / "out"}));
  EXPECT_TRUE(one_sentence(finished, 3, {folder / "none"}));
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

// The other end of a serial port, answering with whatever the test likes.
class FakePort {
 public:
  explicit FakePort(std::string answer) : answer_(std::move(answer)) {
    std::array<char, 128> name{};
    EXPECT_EQ(openpty(&master_, &slave_, name.data(), nullptr, nullptr), 0);
    path_ = name.data();
    thread_ = std::thread([this] { serve(); });
  }
  ~FakePort() {
    stop_ = true;
    thread_.join();
    close(master_);
    close(slave_);
  }
  const std::string& path() const { return path_; }

 private:
  void serve() {
    std::array<char, 256> buffer{};
    while (!stop_) {
      fd_set readable;
      FD_ZERO(&readable);
      FD_SET(master_, &readable);
      timeval patience{0, 20000};
      if (select(master_ + 1, &readable, nullptr, nullptr, &patience) <= 0) continue;
      if (read(master_, buffer.data(), buffer.size()) > 0 && !answer_.empty()) {
        if (write(master_, answer_.data(), answer_.size()) < 0) return;
      }
    }
  }
  std::string answer_, path_;
  int master_ = -1, slave_ = -1;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

TEST(Cli, PortWithNothingBehindIt) {
  const TemporaryFolder folder;
  const FakePort port("");
  const Finished finished = run(kaz({"run", "track-ball", "--robot", "serial:" + port.path(),
                                     "--camera", folder / "eyes", "--out", folder / "out"}));
  EXPECT_TRUE(one_sentence(finished, 3, {port.path()}));
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

TEST(Cli, PortThatIsNoKazBoard) {
  const TemporaryFolder folder;
  const FakePort port("login: ");
  const Finished finished = run(kaz({"run", "track-ball", "--robot", "serial:" + port.path(),
                                     "--camera", folder / "eyes", "--out", folder / "out"}));
  // 6c 6f 67: what came, in hex.
  EXPECT_TRUE(one_sentence(finished, 3, {port.path(), "not a Kaz board", "6c 6f 67"}));
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

TEST(Cli, CorruptImage) {
  const TemporaryFolder folder;
  // S1, 5 bytes: address 1000, data 12 34, checksum should be a4.
  write_file(folder / "bad.mot", "S1051000123400\nS9031000EC\n");
  for (const auto& arguments : {kaz({"mcu", "run", folder / "bad.mot"}),
                                kaz({"mcu", "compare", "--image", folder / "bad.mot"})}) {
    EXPECT_TRUE(one_sentence(run(arguments), 2, {folder / "bad.mot", "1", "checksum"}));
  }
  EXPECT_TRUE(one_sentence(run(kaz({"mcu", "run", folder / "none.mot"})), 2, {"none.mot"}));
}

// Of another robot, which has no eyes: what needs none runs, what does says so before anything moves.
TEST(Cli, RobotWithoutEyes) {
  const auto with_arm = [](const std::string& behavior) {
    return run(
        kaz({"run", behavior, "--robot-file", "sim/robots/arm/arm.urdf", "--mcu", "native"}));
  };
  const Finished stands = with_arm("stand");
  EXPECT_EQ(stands.exit_code, 0) << stands.err;
  EXPECT_NE(stands.out.find("the robot stands"), std::string::npos) << stands.out;
  // By the joint's own name, and no posture of Kaz.
  EXPECT_NE(stands.out.find(" has the largest error"), std::string::npos) << stands.out;
  EXPECT_EQ(stands.out.find("neck"), std::string::npos) << stands.out;
  EXPECT_TRUE(one_sentence(with_arm("track-ball"), 2, {"no eyes", "left_eye", "right_eye"}));
  EXPECT_TRUE(one_sentence(run(kaz({"run", "stand", "--set", "posture=home", "--robot-file",
                                    "sim/robots/arm/arm.urdf", "--mcu", "native"})),
                           2, {"home", "Kaz", "shoulder", "posture=keep"}));
}

// What its channel of the servo board would never let it reach; the sentence ends with what to do.
TEST(Cli, LimitsBeyondTheChannel) {
  const TemporaryFolder folder;
  for (const char* name : {"motor.xml", "sensors.xml"})
    write_file(folder / name, read_file(std::string("sim/robots/arm/") + name));
  std::string arm = read_file("sim/robots/arm/arm.urdf");
  arm.replace(arm.find("upper=\"1.5\""), 11, "upper=\"1.9\"");
  write_file(folder / "arm.urdf", arm);
  EXPECT_TRUE(one_sentence(
      run(kaz({"run", "stand", "--robot-file", folder / "arm.urdf"})), 2,
      {folder / "arm.urdf", "`turn`", "-1.500 to 1.900 rad", "-1.571 to 1.571", "channel 0",
       "the first joint has channel 0, the second joint has channel 1\n"}));
}

TEST(Cli, DurationThatIsNone) {
  const TemporaryFolder folder;
  for (const char* wrong : {"5s", "-1", "nan"})
    EXPECT_TRUE(one_sentence(run(kaz({"demo", "--duration", wrong, "--out", folder / "out"})), 2,
                             {"--duration", wrong, "seconds", "0.1"}));
}

TEST(Cli, DurationSaidTwice) {
  EXPECT_TRUE(one_sentence(run(kaz({"run", "track-ball", "--duration", "5", "--set", "seconds=9"})),
                           2, {"--duration 5", "--set seconds=9", "leave one out"}));
}

TEST(Cli, SettingGivenTwice) {
  EXPECT_TRUE(one_sentence(run(kaz({"run", "catch-ball", "--set", "tries=2", "--set", "tries=3"})),
                           2, {"tries is set twice"}));
}

// The words after an option that may be repeated are not its values.
TEST(Cli, AnOptionBeforeTheBehavior) {
  EXPECT_TRUE(
      one_sentence(run(kaz({"run", "--set", "seconds=60", "--set", "tries=1.5", "catch-ball"})), 2,
                   {"1.5", "a whole number from 1 to 20"}));
  EXPECT_TRUE(
      one_sentence(run(kaz({"evaluate", "--set", "seconds=0", "search-ball", "--out", "none"})), 2,
                   {"seconds", "0.1 to 3600"}));
  EXPECT_TRUE(
      one_sentence(run(kaz({"evaluate", "--colors", "red,pink", "search-ball", "--out", "none"})),
                   2, {"pink", "green"}));
  EXPECT_TRUE(
      one_sentence(run(kaz({"evaluate", "--radii", "0.02,9", "search-ball", "--out", "none"})), 2,
                   {"--radii", "9"}));
}

// What would have no effect is refused.
TEST(Cli, OptionsOfAnotherKindOfRobot) {
  for (const std::vector<std::string>& option :
       std::vector<std::vector<std::string>>{{"--world", "ball"},
                                             {"--mcu", "h8"},
                                             {"--imu"},
                                             {"--eye-width", "320"},
                                             {"--restore-every", "1"}}) {
    std::vector<std::string> words{"run", "stand", "--robot", "serial:none"};
    words.insert(words.end(), option.begin(), option.end());
    EXPECT_TRUE(one_sentence(run(kaz(words)), 2, {"virtual robot; leave " + option[0] + " out"}));
  }
  EXPECT_TRUE(one_sentence(run(kaz({"run", "stand", "--address", "1"})), 2,
                           {"--address", "serial:PATH", "virtual board"}));
  EXPECT_TRUE(one_sentence(run(kaz({"demo", "--mcu", "native", "--image", "none"})), 2,
                           {"--image", "--mcu h8"}));
  EXPECT_TRUE(one_sentence(run(kaz({"demo", "--imu", "--no-imu"})), 2, {"--imu", "--no-imu"}));
  const std::vector<std::vector<std::string>> incomplete{{"--motor", "m", "--stand"},
                                                         {"--motor-file", "f", "--stand"},
                                                         {"--disc", "1e-3", "--stand"},
                                                         {"--record-pictures", "--record"}};
  for (const auto& words : incomplete) {
    std::vector<std::string> sim{"sim", "--serial", "none"};
    sim.insert(sim.end(), words.begin(), words.end() - 1);
    EXPECT_TRUE(one_sentence(run(kaz(sim)), 2, {words.front(), words.back()}));
  }
}

// Known before the world is loaded, and said of the path that was typed.
TEST(Cli, SimulatorWithoutAFolder) {
  const TemporaryFolder folder;
  const std::string none = folder / "none/b";
  for (const char* option : {"--serial", "--cameras", "--memory", "--record"}) {
    std::vector<std::string> words{"sim", option, none};
    if (option != std::string("--serial"))
      words.insert(words.end(), {"--serial", folder / "board"});
    EXPECT_TRUE(one_sentence(run(kaz(words)), 2, {option, none, "no folder " + (folder / "none")}));
  }
}

TEST(Cli, PhysicsStepThatDoesNotFit) {
  const TemporaryFolder folder;
  EXPECT_TRUE(
      one_sentence(run(kaz({"run", "stand", "--physics-step", "3", "--out", folder / "out"})), 2,
                   {"3 ms", "give 0.125, 0.25, 0.5, 1, 2 or 4"}));
}

TEST(Cli, WorldWithTypingError) {
  const TemporaryFolder folder;
  write_file(folder / "bad.sdf",
             "<?xml version='1.0'?>\n<sdf version='1.9'>\n  <world name='w'>\n"
             "    <modle name='ball'/>\n  </world>\n</sdf>\n");
  const Finished finished =
      run(kaz({"demo", "--world", folder / "bad.sdf", "--out", folder / "out"}));
  EXPECT_TRUE(one_sentence(finished, 2, {folder / "bad.sdf", "4", "modle"}));
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
  EXPECT_TRUE(one_sentence(run(kaz({"demo", "--world", "moon"})), 2, {"moon", "ball"}));
}

TEST(Cli, PlaceForResultsInTheWay) {
  const TemporaryFolder folder;
  write_file(folder / "out", "a file");
  const Finished finished = run(kaz({"demo", "--duration", "1", "--out", folder / "out"}));
  EXPECT_TRUE(one_sentence(finished, 2, {folder / "out", "--out"}));
  EXPECT_EQ(read_file(folder / "out"), "a file");
}

}  // namespace
}  // namespace kaz::test
