// Interrupted and killed runs over a real pty: the board is as before, or `kaz recover` brings it back.
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/link/tty_link.h"
#include "host/link/wall_clock.h"
#include "host/robot/connect.h"
#include "host/robot/kept_board.h"
#include "host/robot/robot.h"
#include "shared/base/json_testing.h"
#include "tests/system/command_line/process_testing.h"

namespace kaz::test {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;
using std::chrono::seconds;

class RecoverVerb : public ::testing::Test {
 protected:
  RecoverVerb() : sim_(kaz({"sim", "--mcu", "native", "--world", "empty", "--serial", port()})) {
    setenv("XDG_STATE_HOME", folder_.path().c_str(), 1);
    EXPECT_TRUE(sim_.wait_for_output("ready", seconds(30))) << sim_.wait(seconds(0)).err;
  }
  std::string port() const { return folder_ / "board"; }
  // Of the one board that answers at `address`; a default state if none does.
  host::BoardState state(std::uint8_t address, bool flash = false) const {
    const auto link = host::TtyLink::open(port());
    EXPECT_TRUE(link) << link.error().message;
    if (!link) return {};
    host::WallClock clock;
    auto read = host::read_board(**link, clock, address);
    EXPECT_TRUE(read) << read.error().message;
    if (!read) return {};
    if (flash) {
      EXPECT_TRUE(host::read_flash(**link, clock, *read));
      read->stored_copy = 0;
    }
    return *read;
  }
  void move_to(int address) const {
    const auto link = host::TtyLink::open(port());
    ASSERT_TRUE(link) << link.error().message;
    host::WallClock clock;
    auto robot = host::Robot::connect(**link, clock, {.reconnect = Time::zero()});
    ASSERT_TRUE(robot) << robot.error().message;
    ASSERT_TRUE(robot->unlock(5));
    ASSERT_TRUE(robot->set_address(address, false));
    (void)robot->reset();  // it answers elsewhere
  }
  std::vector<std::string> notes() const {
    std::vector<std::string> all;
    if (!std::filesystem::exists(folder_ / "kaz")) return all;
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / "kaz"))
      all.push_back(entry.path().string());
    return all;
  }
  // Where a run at that port leaves its notes.
  std::string notes_file(const std::string& of) const {
    std::filesystem::create_directories(folder_ / "kaz");
    std::string name = "board" + of;
    std::ranges::replace_if(
        name, [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
    return (folder_ / "kaz") + "/" + name + "-1.json";
  }
  std::vector<std::string> conformance(const std::string& filter) const {
    return kaz({"conformance", "--port", port(), "--allow-flash", "--filter", filter});
  }

  TemporaryFolder folder_;
  Process sim_;
};

TEST_F(RecoverVerb, ABoardAtAnotherAddressIsNamedReachedAndBroughtBack) {
  move_to(3);
  const Finished lost = run(kaz({"status", "--port", port()}));
  EXPECT_EQ(lost.exit_code, 3) << lost.out << lost.err;
  EXPECT_NE(lost.err.find("no board answers at address 1"), std::string::npos) << lost.err;
  EXPECT_NE(lost.err.find("give --address 3, or move that board with `kaz recover"),
            std::string::npos)
      << lost.err;
  const Finished reached = run(kaz({"status", "--port", port(), "--address", "3"}));
  EXPECT_EQ(reached.exit_code, 0) << reached.out << reached.err;
  for (const char* wrong : {"0", "15", "x"})
    EXPECT_EQ(run(kaz({"status", "--port", port(), "--address", wrong})).exit_code, 2) << wrong;

  const Finished recovered = run(kaz({"recover", port(), "--json"}));
  EXPECT_EQ(recovered.exit_code, 0) << recovered.out << recovered.err;
  const json result = parse_json(recovered.out);
  ASSERT_TRUE(result.is_object()) << recovered.out;
  EXPECT_EQ(result["ok"], true);
  EXPECT_EQ(result["found_at"], 3);
  EXPECT_EQ(result["address"], 1);
  EXPECT_EQ(result["provenance"]["command"], "kaz recover " + port() + " --json");
  EXPECT_EQ(run(kaz({"status", "--port", port()})).exit_code, 0);
  EXPECT_EQ(run(kaz({"recover", folder_ / "none"})).exit_code, 3);
  EXPECT_EQ(run(kaz({"recover", port(), "--from", folder_ / "none"})).exit_code, 2);
}

// Which firmware runs is the first question about a board that misbehaves: text and JSON say the same.
TEST_F(RecoverVerb, StatusNamesTheFirmware) {
  const Finished text = run(kaz({"status", "--port", port()}));
  ASSERT_EQ(text.exit_code, 0) << text.out << text.err;
  const Finished as_json = run(kaz({"status", "--port", port(), "--json"}));
  const json now = parse_json(as_json.out);
  ASSERT_TRUE(now.is_object()) << as_json.out << as_json.err;
  const auto link = host::TtyLink::open(port());
  ASSERT_TRUE(link) << link.error().message;
  host::WallClock clock;
  const auto robot = host::Robot::connect(**link, clock, {.reconnect = Time::zero()});
  ASSERT_TRUE(robot) << robot.error().message;
  const kz_identify_reply board = robot->identity();
  EXPECT_EQ(text.out.substr(0, text.out.find('\n')), host::board_text(board));
  EXPECT_EQ(now["firmware"], host::firmware_version_text(board.firmware_version));
  EXPECT_EQ(now["build"], host::build_text(board.build_id));
  EXPECT_GT(now["since_reset_s"].get<double>(), 0);
  // As the board sends them: in 0.1 degrees, in mV.
  EXPECT_LE(now["drivers_celsius"].dump().size(), 5u) << now;
  EXPECT_LE(now["supply_v"].dump().size(), 6u) << now;
}

// Notes of another board would give this one its address and calibration.
TEST_F(RecoverVerb, NotesOfAnotherPortOrOfARunUnderWayAreRefused) {
  const host::BoardState before = state(1, true);
  Process suite(conformance("^calibration"));
  // Under their last name: they grow under another.
  const auto whole = [this] { return notes().size() == 1 && notes().front().ends_with(".json"); };
  for (int tries = 0; tries < 200 && !whole(); ++tries)
    std::this_thread::sleep_for(milliseconds(20));
  ASSERT_TRUE(whole());
  const std::string path = notes().front();
  Process other(kaz({"sim", "--mcu", "native", "--world", "empty", "--serial", folder_ / "other"}));
  ASSERT_TRUE(other.wait_for_output("ready", seconds(30)));
  const Finished early = run(kaz({"recover", folder_ / "other", "--from", path}));
  EXPECT_EQ(early.exit_code, 2) << early.out;
  EXPECT_NE(early.err.find("is still running"), std::string::npos) << early.err;
  // Nor are they free under another name.
  const std::string copy = folder_ / "copy.json";
  std::filesystem::copy_file(path, copy);
  const Finished copied =
      run(kaz({"recover", folder_ / "other", "--from", copy, "--port-changed"}));
  EXPECT_EQ(copied.exit_code, 2) << copied.out;
  EXPECT_NE(copied.err.find("is still running"), std::string::npos) << copied.err;

  suite.signal(SIGKILL);
  suite.wait(seconds(20));
  const Finished wrong = run(kaz({"recover", folder_ / "other", "--from", path}));
  EXPECT_EQ(wrong.exit_code, 2) << wrong.out;
  EXPECT_NE(wrong.err.find("notes of the board on " + port()), std::string::npos) << wrong.err;
  EXPECT_EQ(notes().size(), 1u);
  EXPECT_EQ(run(kaz({"recover", port(), "--from", path})).exit_code, 0);
  EXPECT_EQ(state(1, true), before);
}

TEST_F(RecoverVerb, At20RandomTimesOfASuiteTheBoardIsAsBefore) {
  const host::BoardState before = state(1, true);
  std::mt19937 random(20260702);
  int interrupted = 0;
  for (int n = 0; n < 20; ++n) {
    SCOPED_TRACE(n);
    const char* cases[] = {"^address.set$", "^address.shared-line$", "^calibration.store$"};
    Process suite(conformance(cases[random() % 3]));
    // Until its start is behind it, so that the times are spread over the case.
    std::this_thread::sleep_for(milliseconds(900 + random() % 1500));
    const int how[] = {SIGINT, SIGTERM, SIGKILL};
    const int number = how[n % 3];
    suite.signal(number);
    const Finished ended = suite.wait(seconds(20));
    interrupted += static_cast<int>(ended.exit_code != 0);
    if (number == SIGKILL) {
      for (const std::string& path : notes()) {
        const Finished recovered = run(kaz({"recover", port(), "--from", path}));
        EXPECT_EQ(recovered.exit_code, 0) << recovered.out << recovered.err;
      }
    } else {
      EXPECT_EQ(ended.err.find("kaz recover"), std::string::npos) << ended.err;
    }
    EXPECT_TRUE(notes().empty()) << notes().front();
    const host::BoardState now = state(1);
    EXPECT_EQ(now.address, 1);
    EXPECT_EQ(now.shared_line, before.shared_line);
    EXPECT_EQ(now.watchdog_10ms, before.watchdog_10ms);
    for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
      EXPECT_EQ(now.joints[j].centre, before.joints[j].stored_centre) << j;
      EXPECT_EQ(now.joints[j].kp, before.joints[j].kp) << j;
    }
  }
  EXPECT_GE(interrupted, 5);
  EXPECT_EQ(state(1, true), before);
}

