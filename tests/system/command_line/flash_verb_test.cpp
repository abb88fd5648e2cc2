// `kaz flash` over a real pty against `kaz sim`: an erased board, a running one, a killed program, a file
// cut off, a reset by hand, and what each verb says.
// SPDX-License-Identifier: Apache-2.0
#include <csignal>
#include <filesystem>
#include <memory>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/link/tty_link.h"
#include "host/link/wall_clock.h"
#include "host/robot/robot.h"
#include "shared/base/json_testing.h"
#include "tests/system/command_line/control_socket_testing.h"
#include "tests/system/command_line/process_testing.h"

namespace kaz::test {
namespace {

using nlohmann::json;
using std::chrono::seconds;

std::string image() {
  const auto program = std::filesystem::path(kaz({}).front());
  return program.parent_path().parent_path() / "firmware/kaz.mot";
}

class FlashVerb : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(std::filesystem::exists(image()))
        << image() << " is missing: ./tools/dev setup installs its compiler";
    sim_ = std::make_unique<Process>(
        kaz({"sim", "--world", "empty", "--serial", folder_ / "board", "--erased"}));
    ASSERT_TRUE(sim_->wait_for_output("ready", seconds(30))) << sim_->wait(seconds(0)).err;
  }
  std::vector<std::string> write(std::vector<std::string> more) const {
    std::vector<std::string> all{"flash", "write", image(), "--port", folder_ / "board"};
    all.insert(all.end(), more.begin(), more.end());
    return kaz(all);
  }
  std::string control() const { return "ctl:" + (folder_ / "board.ctl"); }
  void control(const std::string& request) const {
    EXPECT_NE(query_control(folder_ / "board.ctl", request).find("\"ok\":true"), std::string::npos);
  }
  Finished verb(const std::string& name, std::vector<std::string> more = {}) const {
    std::vector<std::string> all{"flash", name, "--port", folder_ / "board"};
    all.insert(all.end(), more.begin(), more.end());
    return run(kaz(all), seconds(60));
  }

  TemporaryFolder folder_;
  std::unique_ptr<Process> sim_;
};

TEST_F(FlashVerb, ErasedBoardThenTheLoader) {
  const Finished first = run(write({"--reset", control(), "--json"}), seconds(90));
  ASSERT_EQ(first.exit_code, 0) << first.err;
  const json report = parse_json(first.out);
  ASSERT_TRUE(report.is_object()) << first.out;
  EXPECT_TRUE(report["ok"]);
  EXPECT_TRUE(report["verified"]);
  EXPECT_EQ(report["erased"], "all");
  EXPECT_GT(report["efficiency"].get<double>(), 0);
  EXPECT_TRUE(report["runs"].contains("crc")) << first.out;
  // The same image through the loader: nothing to do.
  const Finished again = run(write({"--json"}), seconds(60));
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(parse_json(again.out)["written"], 0);
  // A file of the loader's block alone: forced, but nothing of it can be written.
  write_file(folder_ / "loader.bin", std::string(64, 'x'));
  const Finished kept = run(kaz({"flash", "write", folder_ / "loader.bin", "--format", "raw",
                                 "--at", "0xc100", "--force", "--port", folder_ / "board"}),
                            seconds(60));
  EXPECT_EQ(kept.exit_code, 2) << kept.out;
  EXPECT_NE(kept.err.find("cannot write any part of the image"), std::string::npos) << kept.err;
  // One that is all ff has nothing to compare.
  write_file(folder_ / "blank.bin", std::string(64, '\xff'));
  for (const char* name : {"verify", "write"}) {
    const Finished blank = run(kaz({"flash", name, folder_ / "blank.bin", "--format", "raw", "--at",
                                    "0x8000", "--port", folder_ / "board"}),
                               seconds(60));
    EXPECT_EQ(blank.exit_code, 2) << blank.out;
    EXPECT_NE(blank.err.find("nothing to write or to compare"), std::string::npos) << blank.err;
  }
  // A file that was cut off goes nowhere.
  std::string text = read_file(image());
  write_file(folder_ / "cut.mot", text.substr(0, text.size() / 2));
  const Finished cut =
      run(kaz({"flash", "write", folder_ / "cut.mot", "--port", folder_ / "board", "--json"}),
          seconds(20));
  EXPECT_EQ(cut.exit_code, 2);
  EXPECT_NE(cut.err.find("cut off"), std::string::npos) << cut.err;
  const json refusal = parse_json(cut.out);
  ASSERT_TRUE(refusal.is_object()) << cut.out;
  EXPECT_FALSE(refusal["ok"]);
  EXPECT_NE(refusal["error"].get<std::string>().find("cut off"), std::string::npos);
}

