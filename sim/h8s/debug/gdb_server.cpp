// GDB's remote protocol: packet dispatch, running and stopping.
// SPDX-License-Identifier: Apache-2.0
#include "sim/h8s/debug/gdb_server.h"

#include <algorithm>
#include <cstdio>

namespace kaz::h8s {
namespace {

constexpr std::size_t kMaxTriggers = 4096;

// GDB's signal numbers.
int signal_of(Stop::Reason reason) {
  switch (reason) {
    case Stop::Reason::undefined_instruction:
      return 4;  // SIGILL
    case Stop::Reason::unmapped_access:
    case Stop::Reason::stack_outside_ram:
      return 11;  // SIGSEGV
    case Stop::Reason::undefined_register_use:
      return 6;  // SIGABRT
    case Stop::Reason::asleep_forever:
      return 17;  // SIGSTOP
    default:
      return 5;  // SIGTRAP
  }
}

std::string signal_text(int signal) {
  char text[8];
  std::snprintf(text, sizeof text, "T%02x", static_cast<unsigned>(signal));
  return text;
}

}  // namespace

GdbServer::GdbServer(Chip& chip, HistoryOptions history) : chip_(chip), history_(chip, history) {}

void GdbServer::send(std::string_view data) {
  last_sent_ = gdb_frame(data);
  output_ += last_sent_;
}

std::string GdbServer::take_output() {
  return std::exchange(output_, {});
}

void GdbServer::feed(std::span<const std::uint8_t> bytes) {
  inputs_.clear();
  framing_.feed(bytes, inputs_);
  for (const GdbInput& in : inputs_) {
    if (finished_) return;
    switch (in.kind) {
      case GdbInput::Kind::interrupt:
        if (running_) {
          running_ = false;
          last_stop_ = signal_text(2) + "thread:1;";
          send(last_stop_);
        }
        break;
      case GdbInput::Kind::repeat:
        if (acknowledge_) output_ += last_sent_;
        break;
      case GdbInput::Kind::damaged:
        if (acknowledge_) output_ += '-';
        break;
      case GdbInput::Kind::packet:
        if (acknowledge_) output_ += '+';
        handle(in.data);
        break;
    }
  }
}

void GdbServer::handle(Text packet) {
  if (packet.starts_with("k") || packet.starts_with("vKill")) {
    finished_ = true;
    running_ = false;
    if (packet[0] == 'v') send("OK");
    return;
  }
  if (packet.starts_with("R")) {  // has no answer
    chip_.reset();
    return;
  }
  // Any packet while the chip runs stops it first.
  running_ = false;
  const std::string reply = answer(packet);
  if (!running_) send(reply);
  if (packet == "QStartNoAckMode") acknowledge_ = false;
}

std::string GdbServer::answer(Text packet) {
  if (packet.empty()) return "";
  const Text arguments = packet.substr(1);
  switch (packet[0]) {
    case '?':
      return last_stop_;
    case '!':
    case 'H':
    case 'T':
      return "OK";
    case 'D':
      finished_ = true;
      return "OK";
    case 'g':
      return registers();
    case 'G':
      return set_registers(arguments);
    case 'p':
      return one_register(arguments);
    case 'P':
      return set_one_register(arguments);
    case 'm':
      return read_memory(arguments);
    case 'M':
    case 'X':
      return write_memory(arguments, packet[0] == 'X');
    case 'c':
    case 'C':
    case 's':
    case 'S':
      return resume(packet);
    case 'b':
      if (packet == "bs" || packet == "bc") return go_back(packet == "bs");
      return "";
    case 'z':
    case 'Z':
      return change_trigger(packet);
    case 'q':
    case 'Q':
      return query(packet);
    case 'v':
      return packet.starts_with("vFlash") ? flash(packet) : resume_threads(packet);
    default:
      return "";
  }
}

bool GdbServer::set_pc(Text address) {
  GdbReader in(address);
  const auto pc = in.number();
  if (!pc || !in.empty()) return false;
  Registers r = chip_.registers();
  r.pc = static_cast<std::uint32_t>(*pc) & 0xffffff;
  chip_.set_registers(r);
  return true;
}

std::string GdbServer::single_step() {
  return stopped(history_.step());
}

// c[address], s[address], and with a signal, which is ignored: Csignal[;address]
std::string GdbServer::resume(Text packet) {
  const char action = packet[0];
  packet.remove_prefix(1);
  if (action == 'C' || action == 'S') {
    const std::size_t semicolon = packet.find(';');
    packet = semicolon == Text::npos ? Text() : packet.substr(semicolon + 1);
  }
  if (!packet.empty() && !set_pc(packet)) return "E01";
  if (action == 's' || action == 'S') return single_step();
  running_ = just_resumed_ = true;
  return "";
}

std::string GdbServer::resume_threads(Text packet) {
  if (packet == "vCont?") return "vCont;c;C;s;S";
  GdbReader in(packet);
  if (!in.take("vCont;") || in.empty()) return "";
  // The first action is for the only thread.
  const char action = in.rest()[0];
  if (action == 's' || action == 'S') return single_step();
  if (action != 'c' && action != 'C') return "E01";
  running_ = just_resumed_ = true;
  return "";
}

void GdbServer::run(States states) {
  if (!running_) return;
  Triggers wanted = triggers();
  wanted.at_start = !just_resumed_;
  just_resumed_ = false;
  const Halt halt = history_.run_until(chip_.now() + std::max<States>(states, 1), wanted);
  if (halt.why == Halt::Why::reached) return;
  running_ = false;
  send(stopped(halt));
}

std::string GdbServer::go_back(bool one_step) {
  return stopped(one_step ? history_.step_back() : history_.reverse_continue(triggers()));
}

Triggers GdbServer::triggers() const {
  Triggers t;
  for (const Trigger& s : set_) {
    if (s.type < 2) {
      if (std::find(t.breakpoints.begin(), t.breakpoints.end(), s.address) == t.breakpoints.end())
        t.breakpoints.push_back(s.address);
    } else {
      t.watches.push_back({s.address, s.size, s.type != 2, s.type != 3});
    }
  }
  return t;
}

// The stop reply; the report of an error stop goes to GDB's console first.
std::string GdbServer::stopped(const Halt& halt) {
  std::string text = signal_text(halt.why == Halt::Why::stopped ? signal_of(halt.stop.reason) : 5);
  const Registers r = chip_.registers();
  text += "07:" + hex32(r.er[7]) + ";09:" + hex32(r.pc) + ";thread:1;";
  switch (halt.why) {
    case Halt::Why::breakpoint: {
      const bool soft = std::any_of(set_.begin(), set_.end(), [&](const Trigger& t) {
        return t.type == 0 && t.address == r.pc;
      });
      text += soft ? "swbreak:;" : "hwbreak:;";
      break;
    }
    case Halt::Why::watch: {
      const char* kind = halt.watch.read ? halt.watch.write ? "awatch" : "rwatch" : "watch";
      text += std::string(kind) + ":" + hex32(halt.address) + ";";
      break;
    }
    case Halt::Why::begin:
      text += "replaylog:begin;";
      break;
    case Halt::Why::stopped:
      send(console_packet((halt.stop.report + "\n").substr(0, kMaxPacket / 2 - 8)));
      break;
    case Halt::Why::reached:
      break;
  }
  last_stop_ = text;
  return text;
}

// Ztype,address,size
std::string GdbServer::change_trigger(Text packet) {
  GdbReader in(packet.substr(1));
  const auto type = in.number();
  if (!type || *type > 4) return "";
  if (!in.take(",")) return "E01";
  const auto address = in.number();
  if (!address || !in.take(",")) return "E01";
  const auto size = in.number();
  if (!size || *address > 0xffffff || *size > 0x1000000) return "E01";
  const Trigger t{static_cast<int>(*type), static_cast<std::uint32_t>(*address),
                  *type < 2 ? 0 : static_cast<std::uint32_t>(std::max<std::uint64_t>(*size, 1))};
  const auto found = std::find(set_.begin(), set_.end(), t);
  if (packet[0] == 'z') {
    if (found != set_.end()) set_.erase(found);
  } else if (found == set_.end()) {
    if (set_.size() >= kMaxTriggers) return "E02";
    set_.push_back(t);
  }
  return "OK";
}

}  // namespace kaz::h8s
