// The Unix sockets: who may listen where, stereo pairs, and the control commands.
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <time.h>

#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "shared/base/camera_stream.hpp"
#include "shared/base/json_testing.h"
#include "shared/base/no_descriptors_testing.h"
#include "sim/runtime/serving/camera_server.h"
#include "sim/runtime/serving/control_server.h"
#include "sim/runtime/serving/socket_testing.h"
#include "sim/runtime/simulation/world_testing.h"

namespace kaz::sim {
namespace {

// Waits for all of it, 10 s at most; false if the other side closed.
bool receive(const Descriptor& socket, void* to, std::size_t size) {
  auto* bytes = static_cast<char*>(to);
  while (size > 0) {
    pollfd readable{socket.get(), POLLIN, 0};
    if (::poll(&readable, 1, 10000) <= 0) return false;
    const ssize_t got = ::recv(socket.get(), bytes, size, 0);
    if (got <= 0) return false;
    bytes += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

TEST(UnixListener, ReplacesAStaleSocketButNotALiveOne) {
  const TestFolder folder;
  const std::string path = folder.file("s");
  {
    // What a killed process leaves: the path, and nobody behind it.
    const Descriptor dead(::socket(AF_UNIX, SOCK_STREAM, 0));
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
    ASSERT_EQ(::bind(dead.get(), reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  }
  auto first = UnixListener::open(path);
  ASSERT_TRUE(first) << first.error().message;
  struct stat status {};
  ASSERT_EQ(::stat(path.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0600u);

  const auto second = UnixListener::open(path);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().fault, Fault::environment);
  EXPECT_TRUE(connect_to(path)) << "the first still listens";
  first->reset();
  EXPECT_FALSE(std::filesystem::exists(path));
}

// As /dev/log is one: a stream cannot be connected to it, though it is alive.
TEST(UnixListener, LeavesASocketOfAnotherType) {
  const TestFolder folder;
  const std::string path = folder.file("log");
  const Descriptor log(::socket(AF_UNIX, SOCK_DGRAM, 0));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
  ASSERT_EQ(::bind(log.get(), reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  const auto listener = UnixListener::open(path);
  ASSERT_FALSE(listener);
  EXPECT_NE(listener.error().message.find("served by another process"), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(path));
}

TEST(UnixListener, RefusesFilesAndLongPaths) {
  const TestFolder folder;
  std::ofstream(folder.file("f")) << "mine";
  const auto at_file = UnixListener::open(folder.file("f"));
  ASSERT_FALSE(at_file);
  EXPECT_EQ(at_file.error().fault, Fault::usage);
  EXPECT_TRUE(std::filesystem::is_regular_file(folder.file("f")));
  EXPECT_FALSE(UnixListener::open(folder.file(std::string(120, 'x'))));
  EXPECT_FALSE(UnixListener::open("/nonexistent/s"));
}

vision::CameraModel model_of(int width, int height) {
  return {
      .width = width, .height = height, .fx = 200, .fy = 201, .cx = 1, .cy = 2, .baseline_m = 0.04};
}

vision::StereoPair pair_of(std::uint64_t sequence, const vision::CameraModel& model) {
  auto images = std::make_shared<vision::StereoImages>();
  const auto size = camera_picture_bytes(static_cast<std::uint32_t>(model.width),
                                         static_cast<std::uint32_t>(model.height));
  images->left = {model.width, model.height,
                  std::vector<std::uint8_t>(size, static_cast<std::uint8_t>(sequence))};
  images->right = {model.width, model.height,
                   std::vector<std::uint8_t>(size, static_cast<std::uint8_t>(100 + sequence))};
  std::promise<std::shared_ptr<const vision::StereoImages>> promise;
  promise.set_value(images);
  vision::StereoPair pair;
  pair.info.sequence = sequence;
  pair.images = promise.get_future().share();
  return pair;
}

void wait_for_readers(const CameraServer& server, int count) {
  while (server.readers() != count) std::this_thread::yield();
}

TEST(CameraServer, SendsHeaderAndPairsToEveryReader) {
  const TestFolder folder;
  const auto model = model_of(32, 24);
  auto server = CameraServer::open(folder.file("c"), model, std::chrono::milliseconds(15));
  ASSERT_TRUE(server) << server.error().message;
  const Descriptor a = connect_to(folder.file("c")), b = connect_to(folder.file("c"));
  wait_for_readers(**server, 2);
  (*server)->publish(pair_of(5, model), Time(123456789));
  for (const Descriptor* reader : {&a, &b}) {
    CameraStreamHeader header{};
    ASSERT_TRUE(receive(*reader, &header, sizeof header));
    EXPECT_EQ(std::memcmp(header.magic, "KAZC", 4), 0);
    EXPECT_EQ(header.version, 1u);
    EXPECT_EQ(header.width, 32u);
    EXPECT_EQ(header.height, 24u);
    EXPECT_EQ(header.fy, 201);
    EXPECT_EQ(header.baseline_m, 0.04);
    EXPECT_EQ(header.latency_ns, 15'000'000);
    CameraStreamPair pair{};
    ASSERT_TRUE(receive(*reader, &pair, sizeof pair));
    EXPECT_EQ(std::memcmp(pair.magic, "PAIR", 4), 0);
    EXPECT_EQ(pair.sequence, 5u);
    EXPECT_EQ(pair.exposure_ns, 123456789);
    std::vector<std::uint8_t> left(32 * 24 * 3), right(32 * 24 * 3);
    ASSERT_TRUE(receive(*reader, left.data(), left.size()));
    ASSERT_TRUE(receive(*reader, right.data(), right.size()));
    EXPECT_EQ(left, std::vector<std::uint8_t>(32 * 24 * 3, 5));
    EXPECT_EQ(right, std::vector<std::uint8_t>(32 * 24 * 3, 105));
  }
  EXPECT_EQ((*server)->missed(), 0u);
}

TEST(CameraServer, SlowReaderMissesWholePairs) {
  const TestFolder folder;
  const auto model = model_of(640, 480);  // 1.8 MB a pair: far more than a socket holds
  auto server = CameraServer::open(folder.file("c"), model, Time(0));
  ASSERT_TRUE(server);
  const Descriptor slow = connect_to(folder.file("c"));
  wait_for_readers(**server, 1);
  for (std::uint64_t n = 0; n < 5; ++n) (*server)->publish(pair_of(n, model), Time(0));
  while ((*server)->missed() < 4) std::this_thread::yield();

  // Reading at last, it gets the first pair whole, and then whatever is published next.
  CameraStreamHeader header{};
  CameraStreamPair pair{};
  std::vector<std::uint8_t> pictures(2 * camera_picture_bytes(640, 480));
  ASSERT_TRUE(receive(slow, &header, sizeof header));
  ASSERT_TRUE(receive(slow, &pair, sizeof pair));
  EXPECT_EQ(pair.sequence, 0u);
  ASSERT_TRUE(receive(slow, pictures.data(), pictures.size()));
  EXPECT_EQ(pictures.front(), 0);
  EXPECT_EQ(pictures.back(), 100);
  std::uint64_t next = 5;
  pollfd readable{slow.get(), POLLIN, 0};
  do {  // the server may not have seen yet that the reader is idle again
    (*server)->publish(pair_of(next++, model), Time(0));
  } while (::poll(&readable, 1, 10) == 0);
  ASSERT_TRUE(receive(slow, &pair, sizeof pair));
  EXPECT_EQ(std::memcmp(pair.magic, "PAIR", 4), 0);
  EXPECT_GE(pair.sequence, 5u);
}

TEST(CameraServer, ReaderThatHangsUpIsForgotten) {
  const TestFolder folder;
  auto server = CameraServer::open(folder.file("c"), model_of(32, 24), Time(0));
  ASSERT_TRUE(server);
  {
    const Descriptor reader = connect_to(folder.file("c"));
    wait_for_readers(**server, 1);
  }
  wait_for_readers(**server, 0);
  server->reset();
  EXPECT_FALSE(std::filesystem::exists(folder.file("c")));
}

// Of all threads of this process.
Time processor_time() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return std::chrono::seconds(now.tv_sec) + Time(now.tv_nsec);
}

TEST(CameraServer, WithoutADescriptorItWaitsAndThenServesTheReader) {
  const TestFolder folder;
  auto server = CameraServer::open(folder.file("c"), model_of(32, 24), Time(0));
  ASSERT_TRUE(server) << server.error().message;
  Descriptor reader = unconnected();
  {
    const NoDescriptors none;
    reader = connect_to(folder.file("c"), std::move(reader));
    ASSERT_TRUE(reader);
    const Time used = processor_time();
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    EXPECT_LT(processor_time() - used, std::chrono::milliseconds(100)) << "it spins";
    EXPECT_EQ((*server)->readers(), 0);
  }
  CameraStreamHeader header{};
  EXPECT_TRUE(receive(reader, &header, sizeof header));
}

struct Board {
  std::string faults;
  int resets = 0, touches = 0;
  std::string power;
  ControlCommands commands{{
      .reset = [this] { ++resets; },
      .boot_pins = [this](bool boot) -> Result<void> {
        power += boot ? "b" : "r";
        return {};
      },
      .power = [this](bool on) { power += on ? "+" : "-"; },
      .plug = [this](bool in) -> Result<void> {
        power += in ? "i" : "o";
        return {};
      },
      .status =
          [] {
            return nlohmann::ordered_json{{"time_s", 1.5}};
          },
      .watch_touches = [this] { ++touches; },
      .fault = [this](const faults::Fault& fault) { faults += faults::text_of(fault) + ";"; },
      .clear_faults = [this] { faults += "none;"; },
      .now = [] { return std::chrono::milliseconds(1500); },
  }};
};

TEST(ControlCommands, TakeWordsAndJson) {
  Board board;
  EXPECT_TRUE(board.commands.answer("reset")["ok"]);
  EXPECT_TRUE(board.commands.answer(R"({"command": "reset"})")["ok"]);
  EXPECT_EQ(board.resets, 2);
  EXPECT_TRUE(board.commands.answer("power off\r")["ok"]);
  EXPECT_TRUE(board.commands.answer(R"({"command": "power", "argument": "on"})")["ok"]);
  EXPECT_TRUE(board.commands.answer("mode boot")["ok"]);
  EXPECT_TRUE(board.commands.answer("mode run")["ok"]);
  EXPECT_TRUE(board.commands.answer("plug out")["ok"]);
  EXPECT_TRUE(board.commands.answer("plug in")["ok"]);
  EXPECT_EQ(board.power, "-+broi");
  EXPECT_EQ(board.commands.answer("status")["time_s"], 1.5);
  EXPECT_TRUE(board.commands.answer("touches")["ok"]);
  EXPECT_FALSE(board.commands.answer("touches all")["ok"]);
  EXPECT_EQ(board.touches, 1);
  EXPECT_TRUE(board.commands.answer("help")["commands"].contains("reset"));
}

TEST(ControlCommands, FaultsBeginNowOrAtTheirTime) {
  Board board;
  EXPECT_TRUE(board.commands.answer("fault pot_open joint 3")["ok"]);
  EXPECT_TRUE(board.commands.answer("fault at 9 s for 1 s link_cut")["ok"]);
  EXPECT_TRUE(board.commands.answer("fault none")["ok"]);
  EXPECT_EQ(board.faults, "at 1.5 s pot_open joint 3 level 1;at 9 s for 1 s link_cut;none;");
  EXPECT_NE(board.commands.answer("fault pot_open")["error"].dump().find("joint"),
            std::string::npos);
}

TEST(ControlCommands, RefuseWithAReason) {
  Board board;
  for (const char* line :
       {"", "   ", "restart", "power", "power maybe", "mode", "mode 3", "plug", "plug up",
        "reset now", "{", "{\"command\": 7}", "{}", "[1]", "\xff\xfe"}) {
    const auto reply = board.commands.answer(line);
    EXPECT_FALSE(reply["ok"]) << line;
    EXPECT_FALSE(reply["error"].get<std::string>().empty()) << line;
  }
  EXPECT_EQ(board.resets, 0);
  EXPECT_EQ(board.power, "");
}

// What comes back for `text`, up to the end of a line or of the connection.
std::string answer_to(ControlServer& server, const Descriptor& client, const std::string& text) {
  EXPECT_EQ(::send(client.get(), text.data(), text.size(), MSG_NOSIGNAL),
            static_cast<ssize_t>(text.size()));
  std::string answer;
  while (answer.empty() || answer.back() != '\n') {
    server.poll();
    char buffer[256];
    const ssize_t got = ::recv(client.get(), buffer, sizeof buffer, MSG_DONTWAIT);
    if (got == 0) break;
    if (got > 0) answer.append(buffer, static_cast<std::size_t>(got));
  }
  return answer;
}

TEST(ControlServer, AnswersLineByLine) {
  const TestFolder folder;
  Board board;
  auto server = ControlServer::open(folder.file("ctl"), board.commands);
  ASSERT_TRUE(server);
  const Descriptor a = connect_to(folder.file("ctl")), b = connect_to(folder.file("ctl"));
  EXPECT_EQ(answer_to(**server, a, "reset\n"), "{\"ok\":true}\n");
  EXPECT_EQ(answer_to(**server, b, "status\n"), "{\"ok\":true,\"time_s\":1.5}\n");
  const auto wrong = parse_json(answer_to(**server, a, "\xff\n"));
  EXPECT_FALSE(wrong["ok"]);
  EXPECT_EQ(board.resets, 1);
}

TEST(ControlServer, LongLineIsRefusedAndTheClientDropped) {
  const TestFolder folder;
  Board board;
  auto server = ControlServer::open(folder.file("ctl"), board.commands);
  ASSERT_TRUE(server);
  for (const std::string& line : {std::string(5000, 'x'), std::string(1025, 'x') + "\n"}) {
    const Descriptor client = connect_to(folder.file("ctl"));
    const auto reply = parse_json(answer_to(**server, client, line));
    EXPECT_FALSE(reply["ok"]);
    EXPECT_EQ(reply["error"], "a request has at most 1024 characters");
    char rest = 0;
    while (true) {
      (*server)->poll();
      const ssize_t got = ::recv(client.get(), &rest, 1, MSG_DONTWAIT);
      if (got == 0 || (got < 0 && errno != EAGAIN)) break;
    }
  }
  EXPECT_TRUE(connect_to(folder.file("ctl"))) << "others are still served";
}

}  // namespace
}  // namespace kaz::sim