TEST_F(FlashVerb, KilledInTheMiddleAndTakenUpAgain) {
  Process killed(write({"--reset", control()}));
  ASSERT_TRUE(killed.wait_for_output("write", seconds(60)));
  killed.signal(SIGKILL);
  EXPECT_EQ(killed.wait(seconds(5)).exit_code, 128 + SIGKILL);
  // Reading names the interrupted write, and leaves its writer on the board: the second look finds it, too.
  for (int look = 0; look < 2; ++look) {
    const Finished info = verb("info", {"--json"});
    ASSERT_EQ(info.exit_code, 0) << info.err;
    const json reported = parse_json(info.out);
    EXPECT_EQ(reported["started_by"], "boot mode");
    ASSERT_EQ(reported["interrupted"].size(), 1u) << info.out;
    const auto sentence = reported["interrupted"][0].get<std::string>();
    for (const std::string& part : {"flash write " + image(), "--reset " + control(),
                                    std::string("give the same command again in ")})
      EXPECT_NE(sentence.find(part), std::string::npos) << sentence;
  }
  const Finished silent = run(kaz({"status", "--port", folder_ / "board"}), seconds(30));
  EXPECT_EQ(silent.exit_code, 3) << silent.out;
  EXPECT_NE(silent.err.find("was ended before the flash was complete"), std::string::npos)
      << silent.err;
  const Finished again = run(write({"--reset", control()}), seconds(90));
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_NE(again.out.find("efficiency"), std::string::npos);
  EXPECT_NE(again.out.find("the whole flash erased"), std::string::npos) << again.out;
  EXPECT_NE(again.out.find("boot mode has erased the stored calibration"), std::string::npos);
  const json after = parse_json(verb("info", {"--json"}).out);
  EXPECT_EQ(after["started_by"], "loader");
  EXPECT_TRUE(after["interrupted"].empty()) << after;
}

// The test is who sets the switch and presses the button.
TEST_F(FlashVerb, ManualResetByHand) {
  Process program(write({"--reset", "manual"}), true);
  ASSERT_TRUE(program.wait_for_output("to boot mode", seconds(30)));
  control("mode boot");
  control("reset");
  program.type("\n");
  // On a busy machine boot mode may fail, and is requested once more.
  bool again = false;
  for (int i = 0; i < 120 && !program.prints_within("back to run", seconds(1)); ++i) {
    if (again || !program.prints_within("retrying boot mode", seconds(0))) continue;
    again = true;
    control("reset");
    program.type("\n");
  }
  ASSERT_TRUE(program.prints_within("back to run", seconds(0))) << program.wait(seconds(0)).err;
  control("mode run");
  control("reset");
  program.type("\n");
  const Finished done = program.wait(seconds(30));
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_NE(done.out.find("runs: firmware"), std::string::npos) << done.out;
}

TEST_F(FlashVerb, ManualResetEndsWithNobodyThereAndWithCtrlC) {
  const Finished nobody = run(write({"--reset", "manual"}), seconds(30));
  EXPECT_EQ(nobody.exit_code, 2);
  EXPECT_NE(nobody.err.find("keyboard"), std::string::npos) << nobody.err;
  Process stopped(write({"--reset", "manual"}), true);
  ASSERT_TRUE(stopped.wait_for_output("press Enter", seconds(30)));
  stopped.signal(SIGINT);
  const Finished end = stopped.wait(seconds(10));
  EXPECT_EQ(end.exit_code, 130);
  EXPECT_NE(end.err.find("interrupted"), std::string::npos) << end.err;
}

