// Ctrl-C and SIGTERM end every verb within a second, with one exit status, and keep what there is.
// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <pty.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "shared/base/json_testing.h"
#include "tests/system/command_line/process_testing.h"

namespace kaz::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using std::chrono::milliseconds;
using std::chrono::seconds;
using Steady = std::chrono::steady_clock;

// The names in verbs.def.
constexpr const char* kVerbs[] = {
#define KAZ_VERB(name, folder) #name,
#include "tools/cli/verbs.def"
#undef KAZ_VERB
};

// Verbs with nothing to interrupt: `kaz` with these words succeeds within a second by itself.
const std::map<std::string, std::vector<std::string>>& at_once() {
  static const std::map<std::string, std::vector<std::string>> all = {
      {"can_bridge", {"can-bridge", "--help"}},  // needs a CAN interface; in the guest machine
      {"compare", {"compare", "--help"}},
      {"doctor", {"doctor", "--help"}},
      {"robot", {"robot", "--help"}},
      {"shell", {"man"}}};
  return all;
}

// A port at whose other end nobody answers; what is written to it shows that a program is at work.
class SilentPort {
 public:
  SilentPort() {
    int slave = -1;
    char name[64] = {};
    if (openpty(&master_, &slave, name, nullptr, nullptr) != 0) throw std::runtime_error("openpty");
    close(slave);
    fcntl(master_, F_SETFL, O_NONBLOCK);
    path_ = name;
  }
  ~SilentPort() { close(master_); }
  SilentPort(const SilentPort&) = delete;
  SilentPort& operator=(const SilentPort&) = delete;
  const std::string& path() const { return path_; }
  bool was_written(seconds at_most) const {
    const auto until = Steady::now() + at_most;
    for (char byte = 0; Steady::now() < until; std::this_thread::sleep_for(milliseconds(10))) {
      if (::read(master_, &byte, 1) == 1) return true;
    }
    return false;
  }

 private:
  int master_ = -1;
  std::string path_;
};

// One verb at work, and its end. In arguments and paths DIR is a folder of the test's, PORT a silent port.
struct Row {
  std::string name;  // the verb, and what distinguishes its rows
  std::vector<std::string> arguments;
  // In its output; "/...": that file is in DIR; empty: it writes to PORT, or half a second has passed.
  std::string at_work;
  int signal = SIGINT;
  std::optional<int> status = std::nullopt;  // 128 + signal if none
  std::string result = {};    // a JSON file in DIR that says "interrupted"; "-": standard output
  bool has_children = false;  // whose processor time counts as its own
  std::string error = {};     // its standard error, where the test is of the sentence
};

void PrintTo(const Row& row, std::ostream* out) {
  *out << row.name;
}

std::string verb_of(const Row& row) {
  return row.name.substr(0, row.name.find(' '));
}

