// Links of `--robot` and `--port` but CAN: networks, foreign servers, lost peers, several boards.
// SPDX-License-Identifier: Apache-2.0
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <optional>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "shared/base/descriptor.hpp"
#include "shared/base/json_testing.h"
#include "shared/protocol/frame.h"
#include "shared/protocol/messages.h"
#include "tests/system/command_line/process_testing.h"

namespace kaz::test {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;
using std::chrono::seconds;

// Not that of another test at the same time.
std::string some_port(int which) {
  return std::to_string(20000 + (getpid() * 7 + which) % 12000);
}

std::string frame(std::string body) {
  std::string wire(KZ_FRAME_MAX, '\0');
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(body.data());
  wire.resize(kz_frame_encode(bytes, static_cast<std::uint8_t>(body.size()),
                              reinterpret_cast<std::uint8_t*>(wire.data())));
  return wire;
}

// The latch is cleared, then all motors are switched on.
std::string motors_on() {
  return frame({1, KZ_TYPE_clear, 1}) + frame({1, KZ_TYPE_enable, 2, 0, 3, '\xff', '\xff'});
}

// What comes back until the other end is silent for a second or closes.
std::string converse(const std::string& port, const std::string& sent) {
  const Descriptor client(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  to.sin_port = htons(static_cast<std::uint16_t>(std::stoi(port)));
  EXPECT_EQ(::connect(client.get(), reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
  EXPECT_EQ(::send(client.get(), sent.data(), sent.size(), MSG_NOSIGNAL),
            static_cast<ssize_t>(sent.size()));
  const timeval second{1, 0};
  ::setsockopt(client.get(), SOL_SOCKET, SO_RCVTIMEO, &second, sizeof second);
  std::string all;
  char some[256];
  for (ssize_t n = 0; (n = ::recv(client.get(), some, sizeof some, 0)) > 0;)
    all.append(some, static_cast<std::size_t>(n));
  return all;
}

struct Links : ::testing::Test {
  void SetUp() override {
    sim.emplace(kaz({"sim", "--mcu", "native", "--suspended", "--serial", board, "--cameras",
                     folder / "eyes"}));
    ASSERT_TRUE(sim->wait_for_output("ready", seconds(30))) << sim->wait(seconds(0)).err;
  }
  // `kaz status` as JSON; empty where the board does not answer.
  json status(const std::string& port) {
    const Finished finished = run(kaz({"status", "--port", port, "--json"}));
    EXPECT_EQ(finished.exit_code, 0) << finished.err;
    return finished.exit_code == 0 ? parse_json(finished.out) : json();
  }
  void expect_end(Process& server) {
    server.signal(SIGTERM);
    const Finished finished = server.wait(seconds(5));
    EXPECT_EQ(finished.exit_code, 0) << finished.err;
  }
  TemporaryFolder folder;
  std::string board = folder / "board";
  std::optional<Process> sim;
};

TEST_F(Links, ServePortReachesTheBoardByRfc2217AndRaw) {
  const std::string at = "127.0.0.1:" + some_port(1);
  {
    Process server(kaz({"serve-port", "--port", board, "--listen", at}));
    ASSERT_TRUE(server.wait_for_output("ready: " + board + " as rfc2217:" + at, seconds(10)))
        << server.wait(seconds(0)).err;
    EXPECT_EQ(status("rfc2217:" + at)["motors"], "off");
    // At another rate the virtual board understands nothing: the rate has crossed.
    const Finished wrong = run(kaz({"status", "--port", "rfc2217:" + at + "@57600"}));
    EXPECT_EQ(wrong.exit_code, 3) << wrong.out;
    EXPECT_EQ(status("rfc2217:" + at)["motors"], "off");
    expect_end(server);
  }
  Process server(kaz({"serve-port", "serial:" + board, "--raw", "--listen", at}));
  ASSERT_TRUE(server.wait_for_output("ready: " + board + " as tcp:" + at, seconds(10)))
      << server.wait(seconds(0)).err;
  EXPECT_EQ(status("tcp:" + at)["motors"], "off");
  const Finished wrong = run(kaz({"status", "--port", "rfc2217:" + at}));
  EXPECT_EQ(wrong.exit_code, 3);
  EXPECT_NE(wrong.err.find("does not support RFC 2217: give tcp:" + at), std::string::npos)
      << wrong.err;
  expect_end(server);
  const Finished refused = run(kaz({"status", "--port", "tcp:" + at}));
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_NE(refused.err.find("tcp:" + at + " refused the connection"), std::string::npos)
      << refused.err;
}

// As a browser sends it for any page: fetch(URL, {method: "POST", mode: "no-cors", body: a Blob}).
TEST_F(Links, AWebPageCannotMoveTheRobot) {
  const std::string port = some_port(4), at = "127.0.0.1:" + port;
  const std::string agreement = "\xff\xfb\x2c";  // IAC WILL COM-PORT
  std::string doubled = motors_on();
  for (auto place = doubled.find('\xff'); place != std::string::npos;
       place = doubled.find('\xff', place + 2))
    doubled.insert(place, 1, '\xff');
  // With its name rebound to this machine it chooses the method.
  for (const std::string method : {"POST", "PROPFIND"}) {
    const bool raw = method == "POST";
    std::vector<std::string> arguments = {"serve-port", "--port", board, "--listen", at};
    if (raw) arguments.push_back("--raw");
    Process server(kaz(arguments));
    ASSERT_TRUE(server.wait_for_output("ready: ", seconds(10))) << server.wait(seconds(0)).err;
    const std::string body = raw ? motors_on() : agreement + doubled;
    converse(port, method + " / HTTP/1.1\r\nHost: " + at +
                       "\r\nContent-Length: " + std::to_string(body.size()) +
                       "\r\nOrigin: https://evil.example\r\n\r\n" + body);
    EXPECT_TRUE(server.wait_for_output("its first bytes can come from a web browser", seconds(5)));
    expect_end(server);
  }
  EXPECT_EQ(status(board)["motors"], "off");
  EXPECT_FALSE(sim->prints_within("motors on", seconds(1)));
  // The same bytes from a program that is no browser.
  Process server(kaz({"serve-port", "--port", board, "--listen", at}));
  ASSERT_TRUE(server.wait_for_output("ready: ", seconds(10))) << server.wait(seconds(0)).err;
  EXPECT_NE(converse(port, agreement + doubled), "");
  EXPECT_TRUE(sim->wait_for_output("motors on", seconds(5)));
}

TEST_F(Links, PyserialOpensThePortByRfc2217) {
  const std::string at = "127.0.0.1:" + some_port(5);
  Process server(kaz({"serve-port", "--port", board, "--listen", at}));
  ASSERT_TRUE(server.wait_for_output("ready: ", seconds(10))) << server.wait(seconds(0)).err;
  const char* const program = R"(
import serial, sys
port = serial.serial_for_url("rfc2217://" + sys.argv[1], baudrate=115200, timeout=5)
port.write(bytes.fromhex(sys.argv[2]))
print(port.read(1).hex(), port.read_until(b"\0").hex())
port.reset_input_buffer()
port.reset_output_buffer()
port.baudrate = 57600
port.close()
)";
  std::string request;
  for (const unsigned char byte : frame({1, KZ_TYPE_heartbeat, 7})) {
    char digits[3];
    std::snprintf(digits, sizeof digits, "%02x", byte);
    request += digits;
  }
  const Finished finished = run({KAZ_PYTHON, "-B", "-c", program, at, request});
  EXPECT_EQ(finished.exit_code, 0) << finished.err;
  EXPECT_EQ(finished.out.substr(0, 3), "00 ") << "no frame comes back";
  EXPECT_GT(finished.out.size(), 15u) << finished.out;
  EXPECT_EQ(finished.out.substr(finished.out.size() - 3), "00\n") << finished.out;
}

TEST_F(Links, Ser2netIsAServerOfRfc2217) {
  const std::string port = some_port(2), at = "127.0.0.1:" + port;
  write_file(folder / "ser2net.yaml",
             "%YAML 1.1\n"
             "---\n"
             "connection: &board\n"
             "  accepter: telnet(rfc2217),tcp,127.0.0.1," +
                 port + "\n  connector: serialdev(nouucplock)," +
                 std::filesystem::canonical(board).string() + ",115200n81,local\n");
  Process server({"/usr/sbin/ser2net", "-n", "-c", folder / "ser2net.yaml"});
  json found;
  for (int i = 0; i < 50 && !found.is_object(); ++i) {
    std::this_thread::sleep_for(milliseconds(100));
    const Finished finished = run(kaz({"status", "--port", "rfc2217:" + at, "--json"}));
    if (finished.exit_code == 0) found = parse_json(finished.out);
    if (finished.err.find("refused the connection") == std::string::npos && finished.exit_code != 0)
      FAIL() << finished.err;
  }
  ASSERT_TRUE(found.is_object()) << server.wait(seconds(0)).err;
  EXPECT_EQ(found["motors"], "off");
  EXPECT_EQ(status("rfc2217:" + at)["motors"], "off") << "again, after the first has left";
}

// The server of another program goes and comes back in the midst of a behavior.
TEST_F(Links, ALostPeerIsFoundAgainWithoutARestart) {
  const std::string port = some_port(3), at = "127.0.0.1:" + port;
  const std::vector<std::string> socat = {
      "/usr/bin/socat", "TCP-LISTEN:" + port + ",bind=127.0.0.1,reuseaddr,nodelay",
      std::filesystem::canonical(board).string() + ",raw,echo=0,b115200"};
  std::optional<Process> server(std::in_place, socat);
  std::this_thread::sleep_for(milliseconds(300));
  Process behavior(kaz({"run", "track-ball", "--robot", "tcp:" + at, "--camera", folder / "eyes",
                        "--duration", "6", "--reconnect", "10"}));
  ASSERT_TRUE(sim->wait_for_output("motors on", seconds(20))) << behavior.wait(seconds(0)).err;
  std::this_thread::sleep_for(milliseconds(500));
  server.reset();
  // At once, while it is sought: whoever holds the plug is to know.
  EXPECT_TRUE(behavior.wait_for_output("the link was lost; retrying for up to 10 s: ", seconds(2)));
  // Longer than a camera may be silent: nobody takes its pictures meanwhile.
  std::this_thread::sleep_for(milliseconds(2300));
  server.emplace(socat);
  const Finished finished = behavior.wait(seconds(30));
  // Whether the ball was found in so short a time is another question.
  EXPECT_LE(finished.exit_code, 1) << finished.err;
  const auto count = [&](const std::string& words) {
    int n = 0;
    for (auto place = finished.err.find(words); place != std::string::npos;
         place = finished.err.find(words, place + 1))
      ++n;
    return n;
  };
  // One line each. (Where the board's watchdog expired on a loaded machine, that is another line.)
  EXPECT_EQ(count("the link was lost; "), 1) << finished.err;
  EXPECT_EQ(count("the link is back after "), 1) << finished.err;
}

TEST_F(Links, TwoBoardsDriveOneRobot) {
  const std::string other = folder / "legs";
  Process legs(kaz({"sim", "--mcu", "native", "--suspended", "--serial", other}));
  ASSERT_TRUE(legs.wait_for_output("ready", seconds(30))) << legs.wait(seconds(0)).err;
  json file;
  file["boards"] = {{{"port", board},
                     {"joints",
                      {"neck_pan", "neck_tilt", "l_sh_pitch", "l_sh_roll", "l_elbow", "l_hand",
                       "r_sh_pitch", "r_sh_roll", "r_elbow", "r_hand"}}},
                    {{"port", other},
                     {"joints",
                      {"l_hip_roll", "l_hip_pitch", "l_knee", "l_ankle_pitch", "r_hip_roll",
                       "r_hip_pitch", "r_knee", "r_ankle_pitch"}}}};
  write_file(folder / "boards.json", file.dump());
  Process behavior(kaz({"run", "stand", "--robot", "boards:" + (folder / "boards.json")}));
  EXPECT_TRUE(sim->wait_for_output("motors on", seconds(20)));
  EXPECT_TRUE(legs.wait_for_output("motors on", seconds(20)));
  const Finished finished = behavior.wait(seconds(30));
  EXPECT_EQ(finished.exit_code, 0) << finished.err;
  EXPECT_TRUE(legs.wait_for_output("motors off", seconds(5)));

  file["boards"][1]["joints"].erase(0);
  write_file(folder / "boards.json", file.dump());
  const Finished wrong =
      run(kaz({"run", "stand", "--robot", "boards:" + (folder / "boards.json")}));
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_NE(wrong.err.find("no board drives l_hip_roll"), std::string::npos) << wrong.err;
}

TEST(LinkMistakes, EachHasItsSentence) {
  const std::pair<const char*, const char*> kMistakes[] = {
      {"can:kaz-none", "no such CAN interface: kaz-none ("},
      {"can:lo", "lo is a network interface, but not a CAN interface ("},
      {"tcp:127.0.0.1", "the port number is missing"},
      {"/dev/kaz-none", "no such port: /dev/kaz-none ("}};
  for (const auto& [port, sentence] : kMistakes) {
    const Finished finished = run(kaz({"status", "--port", port}));
    EXPECT_NE(finished.exit_code, 0);
    EXPECT_NE(finished.err.find(sentence), std::string::npos) << finished.err;
  }
  const Finished bridge = run(kaz({"can-bridge", "--port", "can:can0", "--can", "can0"}));
  EXPECT_EQ(bridge.exit_code, 2);
  EXPECT_NE(bridge.err.find("is already a CAN bus"), std::string::npos) << bridge.err;
}

}  // namespace
}  // namespace kaz::test
