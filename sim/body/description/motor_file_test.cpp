// The motor file: its parameters reproduce the paper's measurements; errors name file and line.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/motor_file.h"

#include "sim/body/description/files_testing.h"

namespace kaz::sim {
namespace {

TEST(MotorFile, GivesTheTorquesThePaperMeasured) {
  for (const char* name : {"", "s9204-original"}) {
    const auto motor = load_motor_file("shared/robot/kaz/motor.xml", name);
    ASSERT_TRUE(motor) << motor.error().message;
    EXPECT_NEAR(motor->stall_slope_nm_per_v * 4.8 - motor->friction_nm, 0.97, 0.005);
    EXPECT_NEAR(motor->stall_slope_nm_per_v * 10 - motor->friction_nm, 2.16, 0.005);
    // 0.19 s for 60 degrees at 4.8 V.
    const double speed =
        (motor->stall_slope_nm_per_v * 4.8 - motor->friction_nm) / motor->back_emf_nms_per_rad;
    EXPECT_NEAR(1.0472 / speed, 0.19, 0.001);
  }
}

TEST(MotorFile, VariantSaysOnlyWhatDiffers) {
  const auto driver = load_motor_file("shared/robot/kaz/motor.xml", "s9204-jskd04");
  const auto original = load_motor_file("shared/robot/kaz/motor.xml", "s9204-original");
  ASSERT_TRUE(driver && original);
  EXPECT_EQ(driver->max_supply_v, 12);
  EXPECT_EQ(original->max_supply_v, 6);
  EXPECT_EQ(original->name, "s9204-original");
  EXPECT_EQ(original->stall_slope_nm_per_v, driver->stall_slope_nm_per_v);
  EXPECT_EQ(original->case_to_air, driver->case_to_air);
  EXPECT_NEAR(original->backlash_rad, 0.00698132, 1e-8);
}

TEST(MotorFile, ReadsWhatItWrites) {
  const test::Folder folder;
  for (const char* name : {"", "s9204-original"}) {
    auto motor = *load_motor_file("shared/robot/kaz/motor.xml", name);
    motor.name = "a <new> \"one\"";
    motor.rotor_inertia_kgm2 = 1.0 / 3000;
    for (const bool warms : {true, false}) {
      if (!warms) motor = motor.ideal();
      const auto again = load_motor_file(
          folder.write("motor.xml", motor_file_text(motor, "fitted -- by hand ---")), "");
      ASSERT_TRUE(again) << again.error().message;
      EXPECT_NEAR(again->backlash_rad, motor.backlash_rad, 1e-15);
      auto same = *again;
      same.backlash_rad = motor.backlash_rad;
      if (warms) {
        EXPECT_EQ(same, motor);
      }
      EXPECT_EQ(same.winding_heat_capacity, motor.winding_heat_capacity);
      EXPECT_EQ(same.rotor_inertia_kgm2, motor.rotor_inertia_kgm2);
    }
  }
}

TEST(MotorFile, NeedsNeitherBacklashNorHeat) {
  const test::Folder folder;
  const auto motor = load_motor_file(
      folder.write("motor.xml",
                   "<motors default='a'><motor name='a'><stall_slope value='1'/>"
                   "<friction value='0'/><back_emf value='1'/><stiction_ratio value='1'/>"
                   "<rotor_inertia value='1'/><max_supply value='1'/></motor></motors>"),
      "");
  ASSERT_TRUE(motor) << motor.error().message;
  EXPECT_EQ(motor->backlash_rad, 0);
  EXPECT_EQ(motor->winding_heat_capacity, 0);
}

constexpr const char* kServoFile =
    R"({"servo": "a", "volts": 6, "model": 1, "source": "s", "license": "l", "date": "2026-01-01",
        "logs": "none", "params": {)"
    R"("kt": {"unit": "N m/A", "value": 2}, "resistance": {"unit": "ohm", "value": 4},)"
    R"("armature": {"unit": "kg m2", "value": 0.02}, "base": {"unit": "N m", "value": 0.1},)"
    R"("viscous": {"unit": "N m s/rad", "value": 0}, "coasting": {"unit": "N m", "value": 0},)"
    R"("gain_ratio": {"unit": "1", "value": 1}, "error_bias": {"unit": "rad", "value": 0},)"
    R"("delay": {"unit": "s", "value": 0.02}, "slew": {"unit": "rad/s", "value": 5},)"
    R"("lag": {"unit": "s", "value": 0}, "most_current": {"unit": "A", "value": 1000}}})";

TEST(MotorFile, NamesAnIdentifiedServo) {
  const test::Folder folder;
  folder.write("a.json", kServoFile);
  const auto read = [&](const std::string& elements) {
    return load_motor_file(
        folder.write("motor.xml", "<motors default='a'>\n<motor name='a'>\n" + elements +
                                      "<servo file='a.json'/><max_supply value='9'/>"
                                      "</motor></motors>"),
        "");
  };
  const auto motor = read("");
  ASSERT_TRUE(motor) << motor.error().message;
  ASSERT_TRUE(motor->servo);
  EXPECT_EQ(motor->servo->params().delay, 0.02);
  EXPECT_EQ(motor->torque_constant(), 2);
  EXPECT_EQ(motor->resistance_ohm(), 4);
  EXPECT_EQ(motor->rotor_inertia_kgm2, 0.02);
  EXPECT_EQ(motor->friction_nm, 0) << "friction_limit() has it";
  const auto wound = read("<stall_slope value='1'/><back_emf value='3'/>");
  ASSERT_TRUE(wound) << wound.error().message;
  EXPECT_EQ(wound->torque_constant(), 3);
  for (const auto& [elements, error] : std::vector<std::pair<std::string, std::string>>{
           {"<friction value='1'/>",
            ":3: <friction> has no effect with <servo>, which replaces it; remove one"},
           {"<stall_slope value='1'/>",
            ":2: <motor> replaces <stall_slope> of <servo>, but not <back_emf>; give both"},
           {"<servo file='a.json'/>", ":3: <servo> occurs twice in <motor>; remove one"}}) {
    const auto refused = read(elements);
    ASSERT_FALSE(refused) << elements;
    EXPECT_TRUE(refused.error().message.ends_with("motor.xml" + error)) << refused.error().message;
  }
  const auto shipped = load_motor_file("sim/robots/so101/motor.xml", "");
  ASSERT_TRUE(shipped) << shipped.error().message;
  EXPECT_EQ(shipped->servo->servo, "sts3215");
  folder.write("a.json", "{}");
  const auto invalid = read("");
  ASSERT_FALSE(invalid);
  EXPECT_NE(invalid.error().message.find("motor.xml:3: <servo>: "), std::string::npos);
  EXPECT_GT(invalid.error().details.size(), 5u) << "all errors of the servo's file";
}

struct Case {
  const char* name;
  const char* motors;
  const char* message;
};

class BadMotorFile : public testing::TestWithParam<Case> {};

TEST_P(BadMotorFile, IsNamedWithFileAndLine) {
  const test::Folder folder;
  const std::string path = folder.write("motor.xml", GetParam().motors);
  const auto motor = load_motor_file(path, "");
  ASSERT_FALSE(motor);
  EXPECT_EQ(motor.error().message, path + GetParam().message);
  EXPECT_EQ(motor.error().fault, Fault::usage);
}

INSTANTIATE_TEST_SUITE_P(
    Cases, BadMotorFile,
    testing::Values(
        Case{"typing_error",
             "<motors default='a'>\n<motor name='a'>\n<fricton value='1'/>\n"
             "</motor></motors>",
             ":3: unknown element <fricton> in <motor>; docs/reference/robot.md lists the "
             "supported elements"},
        Case{
            "twice",
            "<motors default='a'>\n<motor name='a'>\n<friction value='1'/>\n<friction value='2'/>\n"
            "</motor></motors>",
            ":4: <friction> occurs twice in <motor>; remove one"},
        Case{"no_number",
             "<motors default='a'>\n<motor name='a'>\n<friction value='0,1'/>\n"
             "</motor></motors>",
             ":3: attribute `value` of <friction> is \"0,1\", expected a number"},
        Case{"negative",
             "<motors default='a'><motor name='a'>\n\n<friction value='-1'/>"
             "</motor></motors>",
             ":3: <friction> must be at least 0"},
        Case{"incomplete",
             "<motors default='a'>\n<motor name='a'><friction value='1'/></motor>"
             "</motors>",
             ":2: <motor> lacks <stall_slope>"},
        Case{"half_of_the_heat",
             "<motors default='a'>\n<motor name='a'><stall_slope value='1'/>"
             "<friction value='0'/><back_emf value='1'/><stiction_ratio value='1'/>"
             "<rotor_inertia value='1'/><max_supply value='1'/>"
             "<winding_heat_capacity value='5'/></motor></motors>",
             ":2: <motor> lacks <winding_to_case>"},
        Case{"based_on_nothing", "<motors default='a'>\n<motor name='a' based_on='b'/></motors>",
             ":2: is based on motor `b`, which is not defined above; defined above: none"},
        Case{"control_character", "<motors default='a'>\n<motor name='a&#1;'/></motors>",
             ":2: the name `a\\x01` of <motor> contains a control character; remove it"},
        Case{"no_default", "\n<motors></motors>", ":2: <motors> lacks the attribute `default`"}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace kaz::sim