TEST_F(FlashVerb, APtyHasNoModemLines) {
  const Finished done = run(write({"--reset", "dtr-rts"}), seconds(20));
  EXPECT_EQ(done.exit_code, 3);
  for (const char* part : {"pseudo-terminal", "DTR and RTS", "--reset ctl:", "board.ctl"})
    EXPECT_NE(done.err.find(part), std::string::npos) << done.err;
}

TEST_F(FlashVerb, TheControlSocketIsNoPort) {
  const Finished done = run(kaz({"flash", "info", "--port", folder_ / "board.ctl"}), seconds(20));
  EXPECT_EQ(done.exit_code, 3);
  EXPECT_NE(done.err.find("control socket of `kaz sim`; its serial port is " + (folder_ / "board")),
            std::string::npos)
      << done.err;
}

TEST_F(FlashVerb, EachVerbSaysWhatItDid) {
  ASSERT_EQ(run(write({"--reset", control()}), seconds(90)).exit_code, 0);
  const Finished info = verb("info", {"--json"});
  EXPECT_EQ(parse_json(info.out)["application"]["board_id"], "2128") << info.out;
  EXPECT_EQ(parse_json(info.out)["application"]["firmware"], "0.2") << info.out;
  const Finished run_it = verb("run");
  EXPECT_EQ(run_it.exit_code, 0) << run_it.err;
  EXPECT_NE(run_it.out.find("runs: firmware"), std::string::npos) << run_it.out;
  const Finished what = verb("erase");
  EXPECT_EQ(what.exit_code, 2);
  EXPECT_NE(what.err.find("--blocks"), std::string::npos) << what.err;
  EXPECT_EQ(verb("erase", {"--blocks", "4,6"}).exit_code, 2) << "the loader keeps itself";
  EXPECT_EQ(verb("erase", {"--blocks", "4", "--reset", control()}).exit_code, 2);
  EXPECT_EQ(verb("erase", {"--blocks", "4,4"}).exit_code, 2) << "it would be erased twice";
  EXPECT_EQ(verb("erase", {"--blocks", "4", "--writer", image()}).exit_code, 2)
      << "the loader would not take it";
  const Finished erased = verb("erase", {"--blocks", "4"});
  EXPECT_EQ(erased.exit_code, 0) << erased.err;
  EXPECT_NE(erased.out.find("erased: EB4"), std::string::npos) << erased.out;
  const Finished nothing = verb("run", {"--json"});
  EXPECT_EQ(nothing.exit_code, 1) << nothing.out;
  EXPECT_FALSE(parse_json(nothing.out)["ok"]);
  EXPECT_NE(verb("info").out.find("application: none"), std::string::npos);
  const Finished all = verb("erase", {"--reset", control()});
  EXPECT_EQ(all.exit_code, 0) << all.err;
  EXPECT_NE(all.out.find("the whole flash"), std::string::npos) << all.out;
}

TEST_F(FlashVerb, InterruptedInTheMiddleSaysWhatToDo) {
  Process stopped(write({"--reset", control()}));
  ASSERT_TRUE(stopped.wait_for_output("20 %  write", seconds(60)));
  stopped.signal(SIGINT);
  const Finished end = stopped.wait(seconds(10));
  EXPECT_EQ(end.exit_code, 130);
  for (const char* part : {"interrupted", "still in boot mode", "same command again"})
    EXPECT_NE(end.err.find(part), std::string::npos) << end.err;
}

TEST_F(FlashVerb, NobodyAnswersWithoutBootMode) {
  const Finished silent = run(write({}), seconds(30));
  EXPECT_EQ(silent.exit_code, 3);
  for (const char* part : {"blank", "expected:", "found:", "1. ", "next: kaz flash write"})
    EXPECT_NE(silent.err.find(part), std::string::npos) << silent.err;
  const Finished info = verb("info");
  EXPECT_EQ(info.exit_code, 3);
  EXPECT_NE(info.err.find("next: kaz flash write IMAGE"), std::string::npos) << info.err;
  EXPECT_EQ(
      run(kaz({"flash", "verify", image(), "--port", folder_ / "board", "--reset", control()}))
          .exit_code,
      2);
}

