// A servo bus behind a real pseudo-terminal, in real time: rates, answers, hosts that come and go, control.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/serving/bus_server.h"

#include <asm/termbits.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <thread>

#include "shared/base/descriptor.hpp"
#include "sim/bus/bus_testing.h"
#include "sim/runtime/serving/bus_commands.h"
#include "sim/runtime/simulation/world_testing.h"

namespace kaz::sim {
namespace {

using namespace test;
using feetech::request;

// Any rate, as drivers set those that have no name.
bool set_rate(int fd, unsigned baud) {
  termios2 settings{};
  if (ioctl(fd, TCGETS2, &settings) != 0) return false;
  settings.c_cflag = (settings.c_cflag & ~static_cast<tcflag_t>(CBAUD)) | BOTHER;
  settings.c_ispeed = settings.c_ospeed = baud;
  return ioctl(fd, TCSETS2, &settings) == 0;
}
unsigned rate_of(int fd) {
  termios2 settings{};
  return ioctl(fd, TCGETS2, &settings) == 0 ? settings.c_ospeed : 0;
}

// A bus that is served in a thread, while it lives.
class Served {
 public:
  explicit Served(std::unique_ptr<VirtualBus> bus) : bus_(std::move(bus)) {
    BusServerOptions options;
    options.serial_path = port = folder_.file("arm");
    auto server = BusServer::open(*bus_, options);
    EXPECT_TRUE(server) << server.error().message;
    server_ = std::move(*server);
    thread_ = std::thread([this] { result_ = server_->run(stop_); });
  }
  ~Served() { end(); }
  BusServerStatistics end() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
    EXPECT_TRUE(result_) << result_.error().message;
    return *result_;
  }

  std::string port;

 private:
  TestFolder folder_;
  std::unique_ptr<VirtualBus> bus_;
  std::unique_ptr<BusServer> server_;
  std::atomic<bool> stop_ = false;
  Result<BusServerStatistics> result_ = BusServerStatistics{};
  std::thread thread_;
};

Descriptor open_port(const std::string& path, unsigned baud) {
  Descriptor port(::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK));
  EXPECT_TRUE(port);
  EXPECT_TRUE(set_rate(port.get(), baud)) << baud;
  EXPECT_EQ(rate_of(port.get()), baud);
  return port;
}

// What comes until `count` bytes are there, or 200 ms have passed.
Bytes receive(const Descriptor& port, std::size_t count) {
  Bytes bytes;
  pollfd readable{port.get(), POLLIN, 0};
  while (bytes.size() < count && ::poll(&readable, 1, 200) > 0) {
    std::uint8_t buffer[256];
    const ssize_t got = ::read(port.get(), buffer, sizeof buffer);
    if (got <= 0) break;
    bytes.insert(bytes.end(), buffer, buffer + got);
  }
  return bytes;
}

bool send(const Descriptor& port, const Bytes& wire) {
  return ::write(port.get(), wire.data(), wire.size()) == static_cast<ssize_t>(wire.size());
}

bool send(const Descriptor& port, const Packet& packet) {
  return send(port, feetech::wire_of(packet));
}

Bytes answer_of(int id) {
  return feetech::wire_of({static_cast<std::uint8_t>(id), 0, {}});
}

TEST(BusServer, AnswersAtTheRateOfTheServosAndAtNoOther) {
  Served served(bus_of({1}));
  const Descriptor port = open_port(served.port, 1000000);
  EXPECT_TRUE(send(port, request(1, Instruction::ping)));
  EXPECT_EQ(receive(port, 6), answer_of(1));
  EXPECT_TRUE(set_rate(port.get(), 115200));
  EXPECT_TRUE(send(port, request(1, Instruction::ping)));
  EXPECT_NE(receive(port, 6), answer_of(1));
}

// 250,000, 128,000 and 76,800 baud have no name in termios; 126,700 is within a UART's tolerance.
TEST(BusServer, HearsRatesWithoutAName) {
  const struct {
    int code;
    unsigned baud;
  } cases[] = {{2, 250000}, {3, 128000}, {5, 76800}, {3, 126700}};
  for (const auto& one : cases) {
    auto bus = bus_of({1});
    bus->servo(0).registers().set("baud_rate", one.code);
    bus->servo(0).registers().keep("baud_rate");
    bus->set_power(false);
    bus->set_power(true);
    Served served(std::move(bus));
    const Descriptor port = open_port(served.port, one.baud);
    EXPECT_TRUE(send(port, request(1, Instruction::ping)));
    EXPECT_EQ(receive(port, 6), answer_of(1)) << one.baud;
  }
}

