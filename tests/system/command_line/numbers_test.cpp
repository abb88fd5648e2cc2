// Numbers on the command line: finite, in decimal, within their type, for every option of every verb.
// SPDX-License-Identifier: Apache-2.0
#include <regex>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/system/command_line/process_testing.h"

namespace kaz::test {
namespace {

struct TypedOption {
  std::string name;   // "--supply"
  std::string value;  // name of the value in the help (metavar), such as "V" or "FROM TO"
  std::string line;   // of the help
};

// Parses the lines "  --supply V: 1 to 20 V  supply voltage of the board".
std::vector<TypedOption> options_of(const std::string& help) {
  std::vector<TypedOption> options;
  const std::regex one("^  (?:-[a-z], ?)?(--[a-z-]+) (\\S+(?: \\S+)*)(?:  .*)?$");
  std::istringstream lines(help);
  std::smatch found;
  for (std::string line; std::getline(lines, line);)
    if (std::regex_match(line, found, one)) {
      const std::string value = found[2];
      options.push_back({found[1], value.substr(0, value.find(": ")), line});
    }
  return options;
}

// Texts of any kind, or what another test tries: a duration (cli_test.cpp), a part of parts, a place in a
// picture (arguments_test.cpp, vision_verb_test.cpp).
bool is_text(const std::string& value) {
  static const std::string kTexts =
      " FILE [FILE] DIR PATH PORT MODEL NAME NAME|FILE NAME,NAME NAMES PNG PATTERN PICTURE SOURCE "
      "CAMERA "
      "ROBOT HOW NAME=VALUE NAME=DEGREES REGEX LIST BEGIN,END X,Y,W,H COLUMNSxROWS I/N "
      "PORT|PATH|- KIND:PATH native|h8|KIND:PATH "
      "LEFT,RIGHT gain[=V,V]|mass[=V,V] "
      "X,Y[,DEGREES]|ball reduced|exact|quickN ctl:PATH|manual sim|PORT HOST:PORT OPTIONS ";
  return kTexts.find(" " + value.substr(0, value.find(" ...")) + " ") != std::string::npos;
}

// Values are converted before --help is answered, and nothing runs.
bool takes(const std::vector<std::string>& verb, const TypedOption& option,
           const std::string& number) {
  std::vector<std::string> arguments = verb;
  arguments.push_back(option.name + "=" + number);
  if (option.value == "FROM TO") arguments.emplace_back("1");
  arguments.emplace_back("--help");
  const Finished finished = run(kaz(arguments));
  if (finished.exit_code == 0) return true;
  EXPECT_EQ(finished.exit_code, 2) << option.name << ": " << finished.err;
  EXPECT_NE(finished.err.find(option.name), std::string::npos) << finished.err;
  EXPECT_NE(finished.err.find(" --help`"), std::string::npos) << finished.err;
  return false;
}

TEST(Numbers, AreFiniteAndDecimalInEveryOption) {
  std::size_t numeric = 0;
  std::set<std::string> tried;  // several verbs have the same one
  auto verbs = all_verbs();
  // The help shows some options only with the behaviors that have them.
  for (const char* behavior : {"navigate", "play"}) verbs.push_back({"run", behavior});
  for (const auto& verb : verbs) {
    auto arguments = verb;
    arguments.emplace_back("--help");
    for (const TypedOption& option : options_of(run(kaz(arguments)).out)) {
      if (!tried.insert(option.line).second) continue;
      const bool takes_nan = takes(verb, option, "nan");
      if (takes_nan && option.name == "--duration") continue;
      EXPECT_TRUE(!takes_nan || is_text(option.value))
          << option.name << " " << option.value << " of " << arguments.front()
          << " takes nan: give it a check of tools/cli/options.h";
      if (takes_nan) continue;
      ++numeric;
      for (const char* wrong : {"-inf", "0x1p3"})
        EXPECT_FALSE(takes(verb, option, wrong)) << option.name << " " << wrong;
      if (option.value != "N" && option.value != "INT") continue;
      for (const char* wrong : {"99999999999999999999", "1.5"})
        EXPECT_FALSE(takes(verb, option, wrong)) << option.name << " " << wrong;
    }
  }
  EXPECT_GT(numeric, 40u);
}

// CLI11 would read the digits after a zero as octal.
TEST(Numbers, WithALeadingZeroAreDecimal) {
  const Finished board = run(kaz({"status", "no-such-port", "--address", "010"}));
  EXPECT_EQ(board.exit_code, 3) << board.err;
  const Finished seed = run(kaz({"mcu", "compare", "--ticks", "010", "--seed", "0009", "--json"}));
  EXPECT_EQ(seed.exit_code, 0) << seed.err;
  EXPECT_NE(seed.out.find("\"ticks\": 10"), std::string::npos) << seed.out;
}

}  // namespace
}  // namespace kaz::test