// Every verb that is not in at_once() has a row.
const std::vector<Row> kTable = {
    {"demo",
     {"demo", "--mcu", "native", "--eyes", "ideal", "--duration", "3000", "--out", "DIR/out"},
     "kaz demo: ",
     SIGINT,
     {},
     "out/result.json"},
    {"demo terminated",
     {"demo", "--duration", "3000", "--out", "DIR/out"},
     "kaz demo: ",
     SIGTERM,
     {},
     "out/result.json"},
    {"demo pictures",
     {"demo", "--mcu", "native", "--duration", "1", "--eye-width", "640", "--out", "DIR/out"},
     "/out/recording.mcap",
     SIGINT,
     {},
     "out/result.json"},
    {"run",
     {"run", "track-ball", "--mcu", "native", "--duration", "3000", "--out", "DIR/out"},
     "kaz run: ",
     SIGHUP,
     {},
     "out/result.json"},
    {"evaluate",
     {"evaluate", "search-ball", "--mcu", "native", "--eyes", "ideal", "--set", "seconds=2",
      "--episodes", "50", "--jobs", "2", "--out", "DIR/out"},
     "succeeded",
     SIGINT,
     {},
     "out/result.json",
     true},
    {"sim", {"sim", "--mcu", "native", "--serial", "DIR/board"}, "ready", SIGINT, 0},
    {"sim terminated", {"sim", "--mcu", "native", "--serial", "DIR/board"}, "ready", SIGTERM, 0},
    {"eyes", {"eyes", "--eye-width", "640", "--out", "DIR/eyes"}, "/eyes"},
    {"calibrate",
     {"calibrate", "stereo", "--left", "DIR/left*.ppm", "--right", "DIR/right*.ppm", "--board",
      "9x6", "--square", "0.025", "--out", "DIR/eyes.yml"},
     "looking for the board"},
    {"calibrate joints",
     {"calibrate", "joints", "--out", "DIR/out"},
     "neck_pan",
     SIGTERM,
     {},
     "out/result.json"},
    {"replay", {"replay", "DIR/recorded/recording.mcap", "--whole"}, "kaz replay: "},
    {"mcu run",
     {"mcu", "run", "DIR/loop.bin", "--format", "raw", "--at", "0", "--max-states", "9000000000000",
      "--json", "--vcd", "DIR/loop.vcd"},
     "/loop.vcd.part",
     SIGINT,
     {},
     "-"},
    {"mcu run flat",
     {"mcu", "run", "DIR/loop.bin", "--format", "raw", "--at", "0", "--flat", "--entry=0x100",
      "--json"},
     "",
     SIGINT,
     {},
     "-"},
    {"mcu compare", {"mcu", "compare", "--ticks", "900000000"}, "kaz mcu compare", SIGTERM},
    {"mcu compare wire",
     {"mcu", "compare", "--wire", "--conversations", "900000"},
     "kaz mcu compare"},
    {"conformance",
     {"conformance", "--virtual", "h8", "--json", "DIR/report.json"},
     "passed",
     SIGINT,
     {},
     "report.json"},
    {"bench", {"bench", "motor", "--out", "DIR/out"}, "kaz bench", SIGINT, {}, "out/result.json"},
    {"flash", {"flash", "info", "--port", "PORT", "--json"}, "", SIGINT, {}, "-"},
    {"fuzz",
     {"fuzz", "--target", "h8", "--seconds", "3000", "--out", "DIR/case"},
     "kaz fuzz",
     SIGINT},
    {"fuzz body",
     {"fuzz", "--body", "--seconds", "3000", "--out", "DIR/case"},
     "kaz fuzz",
     SIGTERM},
    {"status", {"status", "--port", "PORT"}, "", SIGTERM},
    {"recover",
     {"recover", "--port", "PORT"},
     "",
     SIGTERM,
     {},
     {},
     false,
     "kaz recover: interrupted while searching for the board on PORT; nothing was changed: "
     "give the same command again\n"},
    {"monitor", {"monitor", "--port", "PORT"}, "", SIGINT, 0},
    {"vision",
     {"vision", "run", "--in", "DIR/pictures", "--view", "60", "--out", "DIR/seen"},
     "kaz vision",
     SIGINT,
     {},
     "seen/result.json"},
    {"vision recording",
     {"vision", "run", "--in", "DIR/recorded/recording.mcap", "--out", "DIR/seen"},
     "kaz vision",
     SIGINT,
     {},
     "seen/result.json"},
    {"serve_port",
     {"serve-port", "--port", "PORT", "--listen", "127.0.0.1:47217"},
     "ready",
     SIGTERM,
     0},
    {"bus", {"bus", "scan", "--robot", "feetech:PORT"}, ""},
};

std::string filled(std::string text, const TemporaryFolder& folder, const std::string& port) {
  text = std::regex_replace(text, std::regex("DIR"), folder.path());
  return std::regex_replace(text, std::regex("PORT"), port);
}

