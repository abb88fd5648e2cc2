// `kaz monitor` in a terminal (tmux), on the board of the virtual robot: what it shows, and its keys.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <filesystem>
#include <regex>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "tests/system/command_line/process_testing.h"

namespace kaz::test {
namespace {

using std::chrono::seconds;

// A terminal of 80 x 24 of its own, with the program in it.
class Screen {
 public:
  explicit Screen(const std::string& command, int columns = 80, int rows = 24)
      : name_("kaz-monitor-test-" + std::to_string(getpid())) {
    const Finished begun =
        tmux({"-f", "/dev/null", "new-session", "-d", "-x", std::to_string(columns), "-y",
              std::to_string(rows), command + "; echo left with $?; sleep 60"});
    begun_ = begun.exit_code == 0;
    EXPECT_TRUE(begun_) << begun.err;
  }
  ~Screen() { tmux({"kill-server"}); }
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  std::string text() { return tmux({"capture-pane", "-p"}).out; }
  void press(const std::vector<std::string>& keys) {
    std::vector<std::string> arguments{"send-keys"};
    arguments.insert(arguments.end(), keys.begin(), keys.end());
    tmux(arguments);
  }
  // Until the screen matches; then it, else the last one and a failure.
  std::string wait(const std::string& pattern) {
    const std::regex wanted(pattern);
    std::string now;
    for (int i = 0; i < 150; ++i) {
      now = text();
      if (std::regex_search(now, wanted)) return now;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    ADD_FAILURE() << "never: " << pattern << "\n" << now;
    return now;
  }

 private:
  Finished tmux(std::vector<std::string> arguments) {
    std::vector<std::string> all{"/usr/bin/env", "LC_ALL=C.UTF-8", "tmux", "-L", name_};
    all.insert(all.end(), arguments.begin(), arguments.end());
    return run(all, seconds(10));
  }
  std::string name_;
  bool begun_ = false;
};

TEST(Monitor, ShowsJointsMovesAndStopsThemAndFindsABoardAgain) {
  const TemporaryFolder folder;
  const auto sim_command = kaz({"sim", "--mcu", "native", "--serial", folder / "board"});
  auto sim = std::make_unique<Process>(sim_command);
  ASSERT_TRUE(sim->wait_for_output("ready", seconds(30)));
  std::string command;
  for (const std::string& word : kaz({"monitor", "--port", folder / "board"}))
    command += word + " ";
  Screen screen(command);

  // All 18 joints, in 24 lines; nothing was switched on by looking.
  std::string now = screen.wait("motors off[^]*neck_pan[^]*r_ankle_pitch[^]*quit");
  std::istringstream lines(now);
  int rows = 0;
  for (std::string line; std::getline(lines, line); ++rows) EXPECT_LE(line.size(), 80u) << line;
  EXPECT_EQ(rows, 24);
  EXPECT_TRUE(std::regex_search(now, std::regex("supply (9|10)\\.[0-9]+ V"))) << now;
  EXPECT_TRUE(std::regex_search(now, std::regex("tick [0-9]+ %, worst [0-9]+ %, missed 0"))) << now;
  EXPECT_FALSE(std::regex_search(now, std::regex(" %( moves)? on"))) << now;

  // A joint that is off is not moved; switched on it goes where the keys say.
  screen.press({"]"});
  screen.wait("neck_pan is off: press e to switch it on");
  screen.press({"e"});
  screen.wait("motors on[^]*0 neck_pan .* on");
  screen.press({"]", "]", "Right"});
  screen.wait("neck_pan to 1[01]\\.[0-9] degrees");
  screen.wait("0 neck_pan +1[01]\\.[0-9] +1[01]\\.[0-9]");
  screen.press({"Down", "e"});
  screen.wait("1 neck_tilt .* on");

  // The emergency stop, shown with its reason, and its end.
  screen.press({"Space"});
  screen.wait("motors off: shutdown[^]*stop");
  screen.press({"c"});
  screen.wait("motors off *\n[^]*no shutdown is latched");

  // The board goes and comes again.
  sim->signal(SIGINT);
  sim->wait(seconds(10));
  screen.wait("no answer");
  sim = std::make_unique<Process>(sim_command);
  screen.wait("the board answers again");

  screen.press({"q"});
  screen.wait("left with 0");
}

// The arm SO-101 on a virtual bus.
class VirtualArm {
 public:
  VirtualArm() { EXPECT_TRUE(sim_.wait_for_output("ready", seconds(30))); }
  std::string port() const { return "feetech:" + (folder_ / "arm"); }
  // The command line of `kaz monitor` for it.
  std::string monitor() const {
    std::string command;
    for (const std::string& word : kaz({"monitor", port(), "--robot-file", file_}))
      command += word + " ";
    return command;
  }
  void signal(int number) { sim_.signal(number); }

