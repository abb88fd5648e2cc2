// Values of options: what is taken, and what the errors name.
// SPDX-License-Identifier: Apache-2.0
#include "tools/base/arguments.h"

#include <gtest/gtest.h>

#include <tuple>

#include "host/camera/v4l2_camera.h"

namespace kaz::tools {
namespace {

TEST(Port, HasABaudRateOfItsOwnOr115200) {
  const std::tuple<const char*, const char*, int> kPorts[] = {
      {"/dev/ttyUSB0", "/dev/ttyUSB0", 115200},
      {"board@38400", "board", 38400},
      {"a@b@9600", "a@b", 9600}};
  for (const auto& [text, place, baud] : kPorts) {
    EXPECT_EQ(parse_port(text).value().place, place);
    EXPECT_EQ(parse_port(text).value().baud, baud);
  }
}

TEST(Port, RefusesWhatIsNoBaudRate) {
  for (const char* text :
       {"board@", "board@0", "board@-9600", "board@9600x", "@9600", "board@99999999999"}) {
    const auto port = parse_port(text);
    ASSERT_FALSE(port) << text;
    EXPECT_EQ(port.error().fault, Fault::usage);
    EXPECT_NE(port.error().message.find(text), std::string::npos);
  }
}

TEST(Arguments, LongTextsAreCutInErrors) {
  const std::string text(5000, '\xb8');
  EXPECT_LT(parse_port("feetech:" + text).error().message.size(), 400u);
  EXPECT_LT(parse_bus("can:" + text).error().message.size(), 500u);
  EXPECT_LT(parse_one_bus(text, {}, 0).error().message.size(), 700u);
  EXPECT_LT(parse_settings({text}).error().message.size(), 300u);
  EXPECT_LT(parse_shard(text).error().message.size(), 300u);
  EXPECT_LT(host::parse_v4l2_source("v4l2:a,b," + text).error().message.size(), 700u);
}

TEST(Port, RefusesAServoBus) {
  for (const char* text : {"feetech:/dev/ttyACM0", "dynamixel:arm@57600"}) {
    const auto port = parse_port(text);
    ASSERT_FALSE(port) << text;
    EXPECT_EQ(port.error().fault, Fault::usage);
    EXPECT_EQ(port.error().message.find("--robot " + std::string(text) + ": a servo bus"), 0u);
    EXPECT_NE(port.error().message.find("kaz bus status"), std::string::npos);
  }
}

TEST(Bus, HasProtocolPortAndRate) {
  using servo_bus::Protocol;
  const std::tuple<const char*, std::optional<Protocol>, const char*, int> kBuses[] = {
      {"feetech:/dev/ttyACM0", Protocol::feetech, "/dev/ttyACM0", 0},
      {"dynamixel:arm@57600", Protocol::dynamixel, "arm", 57600},
      {"feetech:serial:arm@500000", Protocol::feetech, "arm", 500000},
      {"feetech:rfc2217:bench:7217@1000000", Protocol::feetech, "rfc2217:bench:7217", 1000000},
      {"/dev/ttyACM0", std::nullopt, "/dev/ttyACM0", 0},
      {"serial:arm@9600", std::nullopt, "arm", 9600}};
  for (const auto& [text, protocol, name, baud] : kBuses) {
    const auto bus = parse_bus(text);
    ASSERT_TRUE(bus) << bus.error().message;
    EXPECT_EQ(bus->protocol, protocol) << text;
    EXPECT_EQ(bus->port.name(), name) << text;
    EXPECT_EQ(bus->port.baud, baud) << text;
    EXPECT_EQ(names_servo_bus(text), protocol.has_value()) << text;
  }
  for (const char* text : {"feetech:", "can:can0", "feetech:can:can0", "tcp:bench:7000", "arm@fast",
                           "feetech:arm@fast", "feetech:rfc2217:bench"}) {
    const auto bus = parse_bus(text);
    ASSERT_FALSE(bus) << text;
    EXPECT_EQ(bus.error().fault, Fault::usage);
    EXPECT_EQ(bus.error().message.find("--robot " + std::string(text) + ": not a servo bus"), 0u)
        << bus.error().message;
  }
}

TEST(Bus, OneProtocolAndOneRateComeFromRobotOrFromOlderOptions) {
  using servo_bus::Protocol;
  const auto rate = [](const char* text, std::optional<Protocol> protocol, long baud) {
    const auto bus = parse_one_bus(text, protocol, baud);
    EXPECT_TRUE(bus) << bus.error().message;
    return bus ? std::pair(*bus->protocol, bus->port.baud) : std::pair(Protocol::feetech, -1);
  };
  EXPECT_EQ(rate("feetech:arm", {}, 0), std::pair(Protocol::feetech, 1000000));
  EXPECT_EQ(rate("dynamixel:arm", {}, 0), std::pair(Protocol::dynamixel, 57600));
  EXPECT_EQ(rate("dynamixel:arm@9600", {}, 9600), std::pair(Protocol::dynamixel, 9600));
  EXPECT_EQ(rate("feetech:arm", Protocol::feetech, 500000), std::pair(Protocol::feetech, 500000));
  EXPECT_EQ(rate("arm@9600", Protocol::dynamixel, 0), std::pair(Protocol::dynamixel, 9600));
  const auto error = [](const char* text, std::optional<Protocol> protocol, long baud) {
    const auto bus = parse_one_bus(text, protocol, baud);
    return bus ? std::string("none") : bus.error().message;
  };
  EXPECT_EQ(error("arm", {}, 0),
            "--robot arm: its protocol is missing; give feetech:arm or dynamixel:arm");
  EXPECT_EQ(error("feetech:arm", Protocol::dynamixel, 0),
            "--bus dynamixel: --robot feetech:arm uses another protocol; leave --bus out");
  EXPECT_EQ(error("feetech:arm@9600", {}, 57600),
            "--baud 57600: --robot feetech:arm@9600 has another rate; leave --baud out");
}

TEST(Settings, AreNamesWithValues) {
  const auto settings = parse_settings({"seconds=20", "note=a=b", "empty="});
  ASSERT_TRUE(settings);
  EXPECT_EQ(*settings, (std::map<std::string, std::string>{
                           {"seconds", "20"}, {"note", "a=b"}, {"empty", ""}}));
  EXPECT_TRUE(parse_settings({})->empty());
}

TEST(Settings, RefuseANameGivenTwice) {
  const auto settings = parse_settings({"seconds=20", "tries=2", "seconds=20"});
  ASSERT_FALSE(settings);
  EXPECT_EQ(settings.error().fault, Fault::usage);
  EXPECT_NE(settings.error().message.find("seconds is set twice"), std::string::npos);
}

TEST(Settings, RefuseATextWithoutName) {
  for (const char* text : {"seconds", "=20", ""}) {
    const auto settings = parse_settings({"a=1", text});
    ASSERT_FALSE(settings) << text;
    EXPECT_EQ(settings.error().fault, Fault::usage);
  }
}

TEST(Interval, IsTwoOrderedNumbersFromZero) {
  const auto given = parse_interval("--friction", {0.6, 0.8}, {1, 2});
  ASSERT_TRUE(given);
  EXPECT_EQ(given->min, 0.6);
  EXPECT_EQ(given->max, 0.8);
  EXPECT_TRUE(parse_interval("--friction", {0.7, 0.7}, {}));
  EXPECT_TRUE(parse_interval("--density", {0, 1}, {}));
  const auto otherwise = parse_interval("--friction", {}, {1, 2});
  ASSERT_TRUE(otherwise);
  EXPECT_EQ(otherwise->min, 1);
  EXPECT_EQ(otherwise->max, 2);
}

TEST(Interval, NamesItsOptionInTheError) {
  for (const std::vector<double>& given :
       {std::vector<double>{0.8, 0.6}, {-1, 1}, {1}, {1, 2, 3}}) {
    const auto interval = parse_interval("--lamp", given, {});
    ASSERT_FALSE(interval);
    EXPECT_NE(interval.error().message.find("--lamp"), std::string::npos);
  }
}

TEST(Shard, IsAPartOfParts) {
  const auto shard = parse_shard("2/4");
  ASSERT_TRUE(shard);
  EXPECT_EQ(shard->part, 2u);
  EXPECT_EQ(shard->parts, 4u);
  for (const char* text :
       {"0/4", "5/4", "2", "2/", "/4", "2/4x", "", "1/0", "1/111111111111111111111"})
    EXPECT_FALSE(parse_shard(text)) << text;
}

}  // namespace
}  // namespace kaz::tools
