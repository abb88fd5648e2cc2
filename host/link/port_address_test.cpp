// --robot as the user types it, and adapters as sysfs shows them.
// SPDX-License-Identifier: Apache-2.0
#include "host/link/port_address.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "host/link/serial_identity.h"

namespace kaz::host {
namespace {

namespace fs = std::filesystem;

PortAddress read(const std::string& text) {
  const auto address = parse_port_address("--robot", text);
  EXPECT_TRUE(address) << address.error().message;
  return address.value_or(PortAddress{});
}

TEST(PortAddress, HasFourKinds) {
  EXPECT_EQ(read("serial:/dev/ttyUSB0").kind, PortKind::serial);
  EXPECT_EQ(read("serial:/dev/ttyUSB0").name(), "/dev/ttyUSB0");
  EXPECT_EQ(read("/dev/ttyUSB0@57600").baud, 57600);
  EXPECT_EQ(read("/dev/ttyUSB0@57600").name(), "/dev/ttyUSB0");
  EXPECT_EQ(read("board:left").kind, PortKind::serial) << "a path, as no kind has this name";
  EXPECT_EQ(read("board:left").name(), "serial:board:left");
  EXPECT_EQ(read("can:can0").kind, PortKind::can);
  EXPECT_EQ(read("can:can0").name(), "can:can0");
  EXPECT_EQ(read("tcp:bench:7000").tcp_port, 7000);
  EXPECT_EQ(read("tcp:bench:7000").name(), "tcp:bench:7000");
  EXPECT_EQ(read("rfc2217:[fe80::1]:7217@57600").place, "fe80::1");
  EXPECT_EQ(read("rfc2217:[fe80::1]:7217@57600").name(), "rfc2217:[fe80::1]:7217");
  EXPECT_EQ(read("rfc2217:[fe80::1]:7217@57600").baud, 57600);
}

TEST(PortAddress, ItsNameIsTheSamePort) {
  for (const char* text :
       {"/dev/ttyUSB0", "board@left@9600", "serial:can:can0", "serial:feetech:a",
        "serial:tcp:a:1@9600@57600", "can:can0", "tcp:[::1]:7000", "rfc2217:bench:7217"}) {
    const PortAddress port = read(text), again = read(port.name());
    EXPECT_EQ(again.kind, port.kind) << text;
    EXPECT_EQ(again.place, port.place) << text;
    EXPECT_EQ(again.tcp_port, port.tcp_port) << text;
    EXPECT_EQ(again.name(), port.name()) << text;
  }
  EXPECT_EQ(read("board@left@9600").name(), "board@left@9600");
  EXPECT_EQ(read("serial:can:can0").name(), "serial:can:can0");
}

TEST(PortAddress, EachMistakeHasItsSentence) {
  const std::pair<const char*, const char*> kMistakes[] = {
      {"serial:", "the path of the port is missing"},
      {"", "the path of the port is missing"},
      {"x@fast", "after @ give the bit rate, as in @115200"},
      {"x@0", "after @ give the bit rate, as in @115200"},
      {"can:", "the interface is missing"},
      {"can:a/b", "the text after can: is not a network interface name"},
      {"can:a-name-that-is-too-long", "the text after can: is not a network interface name"},
      {"tcp:bench", "the port number is missing"},
      {"tcp::7000", "the host is missing"},
      {"tcp:bench:0", "the port must be 1 to 65535"},
      {"tcp:bench:70000", "the port must be 1 to 65535"},
      {"tcp:bench:ssh", "the port must be 1 to 65535"},
      {"tcp:::1:7000", "put an IPv6 address in brackets, as in tcp:[::1]:7000"},
      {"tcp:[::1:7000", "the IPv6 address has no closing bracket"},
      {"rfc2217:a b:7000", "the host name has invalid characters"},
      {"rfc2217:a@b:7000@9600", "the host name has invalid characters"},
      {"tcp:[[a]:7000", "the host name has invalid characters"},
  };
  for (const auto& [text, sentence] : kMistakes) {
    const auto address = parse_port_address("--robot", text);
    ASSERT_FALSE(address) << text;
    EXPECT_EQ(address.error().fault, Fault::usage);
    EXPECT_EQ(address.error().message,
              "--robot " + std::string(text) + ": " + sentence +
                  "; give serial:PATH or serial:PATH@BAUD, can:INTERFACE, tcp:HOST:PORT or "
                  "rfc2217:HOST:PORT");
  }
}

// Files of boards contain addresses, too.
TEST(PortAddress, ErrorsAreOneShortLine) {
  const auto address = parse_port_address("--robot", "can:a\nb\x1b" + std::string(500, 'c'));
  ASSERT_FALSE(address);
  EXPECT_TRUE(address.error().message.starts_with("--robot can:a b\\x1bccc"))
      << address.error().message;
  EXPECT_LT(address.error().message.size(), 300u);
}

TEST(PortAddress, SuggestedOptionsParseToTheSamePort) {
  const std::pair<const char*, const char*> kOptions[] = {
      {"/dev/ttyUSB0", "--robot serial:/dev/ttyUSB0"},
      {"serial:board:left", "--robot serial:board:left"},
      {"can:can0", "--robot can:can0"},
      {"tcp:bench:7000", "--robot tcp:bench:7000"},
      {"rfc2217:[fe80::1]:7217", "--robot rfc2217:[fe80::1]:7217"}};
  for (const auto& [name, option] : kOptions) {
    EXPECT_EQ(robot_option(name), option);
    EXPECT_EQ(read(robot_option(name).substr(std::string("--robot ").size())).name(), name);
  }
}

// A tree of sysfs with adapters.
class Sysfs : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "kaz-sysfs-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    root_ = name;
    fs::create_directories(root_ / "class/tty");
  }
  void TearDown() override { fs::remove_all(root_); }
  void write(const fs::path& path, const std::string& text) {
    fs::create_directories(path.parent_path());
    std::ofstream(path) << text << "\n";
  }
  // Plugs an adapter into a USB socket, "1-1.2", as /dev/`tty`.
  void plug(const std::string& tty, const std::string& socket, const std::string& vendor,
            const std::string& product, const std::string& serial) {
    const fs::path device = root_ / "devices" / socket;
    write(device / "idVendor", vendor);
    write(device / "idProduct", product);
    if (!serial.empty()) write(device / "serial", serial);
    write(device / (socket + ":1.0") / "bInterfaceNumber", "00");
    fs::create_directories(device / (socket + ":1.0") / tty);
    fs::create_directories(root_ / "class/tty" / tty);
    fs::create_directory_symlink(device / (socket + ":1.0") / tty,
                                 root_ / "class/tty" / tty / "device");
  }
  void unplug(const std::string& tty, const std::string& socket) {
    fs::remove_all(root_ / "class/tty" / tty);
    fs::remove_all(root_ / "devices" / socket);
  }
  std::string identity(const std::string& path) const { return serial_identity(path, root_); }
  fs::path root_;
};