// The first one waits for the board, which does not answer; the second one ends that and names the command.
TEST_F(RecoverVerb, ASecondSignalLaterEndsAtOnceAndNamesWhatIsLeft) {
  const host::BoardState before = state(1, true);
  Process suite(conformance("^address"));
  ASSERT_TRUE(suite.wait_for_output("10 %", seconds(30)));
  sim_.signal(SIGSTOP);
  bool ended = false;
  for (int press = 0; press < 8 && !ended; ++press) {
    suite.signal(SIGINT);
    ended = suite.prints_within("ended at once", seconds(1));
  }
  const Finished end = suite.wait(seconds(10));
  sim_.signal(SIGCONT);
  EXPECT_EQ(end.exit_code, 130) << end.err;
  EXPECT_TRUE(ended) << end.err;
  ASSERT_EQ(notes().size(), 1u) << end.err;
  EXPECT_NE(end.err.find("kaz conformance: interrupted, ended at once; the board on"),
            std::string::npos)
      << end.err;
  const std::string from = notes().front();
  EXPECT_NE(end.err.find("`kaz recover --robot serial:" + port() + " --from " + from + "`"),
            std::string::npos)
      << end.err;
  const Finished status = run(kaz({"status", "--port", port(), "--address", "1"}));
  if (status.exit_code == 0) {
    EXPECT_NE(status.err.find("--from " + from), std::string::npos) << status.err;
  }
  EXPECT_EQ(run(kaz({"recover", port(), "--from", from})).exit_code, 0);
  EXPECT_TRUE(notes().empty());
  EXPECT_EQ(state(1, true), before);
}

