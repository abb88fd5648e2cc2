// The session as functions that JavaScript calls (src/chip.ts). Texts are valid until the next call.
// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <string>

#include <emscripten/emscripten.h>

#include "board_params.h"
#include "tools/board_page/script.h"
#include "tools/board_page/session.h"
#include "tools/board_page/view.h"

namespace {

using kaz::board_page::Session;

std::unique_ptr<Session> session;
std::string text;

const char* shown(std::string what) {
  text = std::move(what);
  return text.c_str();
}

std::span<const std::uint8_t> bytes_of(const std::uint8_t* bytes, int count) {
  return {bytes, static_cast<std::size_t>(count)};
}

std::string begin(bool noise) {
  auto begun = Session::begin("/kaz.mot", {.motor = kaz::board_page::motor_params(),
                                           .sensors = kaz::board_page::sensor_params(),
                                           .noise = noise,
                                           .engine = kaz::h8s::Engine::interpreter});
  if (!begun) return begun.error().message;
  session = std::move(*begun);
  return {};
}

}  // namespace

extern "C" {

// A new board, switched on. Empty, or an error.
EMSCRIPTEN_KEEPALIVE const char* board_begin(int noise) {
  return shown(begin(noise != 0));
}

// Empty, or why the chip has stopped.
EMSCRIPTEN_KEEPALIVE const char* board_run(int milliseconds) {
  for (int i = 0; i < milliseconds; ++i) {
    if (auto done = session->step(); !done) return shown(done.error().message);
  }
  return "";
}

EMSCRIPTEN_KEEPALIVE const char* board_view(int registers) {
  return shown(kaz::board_page::view_json(*session, registers != 0));
}

EMSCRIPTEN_KEEPALIVE const char* board_line() {
  return shown(kaz::board_page::line_json(session->take_line()));
}

EMSCRIPTEN_KEEPALIVE int board_send(int address, int type, const std::uint8_t* fields, int count) {
  return session->send(static_cast<std::uint8_t>(address), static_cast<std::uint8_t>(type),
                       bytes_of(fields, count));
}

EMSCRIPTEN_KEEPALIVE const char* board_preview(int address, int type, const std::uint8_t* fields,
                                               int count) {
  return shown(kaz::board_page::hex(session->preview(static_cast<std::uint8_t>(address),
                                                     static_cast<std::uint8_t>(type),
                                                     bytes_of(fields, count))));
}

EMSCRIPTEN_KEEPALIVE void board_raw(const std::uint8_t* bytes, int count) {
  session->send_raw(bytes_of(bytes, count));
}

EMSCRIPTEN_KEEPALIVE void board_keep_alive(int period_ms) {
  session->keep_alive(period_ms);
}

EMSCRIPTEN_KEEPALIVE void board_turn(int joint, double angle_rad) {
  session->turn(static_cast<std::size_t>(joint), angle_rad);
}

EMSCRIPTEN_KEEPALIVE void board_release(int joint) {
  session->release(static_cast<std::size_t>(joint));
}

EMSCRIPTEN_KEEPALIVE void board_pot_open(int joint, int open) {
  kaz::sim::PotFault fault;
  if (open != 0) fault.level = 1.0;
  session->board().set_pot_fault(joint, fault);
}

EMSCRIPTEN_KEEPALIVE void board_supply(double volts) {
  session->board().set_supply(volts);
}

EMSCRIPTEN_KEEPALIVE void board_power(int on) {
  session->board().set_power(on != 0);
}

EMSCRIPTEN_KEEPALIVE void board_reset() {
  session->board().reset();
}

// A new board runs the script; its output, or "error: ..." .
EMSCRIPTEN_KEEPALIVE const char* board_script(const char* script, int noise) {
  const std::string commands = script;
  if (auto error = begin(noise != 0); !error.empty()) return shown("error: " + error);
  auto output = kaz::board_page::run_script(*session, commands);
  return shown(output ? *output : "error: " + output.error().message);
}

}  // extern "C"
