// The session of the board's page against the files' parameters and a motor stand's simulation.
// SPDX-License-Identifier: Apache-2.0
#include "tools/board_page/session.h"

#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "board_params.h"
#include "shared/protocol/messages.h"
#include "sim/stand/stand_commands.h"
#include "tools/board_page/script.h"

namespace kaz::board_page {
namespace {

const std::string kImage = KAZ_FIRMWARE_IMAGE;

std::unique_ptr<Session> begun(const SessionOptions& options) {
  auto session = Session::begin(kImage, options);
  if (!session) ADD_FAILURE() << session.error().message;
  return session ? std::move(*session) : nullptr;
}

SessionOptions options_of_page() {
  SessionOptions options;
  options.motor = motor_params();
  options.sensors = sensor_params();
  return options;
}

TEST(BoardPage, ParametersAreThoseOfTheFiles) {
  const auto motor = sim::load_motor_file("shared/robot/kaz/motor.xml", "");
  ASSERT_TRUE(motor) << motor.error().message;
  EXPECT_EQ(motor_params(), *motor);
  const auto sensors = sim::load_sensor_file("shared/robot/kaz/sensors.xml");
  ASSERT_TRUE(sensors) << sensors.error().message;
  const sim::SensorParams& file = *sensors;
  const sim::SensorParams page = sensor_params();
  EXPECT_EQ(page.potentiometer.noise_codes, file.potentiometer.noise_codes);
  EXPECT_EQ(page.potentiometer.linearity, file.potentiometer.linearity);
  EXPECT_EQ(page.potentiometer.mounting_rad, file.potentiometer.mounting_rad);
  EXPECT_EQ(page.potentiometer.terminal_rad, file.potentiometer.terminal_rad);
  EXPECT_EQ(page.potentiometer.open_level, file.potentiometer.open_level);
  EXPECT_EQ(page.supply.noise_codes, file.supply.noise_codes);
  EXPECT_EQ(page.reference.noise_codes, file.reference.noise_codes);
  EXPECT_EQ(page.driver.noise_codes, file.driver.noise_codes);
  EXPECT_EQ(page.driver.ambient_celsius, file.driver.ambient_celsius);
  EXPECT_EQ(page.driver.drop_volts, file.driver.drop_volts);
  EXPECT_EQ(page.driver.kelvin_per_watt, file.driver.kelvin_per_watt);
  EXPECT_EQ(page.driver.time_constant_s, file.driver.time_constant_s);
}

// What `kaz bench motor` runs, with recordings, eyes and all.
std::unique_ptr<sim::Simulation> stand_simulation() {
  sim::SimulationOptions options;
  options.mcu = sim::McuKind::h8;
  options.image_path = kImage;
  options.sensor_params = sensor_params();
  auto made = sim::make_stand(options, {.motor = motor_params()});
  if (!made) ADD_FAILURE() << made.error().message;
  return made ? std::move(*made) : nullptr;
}

std::vector<std::uint8_t> bytes_from_board(Session& session) {
  std::vector<std::uint8_t> bytes;
  for (const LineEntry& entry : session.take_line()) {
    if (!entry.to_board) bytes.insert(bytes.end(), entry.wire.begin(), entry.wire.end());
  }
  return bytes;
}

TEST(BoardPage, RunsLikeAMotorStandsSimulation) {
  const auto session = begun(options_of_page());
  const auto simulation = stand_simulation();
  ASSERT_TRUE(session && simulation);
  const auto send = [&](std::uint8_t type, std::vector<std::uint8_t> fields) {
    const auto wire = session->preview(1, type, fields);
    session->send(1, type, fields);
    simulation->write(wire);
  };
  std::vector<std::uint8_t> from_session, from_simulation;
  for (int ms = 0; ms < 1000; ++ms) {
    if (ms == 60) send(KZ_TYPE_telemetry, {0, 10, 15});
    if (ms == 80) send(KZ_TYPE_enable, {0, 3, 0xff, 0xff});
    if (ms == 100) send(KZ_TYPE_targets, {0, 0, 0, 3, 1, 0x2c, 0x03, 0xe8, 0xff, 0x00});
    if (ms % 40 == 0) send(KZ_TYPE_heartbeat, {0, 0});
    if (ms == 500) {
      session->turn(0, -0.4);
      sim::stand_of(*simulation)->turn(0, -0.4);
    }
    ASSERT_TRUE(session->step());
    ASSERT_TRUE(simulation->step());
    for (const std::uint8_t byte : bytes_from_board(*session)) from_session.push_back(byte);
    std::array<std::uint8_t, 256> bytes{};
    const std::size_t count = simulation->read(bytes);
    from_simulation.insert(from_simulation.end(), bytes.begin(), bytes.begin() + count);
    ASSERT_EQ(session->now(), simulation->now());
    ASSERT_EQ(session->board().now(), simulation->board().now()) << "states at " << ms << " ms";
    ASSERT_EQ(session->board().pins(), simulation->board().pins()) << ms << " ms";
    for (std::size_t j = 0; j < KZ_JOINTS; ++j)
      ASSERT_EQ(session->stand().joints()[j].angle, simulation->world().joints()[j].angle) << j;
  }
  EXPECT_GT(from_session.size(), 3000u);
  // The last frame may be under way.
  ASSERT_LE(from_session.size(), from_simulation.size());
  from_simulation.resize(from_session.size());
  EXPECT_EQ(from_session, from_simulation);
  EXPECT_GT(session->stand().joints()[1].angle, -0.03);
  EXPECT_LT(session->stand().joints()[1].angle, -0.02);
}

TEST(BoardPage, SilenceOfTheHostSwitchesMotorsOff) {
  const auto session = begun(options_of_page());
  ASSERT_TRUE(session);
  session->keep_alive(40);
  ASSERT_TRUE(run_script(*session, "run 60\nsend 02 0003ffff\nrun 100\n"));
  EXPECT_TRUE(session->board().drivers_enabled());
  session->keep_alive(0);
  // At most 40 ms since the last heartbeat, and the limit is 90.
  ASSERT_TRUE(run_script(*session, "run 40"));
  EXPECT_TRUE(session->board().drivers_enabled());
  ASSERT_TRUE(run_script(*session, "run 100"));
  EXPECT_FALSE(session->board().drivers_enabled());
}

TEST(BoardPage, ScriptsNameTheLineOfAMistake) {
  const auto session = begun(options_of_page());
  ASSERT_TRUE(session);
  for (const char* wrong :
       {"run 1\nturn 18 0.1", "run 1\nsend 0", "run 1\nraw 0g", "run 1\nfly 3"}) {
    const auto done = run_script(*session, wrong);
    ASSERT_FALSE(done) << wrong;
    EXPECT_NE(done.error().message.find("line 2"), std::string::npos) << done.error().message;
  }
}

TEST(BoardPage, WhatNobodyTakesFromTheLineIsBounded) {
  const auto session = begun(options_of_page());
  ASSERT_TRUE(session);
  const std::array<std::uint8_t, 1> zero{};
  for (std::size_t i = 0; i < Session::max_entries + 10; ++i) session->send_raw(zero);
  EXPECT_GT(session->dropped(), 0);
  EXPECT_LE(session->take_line().size(), Session::max_entries);
}

}  // namespace
}  // namespace kaz::board_page
