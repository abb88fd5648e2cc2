// Reads a board's state, and puts it back.
// SPDX-License-Identifier: Apache-2.0
#include "host/robot/kept_board.h"

#include <algorithm>
#include <functional>

#include "host/link/port_address.h"
#include "host/link/requester.h"
#include "host/robot/connect.h"
#include "host/robot/find_boards.h"
#include "host/robot/typed_request.h"

namespace kaz::host {

namespace {

using std::chrono::milliseconds;

constexpr Time kStart = milliseconds(200);  // within which a board answers after a reset (TIME-4)
constexpr Time kBetweenAttempts = milliseconds(50);
constexpr int kRetries = 3, kTriesToFind = 2;
constexpr std::uint8_t kUnlockSeconds = 10;

// Typed requests to one address.
class Conversation {
 public:
  Conversation(Link& link, Clock& clock, std::uint8_t address)
      : requester_(link, clock, {.address = address, .retries = kRetries}) {}

  template <class Message, class Answer>
  Result<Answer> query(std::uint8_t type, const Message& message, u8 (*pack)(const Message*, u8*),
                       u8 (*unpack)(Answer*, const u8*, u8)) {
    const Request request = make_request(type, message, pack);
    const auto replies = KAZ_TRY(requester_.exchange({&request, 1}));
    return read_reply(replies.front(), unpack);
  }

  Result<kz_identify_reply> identify(std::optional<int> tries = std::nullopt) {
    requester_.limit_tries(tries);
    auto identity = identify_board(requester_);
    requester_.limit_tries(std::nullopt);
    return identity;
  }
  bool timed_out() const { return requester_.timed_out(); }

  Result<void> quiet() {
    // Refused on a shared line, where there is none.
    (void)query(KZ_TYPE_telemetry, kz_telemetry{}, kz_pack_telemetry, kz_unpack_telemetry_reply);
    KAZ_TRY(query(KZ_TYPE_enable, kz_enable{0}, kz_pack_enable, kz_unpack_enable_reply));
    (void)unlock(0);
    return {};
  }
  Result<kz_unlock_reply> unlock(std::uint8_t seconds) {
    return query(KZ_TYPE_unlock, kz_unlock{KZ_KEY, seconds}, kz_pack_unlock,
                 kz_unpack_unlock_reply);
  }
  // The reply may be lost although the board resets; whoever calls looks for the board.
  void reset() {
    requester_.limit_tries(1);
    (void)query(KZ_TYPE_reset, kz_reset{KZ_KEY}, kz_pack_reset, kz_unpack_reset_reply);
    requester_.limit_tries(std::nullopt);
  }
  Result<kz_calibration_reply> calibration() {
    return query(KZ_TYPE_calibration, kz_calibration{}, kz_pack_calibration,
                 kz_unpack_calibration_reply);
  }
  Result<kz_settings_reply> settings(int joint) {
    return query(KZ_TYPE_settings, kz_settings{static_cast<u8>(joint)}, kz_pack_settings,
                 kz_unpack_settings_reply);
  }

 private:
  Requester requester_;
};

bool is_shared(const kz_identify_reply& identity) {
  return (identity.capabilities & KZ_CAPABILITY_TELEMETRY) == 0;
}

void take_settings(const kz_settings_reply& settings, KeptJoint& joint) {
  joint.kp = settings.kp;
  joint.kd = settings.kd;
  joint.dead_band = settings.dead_band;
  joint.friction = settings.friction;
  joint.ramp = settings.ramp;
  joint.lower = settings.lower;
  joint.upper = settings.upper;
}

bool same_gains(const KeptJoint& a, const KeptJoint& b) {
  return a.kp == b.kp && a.kd == b.kd && a.dead_band == b.dead_band && a.friction == b.friction;
}

bool same_limits(const KeptJoint& a, const KeptJoint& b) {
  return a.ramp == b.ramp && a.lower == b.lower && a.upper == b.upper;
}

Result<BoardState> read_settings(Conversation& board, std::uint8_t address) {
  const auto identity = KAZ_TRY(board.identify());
  BoardState state;
  state.address = address;
  state.shared_line = is_shared(identity);
  state.watchdog_10ms = identity.watchdog_10ms;
  state.reaction = identity.reaction;
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
    take_settings(KAZ_TRY(board.settings(static_cast<int>(j))), state.joints[j]);
  }
  const auto calibration = KAZ_TRY(board.calibration());
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
    state.joints[j].centre = calibration.centre[j];
    state.joints[j].scale = calibration.scale[j];
  }
  return state;
}