 private:
  const TemporaryFolder folder_;
  const std::string file_ = std::filesystem::absolute("sim/robots/so101/so101.urdf");
  Process sim_{
      kaz({"sim", "--bus", "feetech", "--robot-file", file_, "--serial", folder_ / "arm"})};
};

// Six servos of an arm, by their names; a key moves one, and q lets go of it.
TEST(Monitor, ShowsAndMovesTheServosOfABus) {
  VirtualArm arm;
  Screen screen(arm.monitor());
  const std::string now = screen.wait("motors off[^]*0 shoulder_pan[^]*5 gripper[^]*quit");
  EXPECT_EQ(now.find("neck_pan"), std::string::npos) << now;
  screen.press({"e"});
  screen.wait("0 shoulder_pan .* on");
  screen.press({"]", "]"});
  screen.wait("shoulder_pan to +[0-9.]+ degrees");
  screen.wait("0 shoulder_pan +10\\.[0-9] +(8|9|10)\\.[0-9]");
  screen.press({"q"});
  screen.wait("left with 0");
  const Finished unnamed = run(kaz({"monitor", arm.port()}));
  EXPECT_EQ(unnamed.exit_code, 2);
  EXPECT_NE(unnamed.err.find("needs --robot-file FILE"), std::string::npos) << unnamed.err;
}

// The second signal ends it while it waits for servos, which have no watchdog.
TEST(Monitor, EndedAtOnceItSaysThatMotorsMayBeOn) {
  VirtualArm arm;
  Screen screen(arm.monitor());
  screen.wait("motors off[^]*0 shoulder_pan");
  screen.press({"e"});
  screen.wait("0 shoulder_pan .* on");
  arm.signal(SIGSTOP);
  for (int i = 0; i < 20 && screen.text().find("left with") == std::string::npos; ++i) {
    screen.press({"C-c"});
    std::this_thread::sleep_for(std::chrono::milliseconds(600));
  }
  arm.signal(SIGCONT);
  screen.wait("ended at once; the motors on[^]*may[^]*be[^]*on[^]*power[^]*left with 130");
}

// Nothing wraps; the joint that the keys are about is always among those shown.
TEST(Monitor, FitsIntoASmallWindow) {
  const TemporaryFolder folder;
  Process sim(kaz({"sim", "--mcu", "native", "--serial", folder / "board"}));
  ASSERT_TRUE(sim.wait_for_output("ready", seconds(30)));
  std::string command;
  for (const std::string& word : kaz({"monitor", "--port", folder / "board"}))
    command += word + " ";
  Screen screen(command, 40, 10);
  // Each thing by itself: what a screen holds before the board is read is not specified.
  screen.wait("motors off");
  screen.wait(" 0 neck_pan +-?[0-9]+\\.[0-9] off");
  const std::string now = screen.wait("q quit  SPACE stop");
  std::istringstream lines(now);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 40u) << line;
  screen.press({"Up"});  // from the first joint to the last
  screen.wait("17 [a-z_]+ +-?[0-9]+\\.[0-9] off");
  screen.press({"q"});
  screen.wait("left with 0");
}

// Notes of a run that was killed: said on the screen, and printed where the screen does not cover them.
TEST(Monitor, NamesNotesOfAnEarlierRun) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "kaz");
  std::string name = "board" + (folder / "board");
  std::ranges::replace_if(
      name, [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  write_file((folder / "kaz") + "/" + name + "-1.json", "{");
  Process sim(kaz({"sim", "--mcu", "native", "--serial", folder / "board"}));
  ASSERT_TRUE(sim.wait_for_output("ready", seconds(30)));
  std::string command = "XDG_STATE_HOME=" + folder.path() + " ";
  for (const std::string& word : kaz({"monitor", "--port", folder / "board"}))
    command += word + " ";
  Screen screen(command);
  screen.wait("an interrupted run left notes: press q to quit and print the notes");
  screen.press({"q"});
  screen.wait("kaz monitor: the notes of a run[^]*left with 0");
}

TEST(Monitor, NeedsATerminalAndABoard) {
  const TemporaryFolder folder;
  const Finished none = run(kaz({"monitor", "--port", folder / "none"}));
  EXPECT_EQ(none.exit_code, 3) << none.err;
  Process sim(kaz({"sim", "--mcu", "native", "--serial", folder / "board"}));
  ASSERT_TRUE(sim.wait_for_output("ready", seconds(30)));
  const Finished piped = run(kaz({"monitor", "--port", folder / "board"}));
  EXPECT_EQ(piped.exit_code, 2) << piped.err;
  EXPECT_NE(piped.err.find("kaz status --json"), std::string::npos) << piped.err;
}

}  // namespace
}  // namespace kaz::test
