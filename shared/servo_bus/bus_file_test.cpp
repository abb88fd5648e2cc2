// bus.json: what it says, and what it must not say.
// SPDX-License-Identifier: Apache-2.0
#include "shared/servo_bus/bus_file.h"

#include <gtest/gtest.h>

#include <numbers>

namespace kaz::servo_bus {
namespace {

TEST(BusFile, OfTheArmIsRead) {
  const auto file = load_bus_file("sim/robots/so101/so101.urdf");
  ASSERT_TRUE(file) << file.error().message;
  ASSERT_EQ(file->servos.size(), 6u);
  EXPECT_EQ(file->supply_volts, 7.4);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(file->servos[i].id, static_cast<int>(i) + 1);
    EXPECT_EQ(file->servos[i].model->name, "sts3215");
  }
}

TEST(BusFile, RateAndSettingsOfDynamixels) {
  const auto file = [](const std::string& more) {
    return R"({"protocol": "dynamixel", "supply_volts": 5, )" + more +
           R"( "servos": [{"joint": "a", "id": 1, "model": "xl330-m288"}]})";
  };
  const auto plain = parse_bus_file("bus.json", file(""));
  ASSERT_TRUE(plain) << plain.error().message;
  EXPECT_EQ(plain->protocol, Protocol::dynamixel);
  EXPECT_EQ(plain->baud, 57600);
  EXPECT_TRUE(plain->settings.empty());
  const auto set_up =
      parse_bus_file("bus.json", file(R"("baud": 4000000, "settings": {"return_delay_time": 0},)"));
  ASSERT_TRUE(set_up) << set_up.error().message;
  EXPECT_EQ(set_up->baud, 4'000'000);
  ASSERT_EQ(set_up->settings.size(), 1u);
  EXPECT_EQ(set_up->settings[0].name, "return_delay_time");
  const std::pair<std::string, const char*> wrong[] = {
      {R"("baud": 128000,)", "\"baud\" is not a bit rate"},
      {R"("settings": 1,)", "\"settings\" is not an object"},
      {R"("settings": {"id": 3},)", "\"id\" in \"settings\" must be a writable EEPROM register"},
      {R"("settings": {"torque_enable": 1},)", "\"torque_enable\""},
      {R"("settings": {"operating_mode": 2},)", "a value that the register"},
      {R"("settings": {"operating_mode": "3"},)", "a value that the register"},
      {R"("settings": {")" + std::string(5000, 'a') + R"(": 3},)", "aaa...\" in \"settings\""}};
  for (const auto& [more, reason] : wrong) {
    const auto parsed = parse_bus_file("bus.json", file(more));
    ASSERT_FALSE(parsed) << more;
    EXPECT_NE(parsed.error().message.find(reason), std::string::npos) << parsed.error().message;
    EXPECT_LT(parsed.error().message.size(), 400u);
  }
}

TEST(BusFile, SupplyOfAServoAndBroadcastPing) {
  const auto file = [](const std::string& protocol, const std::string& model,
                       const std::string& bus, const std::string& servo) {
    return R"({"protocol": ")" + protocol + R"(", "supply_volts": 12, )" + bus +
           R"("servos": [{"joint": "a", "id": 1, "model": ")" + model + "\"" + servo + "}]}";
  };
  const auto koch =
      parse_bus_file("bus.json", file("dynamixel", "xl330-m288", "", R"(, "supply_volts": 5)"));
  ASSERT_TRUE(koch) << koch.error().message;
  EXPECT_EQ(koch->servos[0].supply_volts, 5.0);
  const auto plain = parse_bus_file("bus.json", file("feetech", "sts3215", "", ""));
  ASSERT_TRUE(plain) << plain.error().message;
  EXPECT_FALSE(plain->servos[0].supply_volts);
  EXPECT_FALSE(plain->broadcast_ping_in_turn);
  for (const auto& [text, in_turn] : {std::pair{"in turn", true}, {"together", false}}) {
    const std::string key = R"("broadcast_ping": ")" + std::string(text) + "\", ";
    const auto parsed = parse_bus_file("bus.json", file("feetech", "sts3215", key, ""));
    ASSERT_TRUE(parsed) << parsed.error().message;
    EXPECT_EQ(parsed->broadcast_ping_in_turn, in_turn);
    EXPECT_FALSE(parse_bus_file("bus.json", file("dynamixel", "xl330-m288", key, "")));
  }
  for (const auto& [bus, servo] : {std::pair{R"("broadcast_ping": "never", )", ""},
                                   {R"("broadcast_ping": 1, )", ""},
                                   {"", R"(, "supply_volts": 31)"},
                                   {"", R"(, "supply_volts": "5")"}})
    EXPECT_FALSE(parse_bus_file("bus.json", file("feetech", "sts3215", bus, servo)))
        << bus << servo;
}

