// The examples in Python with the virtual robot, over pty and socket, as a user would run them; and the lock
// by which such a client and Kaz's programs exclude each other.
// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <cinttypes>
#include <csignal>
#include <cstdio>
#include <numbers>
#include <sstream>
#include <utility>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/robot/kinematics.h"
#include "shared/base/json_testing.h"
#include "tests/system/command_line/control_socket_testing.h"
#include "tests/system/command_line/process_testing.h"

namespace kaz::test {
namespace {

using std::chrono::seconds;

std::vector<std::string> example(const std::string& name, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {KAZ_PYTHON, "-B", "examples/python/" + name});
  return arguments;
}

std::vector<std::string> client(std::vector<std::string> arguments) {
  return example("kaz_client.py", std::move(arguments));
}

std::vector<std::string> simulator(const TemporaryFolder& folder, const std::string& world) {
  return kaz({"sim", "--world", world, "--mcu", "native", "--serial", folder / "board", "--cameras",
              folder / "eyes"});
}

// Gains of joint 0 as the board has them, read by itself: "16.00 0.090".
std::string gains_of_joint_0(const std::string& port) {
  const char* const program = R"(
import struct, sys
sys.path.insert(0, "examples/python")
import kaz_client
kp, kd = struct.unpack(">HH", kaz_client.Board(sys.argv[1]).request(0x14, b"\0")[7:11])
print(f"{kp / 256:.2f} {kd / 4096:.3f}")
)";
  const Finished finished = run({KAZ_PYTHON, "-B", "-c", program, port});
  EXPECT_EQ(finished.exit_code, 0) << finished.err;
  return finished.out;
}

class PythonClient : public ::testing::TestWithParam<const char*> {};

TEST_P(PythonClient, MovesAJointReadsItBackAndHandlesARefusal) {
  const TemporaryFolder folder;
  Process sim(kaz({"sim", "--world", "ball", "--mcu", GetParam(), "--serial", folder / "board",
                   "--cameras", folder / "eyes"}));
  ASSERT_TRUE(sim.wait_for_output("ready", seconds(30))) << sim.wait(seconds(0)).err;
  const std::string gains = gains_of_joint_0(folder / "board");
  const Finished finished = run(client({folder / "board", "--joint", "0", "--angle", "0.3"}));
  EXPECT_EQ(finished.exit_code, 0) << finished.out << finished.err;
  for (const char* text : {"18 joints, protocol 3", "joint 0 is on at", "joint 0 is at +0.",
                           "outside the joint's soft limits, joint 0", "all joints are off"})
    EXPECT_NE(finished.out.find(text), std::string::npos) << text << "\n" << finished.out;

  // A target that the joint cannot have is the same refusal, now as the result.
  const Finished refused = run(client({folder / "board", "--joint", "12", "--angle", "-1"}));
  EXPECT_EQ(refused.exit_code, 1) << refused.out << refused.err;
  EXPECT_NE(refused.err.find("outside the joint's soft limits, joint 12"), std::string::npos)
      << refused.err;
  const Finished status = run(kaz({"status", folder / "board"}));
  EXPECT_NE(status.out.find("after 90 ms without a request: limp"), std::string::npos)
      << "the link watchdog is not as the client found it\n"
      << status.out;
  EXPECT_EQ(gains_of_joint_0(folder / "board"), gains);
  sim.signal(SIGINT);
  EXPECT_EQ(sim.wait(seconds(10)).exit_code, 0);
}

INSTANTIATE_TEST_SUITE_P(Both, PythonClient, ::testing::Values("h8", "native"));

TEST(PythonClientAlone, SaysWhatIsWrong) {
  const Finished no_port = run(client({"/nowhere/board"}));
  EXPECT_EQ(no_port.exit_code, 3);
  EXPECT_NE(no_port.err.find("/nowhere/board"), std::string::npos) << no_port.err;
  EXPECT_EQ(run(client({"/nowhere/board", "--joint", "18"})).exit_code, 2);
  EXPECT_EQ(run(client({"--help"})).exit_code, 0);
}

