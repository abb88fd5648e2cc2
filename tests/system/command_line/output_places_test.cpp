// Where results go: full disks, places that cannot be written, two runs at once, results of earlier runs.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "shared/base/json_testing.h"
#include "tests/system/command_line/process_testing.h"

namespace kaz::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using std::chrono::seconds;
using Words = std::vector<std::string>;

Words joined(Words all, const Words& more) {
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

const Words kShortRun{"run", "search-ball", "--mcu", "native", "--duration", "1"};
const Words kBench{"bench", "motor", "--mcu", "native", "--filter", "pot.noise"};
const Words kEvaluate{"evaluate", "search-ball", "--mcu",     "native", "--eyes",
                      "ideal",    "--set",       "seconds=2", "--json"};

// Pixels that no PNG makes smaller.
void write_noise(const std::string& path) {
  std::string pixels(std::size_t{3} * 200 * 150, '\0');
  unsigned state = 1;
  for (char& c : pixels) c = static_cast<char>((state = state * 1664525u + 1013904223u) >> 24);
  write_file(path, "P6\n200 150\n255\n" + pixels);
}

// The program on a disk of `kilobytes`, mounted at `disk` for it alone; `ls` of it follows on
// standard output. Where nothing can be mounted, a limit of the size of each file takes its place.
Finished on_small_disk(const std::string& disk, int kilobytes, const Words& arguments,
                       const std::string& variables = "") {
  const std::string size = std::to_string(kilobytes);
  std::string command = variables;
  for (const std::string& word : kaz(arguments)) command += " '" + word + "'";
  command += "; status=$?; ls -A '" + disk + "'; exit $status";
  const std::string mount = "mount -t tmpfs -o size=" + size + "k tmpfs '" + disk + "' && ";
  fs::create_directories(disk);
  Words shell{"/usr/bin/unshare", "-m", "/bin/bash", "-c", mount + "true"};
  if (run(shell).exit_code != 0) shell.insert(shell.begin() + 2, "-r");
  if (run(shell).exit_code != 0)
    return run({"/bin/bash", "-c", "ulimit -f " + size + "; " + command});
  shell.back() = mount + command;
  return run(shell);
}

void expect_full(const Finished& finished, const std::string& what) {
  EXPECT_EQ(finished.exit_code, 3) << finished.out << finished.err;
  EXPECT_NE(finished.err.find("disk full while writing "), std::string::npos) << finished.err;
  EXPECT_NE(finished.err.find(what), std::string::npos) << finished.err;
}

TEST(OutputPlaces, AFullDiskIsNamedWithWhatIsSaved) {
  const TemporaryFolder folder;
  const std::string disk = folder / "disk";
  for (const char* verb : {"run", "demo"}) {
    Words words = kShortRun;
    if (std::string(verb) == "demo") words = {"demo", "--mcu", "native", "--duration", "1"};
    const Finished ran = on_small_disk(disk, 200, joined(words, {"--out", disk}));
    expect_full(ran, "recording.mcap");
    EXPECT_NE(ran.err.find("; saved so far: " + disk + "/"), std::string::npos) << ran.err;
    EXPECT_EQ(ran.out.find("recording.mcap\n"), std::string::npos) << "half of it: " << ran.out;
  }
  fs::create_directory(folder / "in");
  write_noise(folder / "in/noise.ppm");
  expect_full(
      on_small_disk(disk, 60,
                    {"vision", "run", "--in", folder / "in", "--view", "60", "--out", disk}),
      "saved so far");
  expect_full(on_small_disk(disk, 60, {"eyes", "--out", disk}), "saved so far");
  // Not at its end by Ctrl-C, which may be hours later.
  expect_full(on_small_disk(disk, 200,
                            {"sim", "--world", "ball", "--serial", folder / "board", "--record",
                             disk + "/r.mcap"}),
              "saved so far: " + disk + "/r.mcap.part");
  expect_full(on_small_disk(disk, 16, joined(kBench, {"--out", disk})), "saved so far");
  // What was measured is on standard output all the same.
  const Finished bench = on_small_disk(disk, 16, joined(kBench, {"--json", "--out", disk}));
  expect_full(bench, "saved so far");
  EXPECT_NE(bench.out.find("\"pot.noise\""), std::string::npos) << bench.out;
  expect_full(run(kaz({"conformance", "--virtual", "native", "--filter", "frame.", "--junit",
                       "/dev/full"})),
              "/dev/full");
  expect_full(run(kaz({"conformance", "--virtual", "native", "--filter", "frame.", "--json",
                       folder / "whole.json", "--html", "/dev/full"})),
              "saved so far: " + (folder / "whole.json"));
}

// A replay has no folder of its own: its recording is a temporary file.
TEST(OutputPlaces, AReplayOnAFullDiskIsNoDifference) {
  const TemporaryFolder folder;
  const std::string disk = folder / "disk";
  const Finished ran = run(kaz(joined(kShortRun, {"--out", folder / "out"})));
  ASSERT_LE(ran.exit_code, 1) << ran.err;
  expect_full(
      on_small_disk(disk, 100, {"replay", folder / "out/recording.mcap"}, "TMPDIR='" + disk + "'"),
      "replay.mcap");
}

TEST(OutputPlaces, AreRefusedBeforeARunWhereNothingCanBeWritten) {
  const TemporaryFolder folder;
  write_noise(folder / "noise.ppm");
  for (const Words& verb : {kShortRun, Words{"demo"}, kEvaluate, kBench, Words{"eyes"},
                            Words{"vision", "run", "--in", folder / "noise.ppm", "--view", "60"}}) {
    const Finished finished = run(kaz(joined(verb, {"--out", "/proc/x"})), seconds(5));
    EXPECT_EQ(finished.exit_code, 2) << verb[0] << ": " << finished.err;
    EXPECT_NE(finished.err.find("'/proc/x'"), std::string::npos) << finished.err;
    // With --json the error, and no result.
    EXPECT_TRUE(finished.out.empty() || parse_json(finished.out).contains("error")) << "it ran";
  }
  for (const char* option : {"--junit", "--json", "--html"}) {
    const Finished finished = run(kaz({"conformance", "--virtual", "h8", option, "/proc/x"}));
    EXPECT_EQ(finished.exit_code, 2) << finished.err;
    EXPECT_NE(finished.err.find(option), std::string::npos) << finished.err;
  }
  for (const Words& verb :
       {Words{"sim", "--serial", folder / "board", "--record"}, Words{"sim", "--write-calibration"},
        Words{"fuzz", "--cases", "1000000", "--out"},
        Words{"vision", "learn-color", "--in", folder / "noise.ppm", "--region", "0,0,9,9",
              "--out"}}) {
    const Finished finished = run(kaz(joined(verb, {"/proc/x"})), seconds(5));
    EXPECT_EQ(finished.exit_code, 2) << verb[0] << ": " << finished.err;
    EXPECT_NE(finished.err.find("'/proc/x'"), std::string::npos) << finished.err;
  }
  const Finished twice = run(kaz({"conformance", "--virtual", "native", "--junit", folder / "same",
                                  "--json", folder / "same"}));
  EXPECT_EQ(twice.exit_code, 2) << twice.err;
}

// Commands up to the path of their output, which end by themselves without hardware.
std::vector<Words> file_options(const TemporaryFolder& folder) {
  std::string picture = "P6\n64 48\n255\n";  // its left part is red
  for (int n = 0; n < 64 * 48; ++n) picture += n % 64 < 16 ? "\xc0\x10\x10" : "\x60\x60\x60";
  write_file(folder / "red.ppm", picture);
  // The reset vector, and at 0x100 BRA to itself.
  std::string image(0x102, '\0');
  image[2] = 1;
  image[0x100] = 0x40;
  image[0x101] = static_cast<char>(0xfe);
  write_file(folder / "loop.bin", image);
  const Words suite{"conformance", "--virtual", "native", "--filter", "^frame"};
  const Words chip{"mcu",  "run", folder / "loop.bin", "--format", "raw",
                   "--at", "0",   "--max-states",      "1000"};
  return {joined(suite, {"--junit"}),
          joined(suite, {"--json"}),
          joined(suite, {"--html"}),
          {"conformance", "--list", "--json"},
          {"sim", "--mcu", "native", "--write-calibration"},
          joined(chip, {"--vcd"}),
          joined(chip, {"--trace="}),
          joined(chip, {"--profile="}),
          joined(chip, {"--profile-format", "json", "--profile="}),
          joined(chip, {"--profile-format", "callgrind", "--profile="}),
          {"vision", "learn-color", "--in", folder / "red.ppm", "--region", "0,0,9,9", "--out"}};
}

Finished with_file(Words words, const std::string& file) {
  if (words.back().ends_with('='))
    words.back() += file;
  else
    words.push_back(file);
  return run(kaz(words), seconds(20));
}

TEST(OutputPlaces, AFileIsReplacedByACompleteOne) {
  const TemporaryFolder folder;
  const std::string path = folder / "out.yml";
  for (const Words& command : file_options(folder)) {
    SCOPED_TRACE(command[0] + " ... " + command.back());
    write_file(path, "earlier");
    const Finished replaced = with_file(command, path);
    EXPECT_GT(fs::file_size(path), 0u) << replaced.err;
    EXPECT_NE(read_file(path), "earlier") << replaced.err;
    EXPECT_FALSE(fs::exists(path + ".part"));
    expect_full(with_file(command, "/dev/full"), "/dev/full");
    for (const std::string& other : {folder.path(), std::string()}) {
      if (other.empty() && command.back().find("json") != std::string::npos) continue;
      if (other.empty() && command.back().ends_with('=')) continue;  // standard error
      EXPECT_EQ(with_file(command, other).exit_code, 2) << "'" << other << "'";
    }
  }
}

// Flash contents and failing cases cannot be made again, and a board's memory is read first.
TEST(OutputPlaces, AnInputIsNotReplaced) {
  const TemporaryFolder folder;
  int refusals = 0;
  for (const Words& command : file_options(folder)) {
    for (const std::string& input : {folder / "loop.bin", folder / "red.ppm"}) {
      if (std::ranges::count(command, input) == 0) continue;
      const std::string before = read_file(input);
      fs::remove(folder / "link");
      fs::create_symlink(input, folder / "link");
      for (const std::string& output : {input, folder / "link"}) {
        const Finished refused = with_file(command, output);
        EXPECT_EQ(refused.exit_code, 2) << refused.err;
        EXPECT_NE(refused.err.find("another argument of the command names the same file"),
                  std::string::npos)
            << refused.err;
        EXPECT_EQ(read_file(input), before);
        ++refusals;
      }
    }
  }
  EXPECT_EQ(refusals, 12);
}

TEST(OutputPlaces, AFileThatCannotBeMadeAgainIsKept) {
  const TemporaryFolder folder;
  const std::string path = folder / "mine";
  write_file(path, "mine");
  for (const Words& command :
       {Words{"fuzz", "--cases", "1000000", "--out"},
        Words{"flash", "read", "--port", folder / "none", "--out"},
        Words{"sim", "--mcu", "native", "--serial", folder / "board", "--memory"}}) {
    const Finished refused = with_file(command, path);
    EXPECT_EQ(refused.exit_code, 2) << command[0] << ": " << refused.err;
    EXPECT_NE(refused.err.find(path), std::string::npos) << refused.err;
    EXPECT_EQ(std::count(refused.err.begin(), refused.err.end(), '\n'), 1) << refused.err;
    EXPECT_EQ(read_file(path), "mine");
    EXPECT_FALSE(fs::exists(path + ".part"));
  }
}

TEST(OutputPlaces, AFolderOfResultsIsNoCorpus) {
  const TemporaryFolder folder;
  ASSERT_EQ(run(kaz(joined(kBench, {"--out", folder / "results"}))).exit_code, 0);
  const Finished fuzz = run(kaz({"fuzz", "--corpus", folder / "results", "--cases", "1"}));
  EXPECT_EQ(fuzz.exit_code, 2) << fuzz.out;
  EXPECT_NE(fuzz.err.find("a folder of results, which contains no cases"), std::string::npos)
      << fuzz.err;
}

TEST(OutputPlaces, OfASimulatorAreDifferent) {
  const TemporaryFolder folder;
  const std::string board = folder / "board";
  for (const Words& more :
       {Words{"--record", board}, Words{"--memory", board},
        Words{"--cameras", folder / "./board.ctl"}, Words{"--cameras", board}}) {
    const Finished finished =
        run(kaz(joined({"sim", "--mcu", "native", "--serial", board}, more)), seconds(5));
    EXPECT_EQ(finished.exit_code, 2) << finished.err;
    EXPECT_NE(finished.err.find("is also the path of"), std::string::npos) << finished.err;
  }
}

// Of what the program prints, too. A file never takes the place of a closed standard output.
TEST(OutputPlaces, StandardOutputIsWrittenOrItsLossIsAnError) {
  const TemporaryFolder folder;
  const std::string program = kaz({})[0], junit = folder / "junit.xml";
  const auto shell = [](const std::string& command) { return run({"/bin/bash", "-c", command}); };
  for (const auto& [words, verb] :
       {std::pair(" --version", "kaz"),
        {" mcu run --help", "kaz mcu run"},
        {" conformance --list", "kaz conformance"},
        {" conformance --virtual native --filter ^frame --json", "kaz conformance"}}) {
    const Finished full = shell(program + words + " > /dev/full");
    EXPECT_EQ(full.exit_code, 3) << words;
    EXPECT_NE(("\n" + full.err)
                  .find("\n" + std::string(verb) + ": disk full while writing standard output"),
              std::string::npos)
        << full.err;
  }
  const Finished enough =
      shell("trap '' PIPE; " + program + " conformance --list | true; exit ${PIPESTATUS[0]}");
  EXPECT_EQ(enough.exit_code, 0) << enough.err;
  EXPECT_EQ(enough.err, "");
  const std::string suite = program + " conformance --virtual native --filter ^frame --junit ";
  EXPECT_EQ(shell(suite + junit + " <&- >&- 2>&-").exit_code, 0);
  const std::string text = read_file(junit);
  EXPECT_EQ(text.rfind("<?xml", 0), 0u) << text.substr(0, 200);
  EXPECT_TRUE(text.ends_with("</testsuite>\n")) << text;
  const Finished same = shell(suite + junit + " > " + junit);
  EXPECT_EQ(same.exit_code, 2) << same.err;
  EXPECT_NE(same.err.find("the standard output of this program"), std::string::npos) << same.err;
}

TEST(OutputPlaces, OneRunAtATimeWritesIntoAFolder) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  {
    Process first(kaz({"run", "track-ball", "--mcu", "native", "--duration", "600", "--out", out}));
    ASSERT_TRUE(first.wait_for_output("search", seconds(30)));
    EXPECT_TRUE(fs::exists(out + "/recording.mcap.part")) << "a recording grows in its folder";
    for (const Words& verb : {kShortRun, Words{"demo"}, kEvaluate, kBench}) {
      const Finished second = run(kaz(joined(verb, {"--out", out})), seconds(10));
      EXPECT_EQ(second.exit_code, 3) << verb[0] << ": " << second.err;
      EXPECT_NE(second.err.find("another run (process "), std::string::npos) << second.err;
      EXPECT_NE(second.err.find(out), std::string::npos) << second.err;
    }
  }  // killed
  EXPECT_TRUE(fs::exists(out + "/recording.mcap.part"));
  EXPECT_FALSE(fs::exists(out + "/recording.mcap"));
  const Finished next = run(kaz(joined(kShortRun, {"--out", out})));
  EXPECT_LE(next.exit_code, 1) << next.err;
  EXPECT_TRUE(fs::exists(out + "/recording.mcap"));
  EXPECT_FALSE(fs::exists(out + "/recording.mcap.part"));
}