TEST_F(RecoverVerb, NotesThatCannotBeReadAreASentenceAndNoObstacle) {
  const std::string path = notes_file(port());
  constexpr const char* kTexts[] = {
      "",        "{",    "{\"kaz_kept_board\": 1, \"verb\": \"kaz fu", "{\"kaz_kept_board\": 99}",
      "[1e999]", nullptr};
  for (const char* text : kTexts) {
    SCOPED_TRACE(text ? text : "a folder");
    if (text) {
      write_file(path, text);
    } else {
      std::filesystem::remove(path);
      std::filesystem::create_directory(path);
    }
    const Finished given = run(kaz({"recover", port(), "--from", path}));
    EXPECT_EQ(given.exit_code, 2) << given.err;
    EXPECT_NE(given.err.find("or leave --from out"), std::string::npos) << given.err;
    const Finished without = run(kaz({"recover", port(), "--json"}));
    EXPECT_EQ(without.exit_code, 0) << without.err;
    EXPECT_TRUE(json::accept(without.out)) << without.out;
    EXPECT_NE(without.err.find(path), std::string::npos) << without.err;
    const Finished status = run(kaz({"status", "--port", port()}));
    EXPECT_EQ(status.exit_code, 0) << status.err;
    EXPECT_NE(status.err.find("then remove the notes"), std::string::npos) << status.err;
  }
  const Finished suite = run(conformance("^identity.identify$"));
  EXPECT_EQ(suite.exit_code, 0) << suite.err;
  EXPECT_NE(suite.err.find(path), std::string::npos) << suite.err;
}