TEST(FlashUsage, ARateOfThePortIsRefused) {
  for (const char* verb : {"info", "run"}) {
    const Finished refused = run(kaz({"flash", verb, "--port", "/no/such/port@9600"}));
    EXPECT_EQ(refused.exit_code, 2) << refused.err;
    EXPECT_NE(refused.err.find("Give --robot serial:/no/such/port"), std::string::npos)
        << refused.err;
  }
}

TEST(FlashUsage, TheNativeBoardHasNoLoader) {
  const TemporaryFolder folder;
  Process sim(kaz({"sim", "--world", "empty", "--mcu", "native", "--serial", folder / "board"}));
  ASSERT_TRUE(sim.wait_for_output("ready", seconds(30))) << sim.wait(seconds(0)).err;
  for (const auto& words : {std::vector<std::string>{"info"},
                            {"run"},
                            {"write", image()},
                            {"write", image(), "--reset", "ctl:" + (folder / "board.ctl")}}) {
    std::vector<std::string> all{"flash"};
    all.insert(all.end(), words.begin(), words.end());
    all.insert(all.end(), {"--port", folder / "board"});
    const Finished refused = run(kaz(all), seconds(30));
    EXPECT_EQ(refused.exit_code, 2) << refused.err;
    EXPECT_NE(refused.err.find("runs --mcu native, which has no loader"), std::string::npos)
        << refused.err;
    EXPECT_NE(refused.err.find("start the simulator with --mcu h8"), std::string::npos)
        << refused.err;
    EXPECT_EQ(refused.err.find("likely causes"), std::string::npos) << refused.err;
  }
}

// With a firmware, and not erased.
class FlashRunning : public ::testing::Test {
 protected:
  FlashRunning() {
    EXPECT_TRUE(sim_.wait_for_output("ready", seconds(30))) << sim_.wait(seconds(0)).err;
  }
  std::string port() const { return folder_ / "board"; }

  TemporaryFolder folder_;
  Process sim_{kaz({"sim", "--world", "empty", "--serial", port()})};
};

TEST_F(FlashRunning, IsStartedAgainAfterAnInterruptedReading) {
  Process reading(kaz({"flash", "read", "--port", port(), "--out", folder_ / "flash.bin"}));
  ASSERT_TRUE(reading.wait_for_output("read ", seconds(30))) << reading.wait(seconds(0)).err;
  reading.signal(SIGINT);
  const Finished end = reading.wait(seconds(10));
  EXPECT_EQ(end.exit_code, 130) << end.err;
  EXPECT_NE(end.err.find("interrupted; the board was started again"), std::string::npos) << end.err;
  const Finished status = run(kaz({"status", "--port", port()}), seconds(20));
  EXPECT_EQ(status.exit_code, 0) << status.err;
}

TEST_F(FlashRunning, AtAnotherAddressIsNamedWhenItIsStarted) {
  {
    const auto link = host::TtyLink::open(port());
    ASSERT_TRUE(link) << link.error().message;
    host::WallClock clock;
    auto robot = host::Robot::connect(**link, clock, {.reconnect = Time::zero()});
    ASSERT_TRUE(robot) << robot.error().message;
    ASSERT_TRUE(robot->unlock(5));
    ASSERT_TRUE(robot->set_address(5, false));
    (void)robot->reset();  // it answers elsewhere
  }
  const Finished erased =
      run(kaz({"flash", "erase", "--blocks", "7", "--port", port(), "--address", "5"}));
  ASSERT_EQ(erased.exit_code, 0) << erased.err;
  const Finished started = run(kaz({"flash", "run", "--port", port()}), seconds(30));
  EXPECT_EQ(started.exit_code, 3) << started.out << started.err;
  EXPECT_NE(started.err.find("the board was started; no board answers at address 1"),
            std::string::npos)
      << started.err;
  EXPECT_NE(started.err.find("give --address 5"), std::string::npos) << started.err;
}

}  // namespace
}  // namespace kaz::test