TEST(OutputPlaces, EarlierResultsGoAndOthersAreRefused) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  ASSERT_LE(run(kaz(joined(kShortRun, {"--out", out}))).exit_code, 1);
  // As if the earlier run had left one picture more.
  write_file(out + "/map.png", "old");
  write_file(out + "/notes.txt", "mine");
  // What is wrong before a run begins costs nothing.
  EXPECT_EQ(run(kaz({"run", "search-ball", "--world", "none", "--out", out})).exit_code, 2);
  EXPECT_TRUE(fs::exists(out + "/map.png"));
  ASSERT_LE(run(kaz(joined(kShortRun, {"--out", out}))).exit_code, 1);
  EXPECT_FALSE(fs::exists(out + "/map.png"));
  EXPECT_TRUE(fs::exists(out + "/notes.txt"));
  const std::string result = read_file(out + "/result.json");

  write_noise(folder / "noise.ppm");
  const Words vision{"vision", "run", "--in", folder / "noise.ppm", "--view", "60"};
  for (const Words& verb : {kEvaluate, kBench, Words{"eyes"}, vision}) {
    const Finished other = run(kaz(joined(verb, {"--out", out})));
    EXPECT_EQ(other.exit_code, 2) << verb[0];
    EXPECT_NE(other.err.find("kaz run"), std::string::npos) << other.err;
  }
  EXPECT_EQ(read_file(out + "/result.json"), result);
  // Without the mark these are anybody's files.
  fs::remove(out + "/.kaz-results");
  for (const Words& verb : {kShortRun, Words{"demo"}, kEvaluate, kBench, vision}) {
    const Finished other = run(kaz(joined(verb, {"--out", out})));
    EXPECT_EQ(other.exit_code, 2) << verb[0];
    EXPECT_NE(other.err.find(".kaz-results"), std::string::npos) << other.err;
  }
  EXPECT_EQ(read_file(out + "/result.json"), result);
}