// Verbs that only look at a board name them, too: whoever looks may be looking for what is wrong.
TEST_F(RecoverVerb, MonitorAndVisionNameNotes) {
  write_file(notes_file(port()), "{");
  const std::string named = "`kaz recover --robot serial:" + port() + "`";
  const Finished monitor = run(kaz({"monitor", "--port", port(), "--address", "3"}));
  EXPECT_EQ(monitor.exit_code, 3) << monitor.err;
  EXPECT_NE(monitor.err.find(named), std::string::npos) << monitor.err;

  const std::string seeing = folder_ / "seeing", eyes = folder_ / "eyes";
  Process sim(
      kaz({"sim", "--mcu", "native", "--world", "ball", "--serial", seeing, "--cameras", eyes}));
  ASSERT_TRUE(sim.wait_for_output("ready", seconds(30))) << sim.wait(seconds(0)).err;
  const auto vision = [&](std::vector<std::string> more) {
    std::vector<std::string> words{
        "vision",    "run",   "--in",     eyes, "--robot", "serial:" + seeing,
        "--modules", "color", "--frames", "2",  "--out",   folder_ / "out"};
    words.insert(words.end(), more.begin(), more.end());
    return run(kaz(words));
  };
  const std::string notes = notes_file(seeing), said = "kaz vision: the notes of a run";
  EXPECT_EQ(vision({}).err.find(said), std::string::npos);
  write_file(notes, "{");
  const Finished seen = vision({});
  EXPECT_EQ(seen.exit_code, 0) << seen.err;
  EXPECT_NE(seen.err.find(said), std::string::npos) << seen.err;
  EXPECT_NE(seen.err.find("`kaz recover --robot serial:" + seeing + "`"), std::string::npos)
      << seen.err;
  const Finished elsewhere = vision({"--address", "3"});
  EXPECT_EQ(elsewhere.exit_code, 3) << elsewhere.err;
  EXPECT_NE(elsewhere.err.find("`kaz recover --robot serial:" + seeing + "`"), std::string::npos)
      << elsewhere.err;
}

TEST_F(RecoverVerb, WithoutAPlaceForNotesNothingIsRun) {
  const host::BoardState before = state(1);
  write_file(folder_ / "kaz", "a file where the folder has to be");
  const Finished suite = run(conformance("^identity.identify$"));
  EXPECT_EQ(suite.exit_code, 3) << suite.out;
  EXPECT_NE(suite.err.find("set XDG_STATE_HOME to a writable folder"), std::string::npos)
      << suite.err;
  EXPECT_EQ(suite.out.find("passed"), std::string::npos) << suite.out;
  EXPECT_EQ(state(1), before);
}

TEST_F(RecoverVerb, APortThatDiesIsNamedWithTheCommand) {
  Process suite(conformance("^address"));
  ASSERT_TRUE(suite.wait_for_output("kaz conformance", seconds(20)));
  sim_.signal(SIGKILL);
  const Finished ended = suite.wait(seconds(30));
  EXPECT_EQ(ended.exit_code, 3) << ended.err;
  // Its link is still there, and may lead anywhere by now.
  const Finished status = run(kaz({"status", "--port", port()}));
  EXPECT_EQ(status.exit_code, 3) << status.out;
  EXPECT_NE(status.err.find("left behind by a `kaz sim` that was killed"), std::string::npos)
      << status.err;
  ASSERT_EQ(notes().size(), 1u) << ended.err;
  EXPECT_NE(ended.err.find("kaz recover --robot serial:" + port() + " --from " + notes().front()),
            std::string::npos)
      << ended.err;
}

}  // namespace
}  // namespace kaz::test
