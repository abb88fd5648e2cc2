// Test fixture: runs the firmware on the emulated chip and reads the firmware's state between ticks.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "firmware/image_testing.h"
#include "shared/servo/fields.h"
#include "shared/servo/store.h"
#include "shared/servo/tick.h"
#include "sim/h8s/chip/chip.h"
#include "sim/mcu/h8_layout.h"
#include "sim/mcu/h8_mcu.h"

namespace kaz::sim {

// Calibration of all joints.
struct Calibration {
  std::array<s16, KZ_JOINTS> centre{}, scale{};
  bool operator==(const Calibration&) const = default;
  // Returns calibration `n`. Each `n` gives a different calibration.
  static Calibration number(int n) {
    Calibration c;
    for (int j = 0; j < KZ_JOINTS; ++j) {
      c.centre[j] = static_cast<s16>(31 * n - 77 * j);
      c.scale[j] = static_cast<s16>(16000 + 7 * n - j);
    }
    return c;
  }
};

// Emulated chip with the firmware image. The supply is healthy; all other A/D inputs are at mid-scale.
class TestChip : public testing::Test {
 protected:
  static constexpr States ms = KZ_STATES_PER_TICK;
  static constexpr std::uint32_t calibration_at = 0x400, address_at = 0xC00;

  void SetUp() override {
    auto loaded = H8Mcu::load(firmware_image());
    ASSERT_TRUE(loaded) << loaded.error().message;
    mcu = std::move(*loaded);
    mcu->set_analog([this](int channel, const PinLevels& levels, States) {
      const int input = channel * KZ_MUX_INPUTS + (levels.p4 & KZ_P4_MUX_MASK);
      if (input == KZ_ANALOG_SUPPLY) return 667.5 / KZ_POT_CODES;
      if (input == KZ_ANALOG_REFERENCE) return reference;
      return 0.5;
    });
    kz_startup nominal;
    kz_startup_nominal(&nominal);
    std::copy_n(nominal.pot_centre, KZ_JOINTS, nominal_values.centre.begin());
    std::copy_n(nominal.pot_scale, KZ_JOINTS, nominal_values.scale.begin());
  }

  h8s::Chip& chip() { return mcu->chip(); }
  std::uint32_t address_of(const char* symbol) {
    return chip().symbols().address_of(symbol).value();
  }
  void run(States states) {
    const auto ran = mcu->run_until(mcu->now() + states);
    ASSERT_TRUE(ran) << ran.error().message;
  }
  // Runs to the instruction at `symbol`. Returns the elapsed states, or -1 if the instruction is not reached
  // within `longest`.
  States run_to(const char* symbol, States longest = 100 * ms) {
    const std::uint32_t at = address_of(symbol);
    const States from = chip().now();
    bool there = false;
    chip().set_hook(at, [&there](h8s::Chip&) {
      there = true;
      return h8s::HookAction::stop;
    });
    chip().run_until(from + longest);
    chip().clear_hook(at);
    return there ? chip().now() - from : -1;
  }

  kz_startup startup() {
    const auto bytes = mcu->global("kz_startup_found", h8_layout::kStartupSize);
    return h8_layout::decode_startup(std::span<const u8, h8_layout::kStartupSize>(bytes));
  }
  kz_tick_input input() {
    const auto bytes = mcu->global("kz_input", h8_layout::kInputSize);
    return h8_layout::decode_input(std::span<const u8, h8_layout::kInputSize>(bytes));
  }
  Calibration at_start() {
    const kz_startup found = startup();
    Calibration c;
    std::copy_n(found.pot_centre, KZ_JOINTS, c.centre.begin());
    std::copy_n(found.pot_scale, KZ_JOINTS, c.scale.begin());
    return c;
  }