// The processes that `process` has begun.
std::vector<pid_t> children_of(long process) {
  const std::string name = std::to_string(process);
  std::ifstream list("/proc/" + name + "/task/" + name + "/children");
  std::vector<pid_t> children;
  for (pid_t child = 0; list >> child;) children.push_back(child);
  return children;
}

TEST(OutputPlaces, EpisodesLostToTheMachineAreInNoRate) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  const Words command = joined(kEvaluate, {"--episodes", "2", "--out", out});
  Process first(kaz(command));
  pid_t killed = 0;
  for (int i = 0; i < 500 && killed == 0; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    if (!fs::exists(out + "/failures/000000")) continue;  // the episode's own folder
    for (const pid_t child : children_of(first.id())) kill(killed = child, SIGKILL);
  }
  ASSERT_NE(killed, 0);
  const Finished stopped = first.wait(seconds(60));
  EXPECT_EQ(stopped.exit_code, 3) << stopped.err;
  EXPECT_NE(stopped.err.find("1 of 2 episodes were lost to machine errors (0; the first: the "
                             "process of the episode was ended by signal 9)"),
            std::string::npos)
      << stopped.err;
  const json result = parse_json(read_file(out + "/result.json"));
  EXPECT_EQ(result["episodes"], 1) << result.dump(1);
  ASSERT_EQ(result["environment"].size(), 1u);
  EXPECT_EQ(result["environment"][0]["episode"], 0);
  // The same command makes up for it.
  EXPECT_LE(run(kaz(command)).exit_code, 1);
  const json whole = parse_json(read_file(out + "/result.json"));
  EXPECT_EQ(whole["episodes"], 2);
  EXPECT_TRUE(whole["environment"].empty());
}