std::string of_joints(const std::string& what, u32 mask) {
  int count = 0, last = 0;
  for (int j = 0; j < KZ_JOINTS; ++j) {
    if ((mask >> j & 1) == 0) continue;
    ++count;
    last = j;
  }
  return what + " of " +
         (count == 1 ? std::string(joint_table()[static_cast<std::size_t>(last)].name)
                     : std::to_string(count) + " joints");
}

// Joints for which `same` is false.
u32 differing(const BoardState& a, const BoardState& b,
              const std::function<bool(const KeptJoint&, const KeptJoint&)>& same) {
  u32 mask = 0;
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
    if (!same(a.joints[j], b.joints[j])) mask |= u32{1} << j;
  }
  return mask;
}

class Return {
 public:
  Return(Link& link, Clock& clock, const BoardState& state, const PutBackOptions& options)
      : link_(link),
        clock_(clock),
        state_(state),
        options_(options),
        deadline_(clock.now() + options.patience) {}

  PutBack go() {
    // What is not known to be back is left.
    std::optional<Error> error;
    do {
      result_.left.clear();
      const auto tried = attempt();
      if (tried) return result_;
      error = tried.error();
      if (!clock_.sleep_until(clock_.now() + kBetweenAttempts)) break;
    } while (clock_.now() < deadline_);
    if (result_.left.empty()) result_.left.push_back(step_ + " (" + error->message + ")");
    return result_;
  }

 private:
  // Once, although an attempt may be repeated.
  void put(const std::string& what) {
    if (std::ranges::find(result_.done, what) == result_.done.end()) result_.done.push_back(what);
  }

  Result<void> attempt() {
    step_ = result_.found_at == 0 ? "everything, because the board was not found"
                                  : "the board's address";
    auto at = KAZ_TRY(locate());
    if (result_.found_at == 0) result_.found_at = at;
    // An address that was written is in force after a reset, and RAM hides what is in flash.
    if (options_.reset || options_.flash) at = KAZ_TRY(restart(at));
    if (options_.flash) {
      KAZ_TRY(put_address(at));
      step_ = "the calibration in flash";
      Conversation board(link_, clock_, state_.address);
      if (state_.flash) {
        KAZ_TRY(put_stored(board));
      }
    }
    Conversation board(link_, clock_, state_.address);
    step_ = "settings in RAM";
    if (options_.settings) {
      if (options_.motors_off) {
        KAZ_TRY(board.quiet());
      }
      KAZ_TRY(put_settings(board));
    }
    const auto identity = KAZ_TRY(board.identify());
    result_.status = identity.status;
    if (!options_.motors_off || (identity.status & KZ_STATUS_ENABLED) == 0) return {};
    result_.left.emplace_back("motors (still on)");
    return fail(Fault::environment, "motors on " + link_.name() + " are still on");
  }

  // Where the board is now: at its old address first.
  Result<std::uint8_t> locate() {
    while (true) {
      Conversation old(link_, clock_, state_.address);
      const auto there = old.identify(kTriesToFind);
      if (there) return state_.address;
      Error error = there.error();
      if (!old.timed_out()) {
        (void)link_.reopen();
      } else if (options_.flash) {
        auto found = find_boards(link_, clock_);
        if (found) {
          std::erase_if(*found, [this](std::uint8_t a) {
            return std::ranges::find(options_.others, a) != options_.others.end();
          });
          if (!found->empty()) return found->front();
        } else {
          error = found.error();
        }
      }
      if (clock_.now() >= deadline_) return tl::unexpected(error);
      if (auto slept = clock_.sleep_until(clock_.now() + kBetweenAttempts); !slept)
        return tl::unexpected(slept.error());
    }
  }

