// Values of options: what is taken, and what the errors name.
// SPDX-License-Identifier: Apache-2.0
#include "tools/app/base/arguments.h"

#include <gtest/gtest.h>

#include <tuple>

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
