// Cameras that send nothing, stop, send half a pair, or are plugged in the wrong way round: as kaz run and
// kaz vision run see them, beside a simulator whose board is healthy.
// SPDX-License-Identifier: Apache-2.0
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <filesystem>
#include <memory>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "shared/base/camera_stream.hpp"
#include "shared/base/json_testing.h"
#include "tests/system/command_line/process_testing.h"

namespace kaz::test {
namespace {

using nlohmann::json;
using std::chrono::seconds;

enum class Passes { header, three_pairs, then_one_eye, swapped };

sockaddr_un address_of(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, sizeof address.sun_path - 1);
  return address;
}

// Between the simulator's camera and a reader: passes on what `passes` says, and keeps the line open.
class Relay {
 public:
  Relay(std::string from, const std::string& path, Passes passes)
      : from_(std::move(from)), passes_(passes) {
    listener_ = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const auto address = address_of(path);
    if (bind(listener_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
        listen(listener_, 4) != 0)
      throw std::runtime_error("cannot listen at " + path);
    thread_ = std::thread([this] { serve(); });
  }
  ~Relay() {
    shutdown(listener_, SHUT_RDWR);
    thread_.join();
    close(listener_);
  }

 private:
  static bool receive(int socket, std::string& to, std::size_t size) {
    to.resize(size);
    return recv(socket, to.data(), size, MSG_WAITALL) == static_cast<ssize_t>(size);
  }
  static bool send_all(int socket, const std::string& bytes) {
    for (std::size_t done = 0; done < bytes.size();) {
      const ssize_t n = send(socket, bytes.data() + done, bytes.size() - done, MSG_NOSIGNAL);
      if (n <= 0) return false;
      done += static_cast<std::size_t>(n);
    }
    return true;
  }

  void serve() {
    for (int reader = 0; (reader = accept(listener_, nullptr, nullptr)) >= 0;) {
      pass(reader);
      char none = 0;
      while (recv(reader, &none, 1, 0) > 0) {  // until the reader closes it
      }
      close(reader);
    }
  }

  void pass(int reader) {
    const int camera = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const auto address = address_of(from_);
    std::string text, left, right;
    CameraStreamHeader header{};
    if (connect(camera, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&
        receive(camera, text, sizeof header) && send_all(reader, text)) {
      std::memcpy(&header, text.data(), sizeof header);
      const std::size_t size = camera_picture_bytes(header.width, header.height);
      for (int pair = 0; passes_ != Passes::header; ++pair) {
        if (!receive(camera, text, sizeof(CameraStreamPair)) || !receive(camera, left, size) ||
            !receive(camera, right, size))
          break;
        if (passes_ == Passes::three_pairs && pair == 3) break;
        if (passes_ == Passes::then_one_eye && pair == 3) {
          send_all(reader, text + left);
          break;
        }
        if (passes_ == Passes::swapped) std::swap(left, right);
        if (!send_all(reader, text + left + right)) break;
      }
    }
    close(camera);
  }

  std::string from_;
  Passes passes_;
  int listener_ = -1;
  std::thread thread_;
};

class CameraTrouble : public ::testing::Test {
 protected:
  void SetUp() override {
    simulator_ =
        std::make_unique<Process>(kaz({"sim", "--world", "ball", "--mcu", "native", "--serial",
                                       folder_ / "board", "--cameras", folder_ / "eyes"}));
    ASSERT_TRUE(simulator_->wait_for_output("ready", seconds(30)));
  }
  std::vector<std::string> behavior(const std::string& duration, const std::string& out) {
    return kaz({"run", "track-ball", "--robot", "serial:" + (folder_ / "board"), "--camera",
                folder_ / "relay", "--duration", duration, "--out", out});
  }
  TemporaryFolder folder_;
  std::unique_ptr<Process> simulator_;
};

TEST_F(CameraTrouble, SilenceIsTheMachinesAndNamesTheCamera) {
  for (const auto& [passes, missing] : {std::pair{Passes::header, "the next pair"},
                                        {Passes::three_pairs, "the next pair"},
                                        {Passes::then_one_eye, "the right picture"}}) {
    const Relay relay(folder_ / "eyes", folder_ / "relay", passes);
    const Finished run_ended = run(behavior("60", folder_ / "run"), seconds(30));
    const Finished seen = run(
        kaz({"vision", "run", "--in", folder_ / "relay", "--out", folder_ / "seen"}), seconds(30));
    const std::string camera = "camera " + (folder_ / "relay");
    for (const auto& [ended, why] :
         {std::pair{run_ended, "no image came for 2 s: check " + camera},
          std::pair{seen, camera + " stopped: no complete pair came for 5 s, because " + missing +
                              " is missing"}}) {
      EXPECT_EQ(ended.exit_code, 3) << ended.err;
      EXPECT_NE(ended.err.find(why), std::string::npos) << ended.err;
    }
    const json lost = parse_json(read_file(folder_ / "run/result.json"));
    EXPECT_EQ(lost["outcome"], "environment");
    EXPECT_EQ(lost["robot"], "serial:" + (folder_ / "board"));
    EXPECT_NE(lost["provenance"].value("command", "").find("track-ball"), std::string::npos)
        << lost;
    EXPECT_EQ(read_file(folder_ / "run/vision.csv").find("module,frame,"), 0u);
    const json kept = parse_json(read_file(folder_ / "seen/result.json"));
    EXPECT_EQ(kept["frames_looked_at"], passes == Passes::header ? 0 : 3);
    EXPECT_NE(kept["ended_early"].get<std::string>().find("stopped"), std::string::npos);
    std::filesystem::remove(folder_ / "relay");
    std::filesystem::remove_all(folder_ / "run");
    std::filesystem::remove_all(folder_ / "seen");
  }
}

TEST_F(CameraTrouble, SwappedCamerasAreReportedOfTheWholeRun) {
  const Relay relay(folder_ / "eyes", folder_ / "relay", Passes::swapped);
  const Finished seen = run(kaz({"vision", "run", "--in", folder_ / "relay", "--frames", "30",
                                 "--modules", "color", "--out", folder_ / "seen"}),
                            seconds(30));
  EXPECT_EQ(seen.exit_code, 0) << seen.err;
  EXPECT_NE(seen.out.find("warning: left and right seem exchanged"), std::string::npos) << seen.out;
  const Finished ran = run(behavior("3", folder_ / "run"), seconds(60));
  EXPECT_NE(ran.out.find("warning: left and right seem exchanged"), std::string::npos)
      << ran.out << ran.err;
  const json result = parse_json(read_file(folder_ / "run/result.json"));
  EXPECT_NE(result["warning"].get<std::string>().find("exchanged"), std::string::npos);
}

// With a healthy one there is no warning.
TEST_F(CameraTrouble, HealthyCamerasAreNotReported) {
  const Finished seen = run(
      kaz({"vision", "run", "--in", folder_ / "eyes", "--frames", "30", "--out", folder_ / "seen"}),
      seconds(30));
  EXPECT_EQ(seen.exit_code, 0) << seen.err;
  EXPECT_EQ(seen.out.find("warning"), std::string::npos) << seen.out;
}

TEST_F(CameraTrouble, APausedSimulatorIsNoticed) {
  Process watching(kaz({"vision", "run", "--in", folder_ / "eyes", "--out", folder_ / "seen"}));
  ASSERT_TRUE(watching.wait_for_output("pairs", seconds(20)));
  simulator_->signal(SIGSTOP);
  const Finished seen = watching.wait(seconds(30));
  simulator_->signal(SIGCONT);
  EXPECT_EQ(seen.exit_code, 3) << seen.err;
  EXPECT_NE(seen.err.find("camera " + (folder_ / "eyes") + " stopped"), std::string::npos)
      << seen.err;
}

}  // namespace
}  // namespace kaz::test