  // Writes one element of a field of the servo's state (fields.h).
  void set_state(const std::string& name, int element, int value) {
    for (std::size_t f = 0; f < kz_state_field_count; ++f) {
      const kz_state_field& field = kz_state_fields[f];
      if (name != field.name) continue;
      const std::uint32_t at = address_of("kz_servo_state") + field.offset +
                               static_cast<std::uint32_t>(element * field.stride);
      for (int i = 0; i < field.size; ++i)
        chip().poke(at + static_cast<std::uint32_t>(i),
                    static_cast<u8>(value >> 8 * (field.size - 1 - i)));
      return;
    }
    FAIL() << "the state has no field " << name;
  }
  void set_calibration(const Calibration& c) {
    for (int j = 0; j < KZ_JOINTS; ++j) {
      set_state("joint.pot_centre", j, c.centre[j]);
      set_state("joint.pot_scale", j, c.scale[j]);
    }
  }

  // Runs to the end of a tick. Then writes `action` to the tick's output, as the action that the tick
  // requests.
  void request_action(u8 action) {
    ASSERT_GE(run_to("kz_tick_end"), 0) << chip().report();
    ASSERT_TRUE(chip().poke(address_of("kz_output") + offsetof(kz_tick_output, action), action));
  }
  // Outcome of an action, read from the snapshot of the next tick.
  struct Outcome {
    int result = -1;  // KZ_RESULT_*
    int missed = -1;  // number of missed ticks
    States deaf = 0;  // time until the start of the next tick
  };
  // Requests `action` and runs to the start of the next tick.
  Outcome done(u8 action) {
    request_action(action);
    Outcome outcome;
    outcome.deaf = run_to("kz_tick_begin", 4000 * ms);
    EXPECT_GE(outcome.deaf, 0) << chip().report();
    outcome.result = input().result;
    outcome.missed = input().missed;
    return outcome;
  }
  // Lets the firmware store `c` in flash.
  Outcome store(const Calibration& c) {
    EXPECT_GE(run_to("kz_tick_end"), 0);
    set_calibration(c);
    return done(KZ_ACTION_STORE_CALIBRATION);
  }

  // Scans the calibration log in flash, as the firmware does at its start.
  kz_store log() const { return log_of(mcu->chip()); }
  static kz_store log_of(const h8s::Chip& at) {
    const auto image = blocks_of(at);
    const u8* const images[] = {image.data(), image.data() + KZ_STORE_BLOCK};
    kz_store found;
    kz_store_scan(&found, images, KZ_CALIBRATION_BLOCKS, KZ_CALIBRATION_PARTS);
    return found;
  }
  // Returns the stored calibration, or nullopt if there is no valid copy.
  static std::optional<Calibration> stored_in(const h8s::Chip& at) {
    const auto image = blocks_of(at);
    const u8* const images[] = {image.data(), image.data() + KZ_STORE_BLOCK};
    kz_store found;
    kz_store_scan(&found, images, KZ_CALIBRATION_BLOCKS, KZ_CALIBRATION_PARTS);
    if (found.sequence == 0) return std::nullopt;
    kz_startup startup;
    kz_store_load_calibration(&found, images, &startup);
    Calibration c;
    std::copy_n(startup.pot_centre, KZ_JOINTS, c.centre.begin());
    std::copy_n(startup.pot_scale, KZ_JOINTS, c.scale.begin());
    return c;
  }
  // Returns the bytes of both calibration blocks.
  static std::vector<u8> blocks_of(const h8s::Chip& at) {
    std::vector<u8> image(2 * KZ_STORE_BLOCK);
    at.peek(calibration_at, image);
    return image;
  }
  // Fails the test if the emulator reports a misuse of the chip by the firmware.
  void expect_no_misuse() {
    for (const h8s::Misuse& misuse : chip().misuse()) ADD_FAILURE() << misuse.text;
  }

  std::unique_ptr<H8Mcu> mcu;
  double reference = 0.5;  // A/D level of the reference, as a share of full scale
  Calibration nominal_values;
};

}  // namespace kaz::sim