// POSIX: a rate of 0 hangs up. A host that is slow to the extreme is another thing: its bits are real.
TEST(BusServer, BytesAtNoRateDoNotReachTheBus) {
  Served served(bus_of({1}));
  const Descriptor port = open_port(served.port, 1000000);
  EXPECT_TRUE(send(port, request(1, Instruction::ping)));
  EXPECT_EQ(receive(port, 6), answer_of(1));
  EXPECT_TRUE(set_rate(port.get(), 0));
  EXPECT_TRUE(send(port, request(1, Instruction::ping)));
  EXPECT_TRUE(receive(port, 1).empty());
  EXPECT_TRUE(set_rate(port.get(), 1000000));
  EXPECT_TRUE(send(port, request(1, Instruction::ping)));
  EXPECT_EQ(receive(port, 6), answer_of(1)) << "the bus goes on at the next rate";
  for (const unsigned baud : {1u, 4294967295u}) {
    EXPECT_TRUE(set_rate(port.get(), baud));
    EXPECT_TRUE(send(port, Bytes{0xff}));
    EXPECT_TRUE(receive(port, 1).empty()) << baud;
  }
  EXPECT_EQ(served.end().bytes_from_host, 3 * 6 + 2u);
}

// What clients do to a port besides: flush, drain, exclusive use, count what is there.
TEST(BusServer, PortTakesWhatClientsDoToPorts) {
  Served served(bus_of({1}));
  const Descriptor port = open_port(served.port, 1000000);
  int count = -1;
  EXPECT_EQ(ioctl(port.get(), TCFLSH, TCIOFLUSH), 0);
  EXPECT_EQ(ioctl(port.get(), TCSBRK, 1), 0);
  EXPECT_EQ(ioctl(port.get(), FIONREAD, &count), 0);
  EXPECT_EQ(ioctl(port.get(), TIOCEXCL), 0);
  EXPECT_EQ(ioctl(port.get(), TIOCNXCL), 0);
  EXPECT_TRUE(send(port, request(1, Instruction::ping)));
  EXPECT_EQ(receive(port, 6), answer_of(1));
}