// A joint that swings: one reading in the middle of it would find it at its target. On the board's clock.
TEST(PythonClientAlone, WaitsUntilTheJointRests) {
  const char* const program = R"(
import math, sys
sys.path.insert(0, "examples/python")
import kaz_client
kaz_client.time.sleep = lambda seconds: None

class Swinging:
    """A joint that swings around 0.3 rad until a given time of the board."""
    def __init__(self, until):
        self.now, self.until = 0.0, until
    def state(self):
        self.now += 0.02
        swing = 0.2 * math.sin(30 * self.now) if self.now < self.until else 0
        return self.now, 0, [0.3 + swing]

rests, swings, elsewhere = Swinging(1.6), Swinging(100), Swinging(0)
print(kaz_client.settle(rests, {0: 0.3}, 1), 1.65 < rests.now < 1.8)
print(kaz_client.settle(swings, {0: 0.3}, 1), 2.5 < swings.now < 2.6)
print(kaz_client.settle(elsewhere, {0: 0.5}, 1), elsewhere.now > 2.5)
print(kaz_client.settle(Swinging(0), {0: 0.5}, 1, near=math.inf))
)";
  const Finished finished = run({KAZ_PYTHON, "-B", "-c", program});
  EXPECT_EQ(finished.exit_code, 0) << finished.err;
  EXPECT_EQ(finished.out, "True True\nFalse True\nFalse True\nTrue\n");
}

// The simulator, or the board on the line, is gone in the middle of a motion: one sentence, no traceback.
TEST(PythonClientAlone, SaysThatTheBoardIsGone) {
  for (const int end : {SIGKILL, SIGSTOP}) {
    const TemporaryFolder folder;
    Process sim(simulator(folder, "empty"));
    ASSERT_TRUE(sim.wait_for_output("ready", seconds(30))) << sim.wait(seconds(0)).err;
    auto slow = client({folder / "board", "--seconds", "20"});
    slow.insert(slow.begin() + 1, "-u");
    Process moving(slow);
    ASSERT_TRUE(moving.wait_for_output("joint 0 is on", seconds(20)));
    sim.signal(end);
    const Finished finished = moving.wait(seconds(20));
    EXPECT_EQ(finished.exit_code, 3) << finished.out << finished.err;
    EXPECT_EQ(finished.err.find("Traceback"), std::string::npos) << finished.err;
    EXPECT_NE(finished.err.find("the motors may still hold"), std::string::npos) << finished.err;
    EXPECT_NE(finished.err.find(end == SIGKILL ? "is gone" : "no board answers"), std::string::npos)
        << finished.err;
  }
}

TEST(PythonClientAlone, SwitchesTheMotorsOffWhenInterrupted) {
  const TemporaryFolder folder;
  Process sim(simulator(folder, "catch"));
  ASSERT_TRUE(sim.wait_for_output("ready", seconds(30))) << sim.wait(seconds(0)).err;
  auto moves = client({folder / "board", "--seconds", "20"});
  auto looks = example("kaz_ball.py", {folder / "board", folder / "eyes"});
  for (auto* program : {&moves, &looks}) {
    for (const int number : {SIGINT, SIGTERM}) {
      auto command = *program;
      command.insert(command.begin() + 1, "-u");
      Process running(command);
      ASSERT_TRUE(
          running.wait_for_output(program == &moves ? "joint 0 is on" : "head at", seconds(30)))
          << running.wait(seconds(0)).err;
      running.signal(number);
      const Finished finished = running.wait(seconds(10));
      EXPECT_EQ(finished.exit_code, 128 + number) << finished.out << finished.err;
      EXPECT_NE(finished.err.find(": interrupted\n"), std::string::npos) << finished.err;
      EXPECT_EQ(finished.err.find("Traceback"), std::string::npos) << finished.err;
      const Finished status = run(kaz({"status", "--port", folder / "board", "--json"}));
      EXPECT_NE(status.out.find("\"motors\": \"off\""), std::string::npos) << status.out;
    }
  }
}

// A client of somebody's own that has read docs/reference/protocol.md: it takes the lock and nothing else.
std::vector<std::string> foreign(const std::string& port) {
  return {KAZ_PYTHON, "-c",
          "import fcntl, os, sys, time\n"
          "port = os.open(sys.argv[1], os.O_RDWR | os.O_NOCTTY)\n"
          "fcntl.flock(port, fcntl.LOCK_EX | fcntl.LOCK_NB)\n"
          "print('locked', flush=True)\n"
          "time.sleep(60)\n",
          port};
}