TEST(BusFile, StepsAndAngles) {
  const Model& model = *find_model("sts3215");
  const BusServo plain{"j", 1, &model, 2048, false}, reversed{"j", 1, &model, 2000, true};
  EXPECT_NEAR(plain.steps_at(std::numbers::pi / 2), 3072, 1e-9);
  EXPECT_NEAR(reversed.steps_at(std::numbers::pi / 2), 976, 1e-9);
  for (const double angle : {-2.0, 0.0, 0.3}) {
    EXPECT_NEAR(plain.angle_at(plain.steps_at(angle)), angle, 1e-12);
    EXPECT_NEAR(reversed.angle_at(reversed.steps_at(angle)), angle, 1e-12);
  }
}

TEST(BusFile, RefusesWithAReason) {
  const std::string servo = R"({"joint": "a", "id": 1, "model": "sts3215"})";
  const auto file = [](const std::string& servos) {
    return R"({"protocol": "feetech", "supply_volts": 7.4, "servos": [)" + servos + "]}";
  };
  ASSERT_TRUE(parse_bus_file("bus.json", file(servo)));
  const std::pair<std::string, std::string> wrong[] = {
      {"", "bus.json: line 1 is not valid JSON"},
      {R"({"supply_volts": 1e999})", "bus.json: line 1: the number 1e999 is too large"},
      {R"({"baud": 1, "baud": 2})", "bus.json: the key \"baud\" occurs twice"},
      {"[]", "not a JSON object"},
      {R"({"protocol": "can", "supply_volts": 7, "servos": []})", "\"feetech\" or \"dynamixel\""},
      {file(""), "missing or empty"},
      {file(R"({"joint": "a", "id": 254, "model": "sts3215"})"), "\"id\""},
      {file(R"({"joint": "a", "id": 1.5, "model": "sts3215"})"), "whole number"},
      {file(R"({"joint": "a", "id": 1, "model": "mx64"})"), "scs0009, sts3215"},
      {file(R"({"joint": "a", "id": 1, "model": "xl330-m288"})"), "it must be one of scs0009"},
      {file(R"({"joint": "a", "id": 1, "model": "sts3215", "zeroo": 3})"), "\"zeroo\""},
      {file(R"({"joint": "a", "id": 1, "model": "sts3215", "reversed": 1})"), "\"reversed\""},
      {file(servo + "," + servo), "two servos"},
      {file("7"), "not an object"}};
  for (const auto& [text, reason] : wrong) {
    const auto parsed = parse_bus_file("bus.json", text);
    ASSERT_FALSE(parsed) << text;
    EXPECT_EQ(parsed.error().fault, Fault::usage);
    EXPECT_NE(parsed.error().message.find(reason), std::string::npos) << parsed.error().message;
    EXPECT_EQ(parsed.error().message.find("bus.json: "), 0u);
  }
}

TEST(BusFile, OtherZerosAndAllElseAsItWas) {
  const std::string text =
      R"({"protocol": "feetech", "baud": 500000, "supply_volts": 7.4, "servos": [
    {"joint": "a", "id": 1, "model": "sts3215", "zero": 2048, "reversed": true},
    {"joint": "b", "id": 2, "model": "sts3215"}, {"joint": "c", "id": 3, "model": "sts3215"}]})";
  const std::string changed = with_zeros(text, {{"a", 100}, {"b", -20.5}});
  const auto before = parse_bus_file("bus.json", text), after = parse_bus_file("bus.json", changed);
  ASSERT_TRUE(before);
  ASSERT_TRUE(after) << changed;
  EXPECT_EQ(after->servos[0].zero, 100);
  EXPECT_TRUE(after->servos[0].reversed);
  EXPECT_EQ(after->servos[1].zero, -20.5);
  EXPECT_EQ(after->servos[2].zero, before->servos[2].zero);
  EXPECT_EQ(after->baud, 500000);
  EXPECT_EQ(with_zeros(changed, {}), changed);
}

}  // namespace
}  // namespace kaz::servo_bus
