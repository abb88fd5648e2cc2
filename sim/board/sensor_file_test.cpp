// The sensor file, valid and damaged.
// SPDX-License-Identifier: Apache-2.0
#include "sim/board/sensor_file.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "shared/base/enum_names.hpp"
#include "sim/body/description/files_testing.h"

namespace kaz::sim {
namespace {

const std::string kFile = "shared/robot/kaz/sensors.xml";

TEST(SensorFile, GivesSiUnits) {
  const auto params = load_sensor_file(kFile);
  ASSERT_TRUE(params) << params.error().message;
  EXPECT_EQ(params->potentiometer.noise_codes, 0.5);
  EXPECT_NEAR(params->potentiometer.mounting_rad, 0.0174533, 1e-7);
  EXPECT_NEAR(params->gyro.share_per_unit, 0.0572958, 1e-7);  // 5 mV of 5 V a degree/s
  EXPECT_NEAR(params->gyro.range, 5.235988, 1e-6);            // 300 degrees/s
  EXPECT_NEAR(params->accelerometer.share_per_unit * 9.80665, 0.0624, 1e-12);
  EXPECT_NEAR(params->accelerometer.noise_density, 1.96133e-3, 1e-9);
}

struct Broken {
  const char* name;
  const char* from;
  const char* to;
  const char* message;  // after the file's path
};

class BrokenSensorFile : public testing::TestWithParam<Broken> {};

TEST_P(BrokenSensorFile, IsRefusedWithFileAndLine) {
  std::string text = test::read_text(kFile);
  const auto at = text.find(GetParam().from);
  ASSERT_NE(at, std::string::npos);
  text.replace(at, std::string(GetParam().from).size(), GetParam().to);
  const test::Folder folder;
  const std::string path = folder.write("sensors.xml", text);
  const auto params = load_sensor_file(path);
  ASSERT_FALSE(params);
  EXPECT_EQ(params.error().fault, Fault::usage);
  // The line where the text was changed.
  const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<long>(at), '\n');
  const std::string expected = path + ":" + std::to_string(line) + ": " + GetParam().message;
  EXPECT_EQ(params.error().message.substr(0, expected.size()), expected);
}

INSTANTIATE_TEST_SUITE_P(
    Files, BrokenSensorFile,
    testing::Values(
        Broken{"unknown_sensor", "<supply>", "<lidar/><supply>", "unknown sensor <lidar>"},
        Broken{"unknown_param", "<terminal value", "<finish value",
               "unknown element <finish> in <potentiometer>"},
        Broken{"no_number", "<linearity value=\"0.005\"/>", "<linearity value=\"some\"/>",
               "attribute `value` of <linearity> is \"some\""},
        Broken{"negative", "<range value=\"300\"/>", "<range value=\"-300\"/>",
               "<range> of <gyro> must be at least"},
        Broken{"too_much", "<open_level value=\"1.0\"/>", "<open_level value=\"1.5\"/>",
               "<open_level> of <potentiometer> must be at least 0 and at most 1"},
        Broken{"twice", "<range value=\"2\"/>", "<scale value=\"0.1\"/>",
               "<scale> occurs twice in <accelerometer>"}),
    [](const auto& one) { return one.param.name; });

TEST(SensorFile, SaysWhatIsMissing) {
  const test::Folder folder;
  std::string text = test::read_text(kFile);
  const std::string gone = "<bandwidth value=\"40\"/>";
  text.erase(text.find(gone), gone.size());
  const auto params = load_sensor_file(folder.write("sensors.xml", text));
  ASSERT_FALSE(params);
  EXPECT_NE(params.error().message.find("<gyro> lacks <bandwidth>"), std::string::npos)
      << params.error().message;
  EXPECT_FALSE(load_sensor_file("/nowhere/sensors.xml"));
}

TEST(Switches, HaveNames) {
  EXPECT_EQ(sensor_switches(SensorSet::ideal), SensorSwitches::ideal());
  EXPECT_EQ(sensor_switches(SensorSet::nominal), SensorSwitches{});
  EXPECT_EQ(sensor_switches(SensorSet::as_built), SensorSwitches::as_built());
  for (const SensorSet set : kSensorSets) EXPECT_EQ(parse_enum(kSensorSets, to_string(set)), set);
  EXPECT_FALSE(parse_enum(kSensorSets, "perfect"));
}

}  // namespace
}  // namespace kaz::sim