TEST(PortLock, AForeignClientAndKazExcludeEachOther) {
  const TemporaryFolder folder;
  Process sim(simulator(folder, "empty"));
  ASSERT_TRUE(sim.wait_for_output("ready", seconds(30))) << sim.wait(seconds(0)).err;
  const auto status = kaz({"status", "--port", folder / "board"});
  const std::string sentence =
      (folder / "board") + " is in use by another program: end that program first";
  {
    Process holder(foreign(folder / "board"));
    ASSERT_TRUE(holder.wait_for_output("locked", seconds(10))) << holder.wait(seconds(0)).err;
    const Finished refused = run(status);
    EXPECT_EQ(refused.exit_code, 3) << refused.out << refused.err;
    EXPECT_NE(refused.err.find(sentence), std::string::npos) << refused.err;
    const Finished other = run(client({folder / "board"}));
    EXPECT_EQ(other.exit_code, 3) << other.out;
    EXPECT_NE(other.err.find("is in use by another program"), std::string::npos) << other.err;
    const Finished capture = run(example("kaz_pcap.py", {folder / "board", folder / "pcap"}));
    EXPECT_EQ(capture.exit_code, 3) << capture.out;
    EXPECT_NE(capture.err.find("is in use by another program"), std::string::npos) << capture.err;
  }
  EXPECT_EQ(run(status).exit_code, 0) << "the lock of a killed program is gone";

  Process behavior(kaz({"run", "track-ball", "--robot", "serial:" + (folder / "board"), "--camera",
                        folder / "eyes", "--duration", "60"}));
  ASSERT_TRUE(behavior.wait_for_output("search", seconds(20))) << behavior.wait(seconds(0)).err;
  const Finished refused = run(foreign(folder / "board"));
  EXPECT_EQ(refused.exit_code, 1) << refused.out;
  EXPECT_NE(refused.err.find("BlockingIOError"), std::string::npos) << refused.err;
  EXPECT_EQ(run(client({folder / "board"})).exit_code, 3);
}

// Only captures are replaced, and only by one with a frame.
TEST(PythonCapture, OfNoFrameIsAnErrorAndOtherFilesStay) {
  const TemporaryFolder folder;
  write_file(folder / "none.bin", "no zero");
  write_file(folder / "two.bin", std::string("\0abc\0\0de\0", 9));
  write_file(folder / "notes.txt", "mine");
  const auto capture = [&](const std::string& from, const std::string& to) {
    return run(example("kaz_pcap.py", {folder / from, folder / to}));
  };
  const Finished none = capture("none.bin", "line.pcap");
  EXPECT_EQ(none.exit_code, 1) << none.out;
  EXPECT_NE(none.err.find("no frame came from"), std::string::npos) << none.err;
  EXPECT_NE(access((folder / "line.pcap").c_str(), F_OK), 0);
  const Finished two = capture("two.bin", "line.pcap");
  EXPECT_EQ(two.exit_code, 0) << two.err;
  EXPECT_EQ(two.out, "2 frames\n");
  const std::string bytes = read_file(folder / "line.pcap");
  EXPECT_EQ(bytes.size(), 24u + 16 + 5 + 16 + 4);
  EXPECT_EQ(bytes.find("\xd4\xc3\xb2\xa1"), 0u);
  EXPECT_EQ(capture("none.bin", "line.pcap").exit_code, 1);
  EXPECT_EQ(read_file(folder / "line.pcap"), bytes);
  EXPECT_EQ(capture("two.bin", "line.pcap").exit_code, 0);
  EXPECT_EQ(read_file(folder / "line.pcap").size(), bytes.size());
  const Finished refused = capture("two.bin", "notes.txt");
  EXPECT_EQ(refused.exit_code, 2) << refused.out;
  EXPECT_NE(refused.err.find("is not a capture and would be replaced"), std::string::npos)
      << refused.err;
  EXPECT_EQ(read_file(folder / "notes.txt"), "mine");
  const Finished help = run(example("kaz_pcap.py", {"--help"}));
  EXPECT_NE(help.out.find("exit status: 0 captured; 1 no frame"), std::string::npos) << help.out;
}