TEST(BusServer, NextHostGetsNothingOfTheLast) {
  Served served(bus_of({1}));
  {
    const Descriptor port = open_port(served.port, 1000000);
    EXPECT_TRUE(send(port, request(1, Instruction::ping)));
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  const Descriptor port = open_port(served.port, 1000000);
  EXPECT_TRUE(receive(port, 1).empty());
  EXPECT_TRUE(send(port, request(1, Instruction::read, {5, 1})));
  EXPECT_EQ(receive(port, 7), feetech::wire_of({1, 0, {1}}));
}

// 100 Hz over the pty: a sync write and a sync read of six servos each 10 ms, none lost.
TEST(BusServer, CarriesTheArmAtHundredHertz) {
  auto arm = VirtualBus::load("sim/worlds/empty.sdf", "sim/robots/so101/so101.urdf", {});
  ASSERT_TRUE(arm) << arm.error().message;
  Served served(std::move(*arm));
  const Descriptor port = open_port(served.port, 1000000);
  constexpr int kCycles = 300;
  int complete = 0;
  Time worst{};
  auto next = std::chrono::steady_clock::now();
  for (int i = 0; i < kCycles; ++i) {
    Bytes goals{42, 2};
    for (std::uint8_t id = 1; id <= 6; ++id) {
      const int goal = 2048 + (i % 100);
      goals.insert(goals.end(),
                   {id, static_cast<std::uint8_t>(goal), static_cast<std::uint8_t>(goal >> 8)});
    }
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_TRUE(send(port, request(feetech::kBroadcast, Instruction::sync_write, goals)));
    EXPECT_TRUE(send(
        port, request(feetech::kBroadcast, Instruction::sync_read, {56, 2, 1, 2, 3, 4, 5, 6})));
    complete += receive(port, 6 * 8).size() == 6 * 8 ? 1 : 0;
    worst = std::max<Time>(worst, std::chrono::steady_clock::now() - begin);
    next += std::chrono::milliseconds(10);
    std::this_thread::sleep_until(next);
  }
  EXPECT_EQ(complete, kCycles);
  const auto statistics = served.end();
  EXPECT_EQ(statistics.bytes_lost, 0u);
  EXPECT_EQ(statistics.bytes_to_host, kCycles * 48u);
  RecordProperty("worst_cycle_us", static_cast<int>(worst.count() / 1000));
}

// The same of 18 servos by protocol 2.0: 12 bytes read of each and 8 written.
TEST(BusServer, CarriesTheHumanoidAtHundredHertz) {
  WorldOptions options;
  options.hung = true;
  auto mini = VirtualBus::load("sim/worlds/empty.sdf", "sim/robots/mini/mini.urdf", options);
  ASSERT_TRUE(mini) << mini.error().message;
  Bytes ids;
  for (std::size_t i = 0; i < (*mini)->servos(); ++i)
    ids.push_back(static_cast<std::uint8_t>((*mini)->mount(i).id));
  Served served(std::move(*mini));
  const Descriptor port = open_port(served.port, 1000000);
  constexpr int kCycles = 300;
  int complete = 0;
  Time worst{};
  auto next = std::chrono::steady_clock::now();
  for (int i = 0; i < kCycles; ++i) {
    Bytes goals{112, 0, 8, 0}, reads{124, 0, 12, 0};
    for (const std::uint8_t id : ids) {
      goals.insert(goals.end(), {id, 50, 0, 0, 0, static_cast<std::uint8_t>(i % 100), 8, 0, 0});
      reads.push_back(id);
    }
    const auto begin = std::chrono::steady_clock::now();
    using Op = dynamixel::Instruction;
    for (const auto& [op, parameters] :
         {std::pair{Op::sync_write, goals}, std::pair{Op::sync_read, reads}})
      EXPECT_TRUE(send(
          port, dynamixel::wire_of(dynamixel::request(dynamixel::kBroadcast, op, parameters))));
    complete += receive(port, 18 * 23).size() == 18 * 23 ? 1 : 0;
    worst = std::max<Time>(worst, std::chrono::steady_clock::now() - begin);
    next += std::chrono::milliseconds(10);
    std::this_thread::sleep_until(next);
  }
  EXPECT_EQ(complete, kCycles);
  const auto statistics = served.end();
  EXPECT_EQ(statistics.bytes_lost, 0u);
  RecordProperty("worst_cycle_us", static_cast<int>(worst.count() / 1000));
}

TEST(BusCommands, PowerSupplyDamageAndStatus) {
  const auto bus = bus_of({1, 2});
  const BusCommands commands(*bus, [] { return nlohmann::ordered_json{{"host", false}}; });
  BusHost host(*bus);
  EXPECT_TRUE(commands.answer("power off")["ok"]);
  EXPECT_TRUE(host.send(request(1, Instruction::ping)).empty());
  EXPECT_TRUE(commands.answer(R"({"command": "power", "argument": "on"})")["ok"]);
  EXPECT_EQ(host.send(request(1, Instruction::ping)).size(), 1u);
  EXPECT_TRUE(commands.answer("supply 3.5")["ok"]);
  bus->advance(bus->time() + std::chrono::milliseconds(5));
  EXPECT_EQ(host.get(1, "present_voltage"), 35);
  EXPECT_TRUE(commands.answer("damage 1")["ok"]);
  EXPECT_TRUE(host.send(request(1, Instruction::ping)).empty());
  const auto status = commands.answer("status");
  EXPECT_TRUE(status["ok"]);
  EXPECT_EQ(status["host"], false);
  EXPECT_EQ(status["servos"].size(), 2u);
  EXPECT_EQ(status["servos"][1]["id"], 2);
  EXPECT_EQ(status["servos"][0]["status"], feetech::kVoltageError);
  for (const char* wrong : {"", "power", "power maybe", "supply", "supply 99", "supply -1",
                            "damage x", "damage 2", "reset", "{"}) {
    const auto reply = commands.answer(wrong);
    EXPECT_FALSE(reply["ok"]) << wrong;
    EXPECT_FALSE(reply["error"].get<std::string>().empty()) << wrong;
  }
}

}  // namespace
}  // namespace kaz::sim