TEST(OutputPlaces, AFullDiskIsNoFailureOfTheRobot) {
  const TemporaryFolder folder;
  const Finished finished = on_small_disk(
      folder / "disk", 300, joined(kEvaluate, {"--episodes", "9", "--out", folder / "disk"}));
  expect_full(finished, "3 of 9 episodes were lost to machine errors");
}

TEST(OutputPlaces, APortThatGoesIsAnErrorNotAFailure) {
  const TemporaryFolder folder;
  const std::string junit = folder / "junit.xml";
  Process sim(kaz({"sim", "--mcu", "native", "--serial", folder / "board"}));
  ASSERT_TRUE(sim.wait_for_output("ready", seconds(30)));
  Process suite(kaz(
      {"conformance", "--port", folder / "board", "--filter", "frame|watchdog", "--junit", junit}));
  ASSERT_TRUE(suite.wait_for_output("passed", seconds(30)));
  EXPECT_FALSE(fs::exists(junit));
  sim.signal(SIGKILL);
  const Finished finished = suite.wait(seconds(60));
  EXPECT_EQ(finished.exit_code, 3) << finished.err;
  const std::string text = read_file(junit);
  EXPECT_NE(text.find("errors=\"1\""), std::string::npos) << text;
  EXPECT_NE(text.find("<error message="), std::string::npos) << text;
}

}  // namespace
}  // namespace kaz::test