TEST_F(Sysfs, AnAdapterIsFoundUnderAnotherName) {
  plug("kazUSB0", "1-1.2", "0403", "6001", "A50285BI");
  const std::string ours = identity("/dev/kazUSB0");
  EXPECT_EQ(ours, "0403:6001 A50285BI.00");
  EXPECT_EQ(find_serial_port(ours, root_), "/dev/kazUSB0");
  unplug("kazUSB0", "1-1.2");
  EXPECT_EQ(find_serial_port(ours, root_), std::nullopt);
  // Another adapter takes its number, and it comes back at another socket with the next.
  plug("kazUSB0", "1-1.2", "0403", "6001", "B00000XX");
  plug("kazUSB1", "1-1.3", "0403", "6001", "A50285BI");
  EXPECT_NE(identity("/dev/kazUSB0"), ours);
  EXPECT_EQ(find_serial_port(ours, root_), "/dev/kazUSB1");
}

TEST_F(Sysfs, WithoutASerialNumberTheSocketCounts) {
  plug("kazUSB0", "1-1.2", "1a86", "7523", "");
  EXPECT_EQ(identity("/dev/kazUSB0"), "1a86:7523 @1-1.2.00");
  plug("kazUSB1", "1-1.4", "1a86", "7523", "");
  EXPECT_EQ(find_serial_port("1a86:7523 @1-1.4.00", root_), "/dev/kazUSB1");
}

TEST_F(Sysfs, AUartIsNoAdapter) {
  fs::create_directories(root_ / "devices/serial8250");
  fs::create_directories(root_ / "class/tty/kazS0");
  fs::create_directory_symlink(root_ / "devices/serial8250", root_ / "class/tty/kazS0/device");
  EXPECT_EQ(identity("/dev/kazS0"), "");
  EXPECT_EQ(identity("/dev/kaz-none"), "");
  EXPECT_EQ(find_serial_port("", root_), std::nullopt);
}

}  // namespace
}  // namespace kaz::host