// What the rows' verbs read.
void prepare(const Row& row, const TemporaryFolder& folder) {
  const auto uses = [&](const std::string& what) {
    return std::ranges::any_of(row.arguments, [&](const std::string& argument) {
      return argument.find(what) != std::string::npos;
    });
  };
  if (uses("loop.bin")) {
    // The reset vector, and at 0x100 BRA to itself.
    std::string image(0x102, '\0');
    image[2] = 1;
    image[0x100] = 0x40;
    image[0x101] = static_cast<char>(0xfe);
    write_file(folder / "loop.bin", image);
  }
  if (uses(".ppm") || uses("/pictures")) {
    // Noise: without a board, and full of colours.
    std::string picture = "P6\n1200 900\n255\n";
    std::uint32_t noise = 1;
    for (int i = 0; i < 3 * 1200 * 900; ++i)
      picture += static_cast<char>((noise = noise * 1664525 + 1013904223) >> 24);
    write_file(folder / "picture.ppm", picture);
    fs::create_directory(folder / "pictures");
    for (int i = 1000; i < 1300; ++i) {
      for (const char* name : {"left", "right", "pictures/"})
        fs::create_hard_link(folder / "picture.ppm", folder / (name + std::to_string(i) + ".ppm"));
    }
  }
  if (uses("recorded/")) {
    const Finished recorded =
        run(kaz({"run", "track-ball", "--mcu", "native", "--eyes", "ideal", "--duration", "2",
                 "--record-pictures", "--out", folder / "recorded"}));
    ASSERT_EQ(recorded.exit_code, 0) << recorded.err;
  }
}

bool appears(const std::string& path, seconds at_most) {
  const auto until = Steady::now() + at_most;
  while (Steady::now() < until && !fs::exists(path)) std::this_thread::sleep_for(milliseconds(5));
  return fs::exists(path);
}

// Processes whose command line names the folder.
std::vector<std::string> left_over(const TemporaryFolder& folder) {
  std::vector<std::string> found;
  std::error_code gone;
  for (const auto& entry : fs::directory_iterator("/proc", gone)) {
    const std::string number = entry.path().filename();
    if (number.find_first_not_of("0123456789") != std::string::npos) continue;
    const std::string command = read_file("/proc/" + number + "/cmdline");
    if (command.find(folder.path()) != std::string::npos) found.push_back(number + " " + command);
  }
  return found;
}

class Interrupted : public ::testing::TestWithParam<Row> {};

TEST_P(Interrupted, EndsWithinASecondAndKeepsWhatThereIs) {
  const Row& row = GetParam();
  const TemporaryFolder folder;
  ASSERT_NO_FATAL_FAILURE(prepare(row, folder));
  const SilentPort port;
  std::vector<std::string> arguments;
  for (const std::string& argument : row.arguments)
    arguments.push_back(filled(argument, folder, port.path()));
  Process program(kaz(arguments));
  const bool at_port = std::ranges::find(row.arguments, "PORT") != row.arguments.end();
  if (row.at_work.empty() && !at_port) std::this_thread::sleep_for(milliseconds(500));
  const bool at_work = row.at_work.empty()     ? !at_port || port.was_written(seconds(30))
                       : row.at_work[0] == '/' ? appears(folder.path() + row.at_work, seconds(30))
                                               : program.wait_for_output(row.at_work, seconds(60));
  ASSERT_TRUE(at_work) << program.wait(seconds(0)).err;

  const double cpu_before = program.cpu_s();
  const auto signalled = Steady::now();
  program.signal(row.signal);
  const Finished end = program.wait(seconds(10));
  const double wall_s = std::chrono::duration<double>(Steady::now() - signalled).count();
  EXPECT_EQ(end.exit_code, row.status.value_or(128 + row.signal)) << end.out << end.err;
  // On a loaded machine a program may wait for its turn, but does not work for long.
  const double worked_s = row.has_children ? 0 : end.cpu_s - cpu_before;
  EXPECT_TRUE(wall_s < 1 || (wall_s < 6 && worked_s < 1)) << wall_s << " s, worked " << worked_s;
  if (row.status.value_or(1) != 0) {
    EXPECT_TRUE(std::regex_search(end.err,
                                  std::regex("kaz " + row.arguments.front() + "[^\n]*interrupted")))
        << end.err;
  }
  EXPECT_TRUE(end.err.empty() || end.err.back() == '\n') << end.err;
  if (!row.error.empty()) {
    EXPECT_EQ(end.err, filled(row.error, folder, port.path()));
  }
  for (const auto& file : fs::recursive_directory_iterator(folder.path()))
    EXPECT_NE(file.path().extension(), ".part") << file.path();
  if (!row.result.empty()) {
    const std::string text = row.result == "-" ? end.out : read_file(folder / row.result);
    const json result = parse_json(text);
    ASSERT_TRUE(result.is_object()) << text;
    EXPECT_TRUE(result.value("interrupted", false)) << text;
    EXPECT_EQ(result.value("signal", ""), row.signal == SIGINT    ? "SIGINT"
                                          : row.signal == SIGTERM ? "SIGTERM"
                                                                  : "SIGHUP");
    EXPECT_TRUE(result.contains("provenance")) << text;
  }
  EXPECT_EQ(left_over(folder), std::vector<std::string>());
}