// Where the head must point, from the ball's true place and the robot's geometry.
TEST(PythonBall, TurnsTheHeadToTheBall) {
  const TemporaryFolder folder;
  Process sim(simulator(folder, "catch"));
  ASSERT_TRUE(sim.wait_for_output("ready", seconds(30))) << sim.wait(seconds(0)).err;
  const Finished finished = run(example("kaz_ball.py", {folder / "board", folder / "eyes"}));
  EXPECT_EQ(finished.exit_code, 0) << finished.out << finished.err;
  const std::string words = "the head points at the ball: ";
  const auto at = finished.out.find(words);
  ASSERT_NE(at, std::string::npos) << finished.out;
  double pan = 0, tilt = 0;
  ASSERT_EQ(std::sscanf(finished.out.c_str() + at + words.size(), "pan %lf, tilt %lf", &pan, &tilt),
            2);

  const auto ball = parse_json(query_control(folder / "board.ctl", "status"))["ball_m"]
                        .get<std::vector<double>>();
  // The robot stands upright, the middle between its soles at the origin.
  const Eigen::Vector3d sole = host::trunk_from_sole({}, host::Side::left).translation();
  const auto gaze = host::gaze_at({ball[0] + sole.x(), ball[1], ball[2] + sole.z()});
  constexpr double kTolerance = 4 * std::numbers::pi / 180;
  EXPECT_NEAR(pan, gaze.pan_rad, kTolerance);
  EXPECT_NEAR(tilt, gaze.tilt_rad, kTolerance);
}

TEST(PythonBall, SaysWhatIsWrong) {
  const Finished no_camera = run(example("kaz_ball.py", {"/nowhere/board", "/nowhere/eyes"}));
  EXPECT_EQ(no_camera.exit_code, 3);
  EXPECT_NE(no_camera.err.find("no camera at '/nowhere/eyes'"), std::string::npos) << no_camera.err;
  EXPECT_EQ(run(example("kaz_ball.py", {"/nowhere/board"})).exit_code, 2);
}

// The reader that docs/reference/camera-stream.md prints, on a real stream.
TEST(CameraStreamPage, ItsReaderReads) {
  const std::string page = read_file("docs/reference/camera-stream.md"), begin = "```python\n";
  const auto from = page.find(begin);
  ASSERT_NE(from, std::string::npos);
  const auto code = from + begin.size();
  const TemporaryFolder folder;
  Process sim(simulator(folder, "ball"));
  ASSERT_TRUE(sim.wait_for_output("ready", seconds(30))) << sim.wait(seconds(0)).err;
  std::string reader = page.substr(code, page.find("```", code) - code);
  const std::string path = "board.eyes";
  ASSERT_NE(reader.find(path), std::string::npos);
  reader.replace(reader.find(path), path.size(), folder / "eyes");
  Process reading({KAZ_PYTHON, "-u", "-c", reader});
  ASSERT_TRUE(reading.wait_for_output("\n", seconds(20))) << reading.wait(seconds(0)).err;
  ::usleep(500'000);
  sim.signal(SIGINT);
  EXPECT_EQ(sim.wait(seconds(10)).exit_code, 0);
  const Finished finished = reading.wait(seconds(10));
  EXPECT_EQ(finished.exit_code, 0) << finished.err;
  std::istringstream lines(finished.out);
  std::uint64_t sequence = 0, last = 0;
  std::int64_t exposure_ns = 0, before_ns = 0;
  int pairs = 0;
  for (std::string line; std::getline(lines, line);
       ++pairs, last = sequence, before_ns = exposure_ns) {
    ASSERT_EQ(std::sscanf(line.c_str(), "%" SCNu64 " %" SCNd64, &sequence, &exposure_ns), 2)
        << line;
    if (pairs == 0) continue;
    ASSERT_GT(sequence, last);
    // 30 exposures a second of the robot; where the machine is too slow, its time stands still meanwhile.
    const double between = 1e-9 * static_cast<double>(exposure_ns - before_ns);
    const double expected = static_cast<double>(sequence - last) / 30;
    EXPECT_GT(between, expected - 0.02);
    EXPECT_LT(between, expected + 2);
  }
  EXPECT_GE(pairs, 3) << finished.out;
}

}  // namespace
}  // namespace kaz::test