  Result<std::uint8_t> restart(std::uint8_t at) {
    Conversation board(link_, clock_, at);
    KAZ_TRY(board.quiet());
    board.reset();
    if (auto slept = clock_.sleep_until(clock_.now() + kStart); !slept)
      return tl::unexpected(slept.error());
    return locate();
  }

  Result<void> put_address(std::uint8_t at) {
    step_ = "address " + std::to_string(at) + " to " + std::to_string(state_.address);
    Conversation board(link_, clock_, at);
    const auto identity = KAZ_TRY(board.identify());
    if (at == state_.address && is_shared(identity) == state_.shared_line) return {};
    KAZ_TRY(board.unlock(kUnlockSeconds));
    const kz_set_address message{state_.address, static_cast<u8>(state_.shared_line ? 1 : 0)};
    KAZ_TRY(board.query(KZ_TYPE_set_address, message, kz_pack_set_address,
                        kz_unpack_set_address_reply));
    const auto now = KAZ_TRY(restart(at));
    Conversation moved(link_, clock_, now);
    const auto again = KAZ_TRY(moved.identify());
    if (now != state_.address || is_shared(again) != state_.shared_line)
      return fail(Fault::environment, "the board on " + link_.name() + " stays at address " +
                                          std::to_string(now) +
                                          " although another address was stored");
    if (at != state_.address) put(step_);
    if (is_shared(identity) != state_.shared_line)
      put(state_.shared_line ? "line set to shared" : "line set to not shared");
    return {};
  }

  Result<void> calibrate(Conversation& board, u32 mask, bool stored) {
    kz_calibrate message{};
    message.mask = mask;
    for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
      const KeptJoint& joint = state_.joints[j];
      message.centre[j] = stored ? joint.stored_centre : joint.centre;
      message.scale[j] = stored ? joint.stored_scale : joint.scale;
    }
    KAZ_TRY(board.query(KZ_TYPE_calibrate, message, kz_pack_calibrate, kz_unpack_calibrate_reply));
    return {};
  }

  // Just after a reset: what is in use is what is stored.
  Result<void> put_stored(Conversation& board) {
    const auto differs = [this](const kz_calibration_reply& now) {
      u32 mask = 0;
      for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
        if (now.centre[j] != state_.joints[j].stored_centre ||
            now.scale[j] != state_.joints[j].stored_scale)
          mask |= u32{1} << j;
      }
      return mask;
    };
    auto now = KAZ_TRY(board.calibration());
    if (const u32 mask = differs(now); mask != 0) {
      KAZ_TRY(calibrate(board, mask, true));
      KAZ_TRY(board.query(KZ_TYPE_store_calibration, kz_store_calibration{},
                          kz_pack_store_calibration, kz_unpack_store_calibration_reply));
      now = KAZ_TRY(board.calibration());
      if (differs(now) != 0)
        return fail(Fault::environment,
                    "the board on " + link_.name() +
                        " stored a calibration that differs from the calibration that was sent");
      put(of_joints("stored calibration", mask));
    }
    result_.notes.clear();
    if (state_.stored_copy == 0 && now.sequence != 0) {
      const auto identity = KAZ_TRY(board.identify());
      result_.notes.push_back(
          "no calibration was stored before; now the flash contains the nominal values" +
          how_calibration_goes(identity, link_.name(), state_.address));
    }
    return {};
  }

  Result<void> put_settings(Conversation& board) {
    auto now = KAZ_TRY(read_settings(board, state_.address));
    if (now.watchdog_10ms != state_.watchdog_10ms || now.reaction != state_.reaction) {
      const kz_heartbeat message{state_.watchdog_10ms, state_.reaction};
      KAZ_TRY(
          board.query(KZ_TYPE_heartbeat, message, kz_pack_heartbeat, kz_unpack_heartbeat_reply));
      put("link watchdog");
    }
    if (const u32 mask = differing(state_, now, same_gains); mask != 0) {
      KAZ_TRY(for_groups(mask, same_gains, [&](u32 group, const KeptJoint& j) {
        const kz_gains message{group, j.kp, j.kd, j.dead_band, j.friction};
        return board.query(KZ_TYPE_gains, message, kz_pack_gains, kz_unpack_gains_reply);
      }));
      put(of_joints("gains", mask));
    }
    if (const u32 mask = differing(state_, now, same_limits); mask != 0) {
      KAZ_TRY(for_groups(mask, same_limits, [&](u32 group, const KeptJoint& j) {
        const kz_limits message{group, j.ramp, j.lower, j.upper};
        return board.query(KZ_TYPE_limits, message, kz_pack_limits, kz_unpack_limits_reply);
      }));
      put(of_joints("limits", mask));
    }
    const auto same_line = [](const KeptJoint& a, const KeptJoint& b) {
      return a.centre == b.centre && a.scale == b.scale;
    };
    if (const u32 mask = differing(state_, now, same_line); mask != 0) {
      KAZ_TRY(calibrate(board, mask, false));
      put(of_joints("calibration in use", mask));
    }
    now = KAZ_TRY(read_settings(board, state_.address));
    return compare(now, same_line);
  }

  // One request for joints that are set alike.
  template <class Same, class Set>
  Result<void> for_groups(u32 mask, Same same, Set set) {
    while (mask != 0) {
      std::size_t first = 0;
      while ((mask >> first & 1) == 0) ++first;
      u32 group = 0;
      for (std::size_t j = first; j < KZ_JOINTS; ++j) {
        if ((mask >> j & 1) != 0 && same(state_.joints[first], state_.joints[j]))
          group |= u32{1} << j;
      }
      KAZ_TRY(set(group, state_.joints[first]));
      mask &= ~group;
    }
    return {};
  }

  template <class Same>
  Result<void> compare(const BoardState& now, Same same_line) {
    if (now.watchdog_10ms != state_.watchdog_10ms || now.reaction != state_.reaction)
      result_.left.emplace_back("link watchdog");
    const std::pair<const char*, u32> masks[] = {
        {"gains", differing(state_, now, same_gains)},
        {"limits", differing(state_, now, same_limits)},
        {"calibration in use", differing(state_, now, same_line)}};
    for (const auto& [what, mask] : masks) {
      if (mask != 0) result_.left.push_back(of_joints(what, mask));
    }
    if (result_.left.empty()) return {};
    return fail(Fault::environment,
                "settings of the board on " + link_.name() + " differ from the saved settings");
  }

  Link& link_;
  Clock& clock_;
  const BoardState& state_;
  const PutBackOptions& options_;
  Time deadline_;
  PutBack result_;
  std::string step_;  // what is being put back
};

}  // namespace