INSTANTIATE_TEST_SUITE_P(Verbs, Interrupted, ::testing::ValuesIn(kTable), [](const auto& row) {
  std::string name = row.param.name;
  std::ranges::replace(name, ' ', '_');
  return name;
});

TEST(Interrupts, AreTriedOnEveryVerb) {
  std::set<std::string> tried;
  for (const Row& row : kTable) tried.insert(verb_of(row));
  for (const auto& [verb, words] : at_once())
    EXPECT_TRUE(tried.insert(verb).second) << verb << ": either rows, or words in at_once()";
  for (const char* verb : kVerbs)
    EXPECT_EQ(tried.erase(verb), 1u) << verb << ": add a row to kTable, or words to at_once()";
  EXPECT_EQ(tried, std::set<std::string>()) << "no verbs";
}

TEST(Interrupts, WhatEndsAtOnceNeedsNone) {
  EXPECT_GT(at_once().size(), 0u);
  for (const auto& [verb, words] : at_once()) {
    Process program(kaz(words));
    const Finished end = program.wait(seconds(10));
    EXPECT_EQ(end.exit_code, 0) << verb << ": " << end.err;
    // Of processor time, since a loaded machine keeps it waiting; one that waits is killed after 10 s.
    EXPECT_LT(end.cpu_s, 1) << verb;
  }
}

TEST(Interrupts, ARecordingEndsThereAndReplays) {
  const TemporaryFolder folder;
  Process program(kaz({"run", "track-ball", "--mcu", "native", "--eyes", "ideal", "--duration",
                       "30", "--record-pictures", "--out", folder / "out"}));
  ASSERT_TRUE(program.wait_for_output(": track", seconds(60)));
  program.signal(SIGINT);
  const Finished end = program.wait(seconds(10));
  ASSERT_EQ(end.exit_code, 130) << end.err;
  EXPECT_NE(end.err.find("kept in " + folder / "out"), std::string::npos) << end.err;
  for (const char* mode : {"--host", "--whole"}) {
    const Finished again = run(kaz({"replay", folder / "out/recording.mcap", mode}));
    EXPECT_EQ(again.exit_code, 0) << again.out << again.err;
    EXPECT_NE(again.out.find("the recording ends early, because its run was interrupted by SIGINT"),
              std::string::npos)
        << again.out;
    EXPECT_NE(again.out.find("identical"), std::string::npos) << again.out;
  }
}

