// The servo board on a motor stand, and a person at the other end of its serial line.
// SPDX-License-Identifier: Apache-2.0
//
// The same steps as sim/runtime/simulation, of which the page in a browser can have no more: that has
// recordings, eyes and worlds, and their libraries. A test compares both.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "shared/base/result.hpp"
#include "shared/protocol/frame.h"
#include "sim/board/servo_board.h"
#include "sim/mcu/h8_mcu.h"
#include "sim/runtime/simulation/serial_line.h"
#include "sim/stand/motor_stand.h"

namespace kaz::board_page {

// What went over the line, from zero byte to zero byte, or as it was written.
struct LineEntry {
  bool to_board = false;
  sim::States at =
      0;  // to the board: when it was written; from it: end of the step in which it was read
  std::vector<std::uint8_t> wire;
  std::uint8_t result = KZ_RECEIVE_MORE;  // of the first frame in it
  std::vector<std::uint8_t> body;  // of a valid frame: address, type, sequence number, fields
};

struct SessionOptions {
  sim::MotorParams motor;
  sim::SensorParams sensors;
  bool noise = true;  // of the sensors
  h8s::Engine engine = h8s::Options{}.engine;
};

class Session {
 public:
  // Errors: those of H8Mcu::load().
  static Result<std::unique_ptr<Session>> begin(const std::string& image_path,
                                                const SessionOptions& options);
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  // Advances by one millisecond. Errors: the chip has stopped; repeated until reset() or power.
  Result<void> step();
  sim::States now() const { return now_; }  // end of the last step

  // Sends a message with the next sequence number, which is returned. More than KZ_PAYLOAD_MAX bytes of
  // fields are cut off.
  std::uint8_t send(std::uint8_t address, std::uint8_t type, std::span<const std::uint8_t> fields);
  // The same frame, not sent.
  std::vector<std::uint8_t> preview(std::uint8_t address, std::uint8_t type,
                                    std::span<const std::uint8_t> fields) const;
  // Any bytes.
  void send_raw(std::span<const std::uint8_t> bytes);
  // Sends `heartbeat` to all boards each `period_ms`, from now on; 0: no more.
  void keep_alive(int period_ms);
  // What went over the line since the last call, in order of time; at most the newest max_entries.
  std::vector<LineEntry> take_line();
  static constexpr std::size_t max_entries = 4096;
  // Entries that were dropped, because nobody took them.
  std::int64_t dropped() const { return dropped_; }

  // The stand's tools (motor_stand.h), and the supply's knob.
  sim::MotorStand& stand() { return stand_; }
  const sim::MotorStand& stand() const { return stand_; }
  sim::ServoBoard& board() { return board_; }
  const sim::ServoBoard& board() const { return board_; }
  // Where the hand holds a shaft, rad; nullopt: it does not.
  const std::optional<double>& hand(std::size_t joint) const { return hands_[joint]; }
  void turn(std::size_t joint, double angle_rad);
  void release(std::size_t joint);
  const sim::H8Mcu& mcu() const { return *mcu_; }

 private:
  Session(std::unique_ptr<sim::H8Mcu> mcu, const SessionOptions& options);
  void set_sensors();
  void move_shafts();
  void read_line();
  void add(LineEntry entry);
  struct Framed {
    std::vector<std::uint8_t> wire;
    std::uint8_t sequence;
  };
  Framed framed(std::uint8_t address, std::uint8_t type,
                std::span<const std::uint8_t> fields) const;

  sim::H8Mcu* mcu_;  // in board_
  sim::ServoBoard board_;
  sim::MotorStand stand_;
  sim::SerialLine line_;
  sim::States now_ = 0;
  std::array<std::optional<double>, KZ_JOINTS> hands_{};

  std::uint8_t sequence_ = 0;
  int keep_alive_ms_ = 0, keep_alive_left_ = 0;
  kz_receiver receiver_{};
  std::vector<std::uint8_t> incoming_;  // since the last entry
  std::vector<LineEntry> entries_;
  std::int64_t dropped_ = 0;
};

}  // namespace kaz::board_page