std::string how_calibration_goes(const kz_identify_reply& identity, const std::string& port,
                                 std::uint8_t address) {
  if (identity.image_crc == 0)
    return "; kaz sim --mcu native has no loader to erase these values, and loses the values at "
           "its end unless --memory is given";
  return "; `kaz flash erase --blocks 1,2 " + robot_option(port) +
         (address == KZ_ADDRESS_DEFAULT ? "" : " --address " + std::to_string(address)) +
         "` erases these values";
}

Result<BoardState> read_board(Link& link, Clock& clock, std::uint8_t address) {
  Conversation board(link, clock, address);
  const auto identity = board.identify();
  if (!identity)
    return tl::unexpected(board.timed_out()
                              ? explain_silence(link, clock, address, identity.error())
                              : identity.error());
  return read_settings(board, address);
}

Result<void> read_flash(Link& link, Clock& clock, BoardState& state) {
  Conversation board(link, clock, state.address);
  KAZ_TRY(board.quiet());
  board.reset();
  KAZ_TRY(clock.sleep_until(clock.now() + kStart));
  KAZ_TRY(board.identify());
  const auto stored = KAZ_TRY(board.calibration());
  state.flash = true;
  state.stored_copy = stored.sequence;
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
    state.joints[j].stored_centre = stored.centre[j];
    state.joints[j].stored_scale = stored.scale[j];
  }
  return {};
}

PutBack put_back(Link& link, Clock& clock, const BoardState& state, const PutBackOptions& options) {
  return Return(link, clock, state, options).go();
}

}  // namespace kaz::host