// As a terminal and a wrapper that forwards, a supervisor, a terminal that closes send them.
TEST(Interrupts, TwoAtOnceAreOne) {
  for (const auto& [first, second] :
       {std::pair(SIGINT, SIGINT), {SIGINT, SIGTERM}, {SIGHUP, SIGTERM}}) {
    for (const int pause_ms : {0, 20}) {
      SCOPED_TRACE(std::to_string(first) + " " + std::to_string(second));
      const TemporaryFolder folder;
      Process program(kaz({"run", "track-ball", "--mcu", "native", "--eyes", "ideal", "--duration",
                           "3000", "--out", folder / "out"}));
      ASSERT_TRUE(program.wait_for_output("kaz run: ", seconds(60)));
      program.signal(first);
      std::this_thread::sleep_for(milliseconds(pause_ms));
      program.signal(second);
      const Finished end = program.wait(seconds(10));
      // Of two that are pending at once, one thread may take the later before another the first.
      EXPECT_TRUE(end.exit_code == 128 + first || (pause_ms == 0 && end.exit_code == 128 + second))
          << end.exit_code << end.err;
      EXPECT_EQ(end.err.find("at once"), std::string::npos) << end.err;
      const json result = parse_json(read_file(folder / "out/result.json"));
      ASSERT_TRUE(result.is_object()) << end.err;
      EXPECT_TRUE(result.value("interrupted", false)) << result;
    }
  }
}

// Nothing at its name is half-written, whenever the second one comes.
TEST(Interrupts, ASecondOneEndsAtOnceAndLeavesOnlyWholeFiles) {
  for (const int pause_ms : {405, 410, 450}) {
    const TemporaryFolder folder;
    Process program(kaz({"demo", "--mcu", "native", "--eyes", "ideal", "--duration", "3000",
                         "--out", folder / "out"}));
    ASSERT_TRUE(program.wait_for_output("kaz demo: ", seconds(60)));
    program.signal(SIGINT);
    std::this_thread::sleep_for(milliseconds(pause_ms));
    program.signal(SIGINT);
    EXPECT_EQ(program.wait(seconds(10)).exit_code, 130);
    if (!fs::exists(folder / "out")) continue;
    for (const auto& file : fs::directory_iterator(folder / "out")) {
      const std::string name = file.path().filename();
      if (name == "result.json") {
        EXPECT_TRUE(json::accept(read_file(file.path()))) << pause_ms;
      } else if (name == "recording.mcap") {
        EXPECT_TRUE(read_file(file.path()).ends_with("MCAP0\r\n")) << pause_ms;
      }
    }
  }
}

TEST(Interrupts, NohupStaysNohup) {
  const TemporaryFolder folder;
  Process sim(
      {"/bin/sh", "-c",
       "trap '' HUP; exec " + kaz({}).front() + " sim --mcu native --serial " + folder / "board"});
  ASSERT_TRUE(sim.wait_for_output("ready", seconds(30)));
  sim.signal(SIGHUP);
  std::this_thread::sleep_for(milliseconds(200));
  EXPECT_TRUE(fs::is_symlink(folder / "board")) << "it goes on";
  sim.signal(SIGINT);
  EXPECT_EQ(sim.wait(seconds(10)).exit_code, 0);
}

// The page has a row for each fault, with its number and name, and no other.
TEST(ExitStatus, ThePageListsEachFault) {
  const auto pairs = [](const std::string& text, const std::regex& pattern) {
    std::map<int, std::string> found;
    for (std::sregex_iterator at(text.begin(), text.end(), pattern), end; at != end; ++at) {
      const bool number_first = std::isdigit((*at)[1].str().front()) != 0;
      found[std::stoi((*at)[number_first ? 1 : 2])] = (*at)[number_first ? 2 : 1];
    }
    return found;
  };
  const std::string header = read_file("shared/base/result.hpp");
  const auto begin = header.find("enum class Fault {");
  ASSERT_NE(begin, std::string::npos);
  const auto faults = pairs(header.substr(begin, header.find("};", begin) - begin),
                            std::regex("\n  ([a-z_]+) = ([0-9]+),"));
  const auto page = pairs(read_file("docs/reference/output.md"),
                          std::regex("\n\\| ([0-9]+)[^|\n]* \\| `([a-z_]+)` \\|"));
  EXPECT_GE(faults.size(), 4u);
  EXPECT_EQ(page, faults);
}

}  // namespace
}  // namespace kaz::test
