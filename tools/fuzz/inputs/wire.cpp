// What comes from a board: frames, and a hostile board at the host's Robot.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <vector>

#include "hil/conformance/codec.h"
#include "hil/fuzz/choices.h"
#include "host/camera/raw_picture.h"
#include "host/link/board_testing.h"
#include "host/robot/robot.h"
#include "shared/protocol/frame.h"
#include "tools/fuzz/inputs/targets.h"

namespace kaz::fuzz {
namespace {

using hil::fuzz::Choices;
using Body = std::vector<std::uint8_t>;

// Bodies of the frames that the shared receiver accepts.
std::vector<Body> received(Bytes wire) {
  kz_receiver receiver;
  kz_receiver_init(&receiver);
  std::vector<Body> bodies;
  for (const std::uint8_t byte : wire) {
    if (kz_receive(&receiver, byte, 0) == KZ_RECEIVE_FRAME)
      bodies.emplace_back(receiver.body, receiver.body + receiver.length);
  }
  return bodies;
}

// The same by pieces of up to 255 bytes.
std::vector<Body> received_by_pieces(Bytes wire, std::uint8_t piece) {
  kz_receiver receiver;
  kz_receiver_init(&receiver);
  std::vector<Body> bodies;
  const std::vector<std::uint8_t> errors(256, 0);
  while (!wire.empty()) {
    const auto count =
        static_cast<std::uint8_t>(std::min<std::size_t>(wire.size(), piece == 0 ? 1 : piece));
    const unsigned result = kz_receive_some(&receiver, wire.data(), errors.data(), count);
    if ((result & 0xff) == 0 || (result & 0xff) > count) return {};
    if (result >> 8 == KZ_RECEIVE_FRAME)
      bodies.emplace_back(receiver.body, receiver.body + receiver.length);
    wire = wire.subspan(result & 0xff);
  }
  return bodies;
}

// By conformance's own decoder. A zero between two frames counts twice for the receiver, as the end of one
// and the start of the next; the decoder insists on two. It knows no longest frame.
std::vector<Body> deframed(Bytes wire) {
  hil::Deframer deframer;
  std::vector<Body> bodies;
  for (const std::uint8_t byte : wire) {
    const auto frame = deframer.take(byte, Time::zero());
    if (byte == 0) (void)deframer.take(0, Time::zero());
    if (!frame || frame->fields.size() > KZ_PAYLOAD_MAX) continue;
    Body body{frame->address, frame->type, frame->sequence};
    body.insert(body.end(), frame->fields.begin(), frame->fields.end());
    bodies.push_back(std::move(body));
  }
  return bodies;
}

// Whole frames, raw bytes and damaged frames, as the input chooses: check sums are hard to guess.
std::vector<std::uint8_t> wire_of(Bytes bytes) {
  Choices choices(bytes);
  std::vector<std::uint8_t> wire;
  while (!choices.ended() && wire.size() < 4096) {
    const unsigned kind = choices.below(4), length = choices.below(KZ_PAYLOAD_MAX + 8);
    std::vector<std::uint8_t> content;
    for (unsigned k = 0; k < length; ++k) content.push_back(choices.byte());
    if (kind > 0) {
      content = hil::frame_of(choices.byte(), choices.byte(), choices.byte(), content);
      if (kind == 2) content[choices.byte() % content.size()] = choices.byte();
      if (kind == 3) content.resize(choices.byte() % content.size());
    }
    wire.insert(wire.end(), content.begin(), content.end());
  }
  return wire;
}

// ---- A hostile board

// Between board and host: what the input makes of each frame.
class Hostile {
 public:
  explicit Hostile(Choices& choices) : choices_(choices) {}
  host::TestBoard::Bytes operator()(host::TestBoard::Bytes frame) {
    if (choices_.ended()) return frame;
    switch (choices_.below(8)) {
      case 0:
      case 1:
      case 2:  // the right reply with other fields
        return with_fields(frame, true);
      case 3:  // with fields of another length
        return with_fields(frame, false);
      case 4:
        frame[choices_.byte() % frame.size()] = choices_.byte();
        return frame;
      case 5:
        frame.resize(choices_.byte() % frame.size());
        return frame;
      case 6: {
        host::TestBoard::Bytes noise(choices_.below(64));
        for (auto& byte : noise) byte = choices_.byte();
        noise.insert(noise.end(), frame.begin(), frame.end());
        return noise;
      }
      default:
        return frame;
    }
  }

 private:
  host::TestBoard::Bytes with_fields(const host::TestBoard::Bytes& frame, bool same_length) {
    hil::Deframer deframer;
    std::optional<hil::Frame> found;
    for (const std::uint8_t byte : frame) {
      if (auto one = deframer.take(byte, Time::zero())) found = one;
    }
    if (!found) return frame;
    std::size_t length = same_length ? found->fields.size() : choices_.below(KZ_PAYLOAD_MAX + 1);
    found->fields.resize(length);
    // A few of them, or all.
    const unsigned changed = choices_.below(8);
    if (changed == 7) {
      for (auto& field : found->fields) field = choices_.byte();
    } else {
      for (unsigned k = 0; k <= changed && length > 0; ++k)
        found->fields[choices_.byte() % length] = choices_.byte();
    }
    if (choices_.below(32) == 31) found->type = choices_.byte();
    if (choices_.below(32) == 31) found->sequence = choices_.byte();
    return hil::frame_of(found->address, found->type, found->sequence, found->fields);
  }

  Choices& choices_;
};

Complaint judge(const host::Posture& posture) {
  for (const double angle : posture.angle) {
    if (!std::isfinite(angle) || std::abs(angle) > 7) return "an invalid angle";
  }
  return std::nullopt;
}

template <class T>
Complaint judge_failure(const Result<T>& result) {
  if (result || !result.error().message.empty()) return std::nullopt;
  return "an error without a message";
}

// One call of each kind, in the order that the input chooses.
Complaint use(host::Robot& robot, Choices& choices) {
  for (int k = 0; k < 8; ++k) {
    Complaint wrong;
    switch (choices.below(12)) {
      case 0: {
        const auto joints = robot.joints(host::kAllJoints);
        if (!joints) {
          wrong = judge_failure(joints);
          break;
        }
        if (joints->size() != KZ_JOINTS) return "the reply does not contain all joints";
        for (const host::JointDetail& joint : *joints) {
          if (!std::isfinite(joint.angle_rad) || !std::isfinite(joint.duty) ||
              !std::isfinite(joint.speed_rad_per_s) || !std::isfinite(joint.load))
            return "an invalid joint state";
        }
        break;
      }
      case 1: {
        const auto health = robot.health();
        if (health && !(std::isfinite(health->supply_volts) &&
                        std::isfinite(health->temperature_c) && std::isfinite(health->reference)))
          return "an invalid health reading";
        wrong = judge_failure(health);
        break;
      }
      case 2: {
        const auto settings = robot.settings(static_cast<int>(choices.below(KZ_JOINTS)));
        if (settings && !(std::isfinite(settings->gains.kp_per_rad) &&
                          std::isfinite(settings->limits.ramp_rad_per_s)))
          return "invalid settings";
        wrong = judge_failure(settings);
        break;
      }
      case 3:
        wrong = judge_failure(robot.enable(choices.word() & host::kAllJoints));
        break;
      case 4: {
        const host::JointTarget target{0, 0.1};
        const auto posture = robot.exchange({&target, 1}, std::chrono::milliseconds(20));
        wrong = posture ? judge(*posture) : judge_failure(posture);
        break;
      }
      case 5:
        wrong = judge_failure(robot.calibration());
        break;
      case 6:
        wrong = judge_failure(robot.self_test());
        break;
      case 7:
        wrong = judge_failure(robot.board_statistics());
        break;
      case 8:
        wrong = judge_failure(robot.subscribe(std::chrono::milliseconds(20), KZ_TELEMETRY_STATE));
        if (!wrong)
          wrong = judge_failure(
              robot.next_telemetry(robot.clock().now() + std::chrono::milliseconds(50)));
        break;
      case 9:
        wrong = judge_failure(robot.sense_inertial());
        break;
      case 10:
        wrong = judge_failure(robot.read_targets());
        break;
      default: {
        const auto posture = robot.state();
        wrong = posture ? judge(*posture) : judge_failure(posture);
      }
    }
    if (wrong) return wrong;
    (void)robot.take_resumption();
  }
  (void)robot.posture_at(robot.clock().now());
  (void)robot.clock_error();
  (void)robot.recent_frames();
  return std::nullopt;
}

}  // namespace

Complaint try_frames(Bytes bytes) {
  for (const std::vector<std::uint8_t>& wire :
       {std::vector<std::uint8_t>(bytes.begin(), bytes.end()), wire_of(bytes)}) {
    const auto bodies = received(wire);
    if (bodies != deframed(wire))
      return "the receiver and the conformance decoder accept different frames";
    if (bodies != received_by_pieces(wire, bytes.empty() ? 1 : bytes[0]))
      return "the receiver accepts different frames if the bytes arrive in pieces";
    for (const Body& body : bodies) {
      std::uint8_t encoded[KZ_FRAME_MAX];
      const std::uint8_t length =
          kz_frame_encode(body.data(), static_cast<std::uint8_t>(body.size()), encoded);
      if (received({encoded, length}) != std::vector<Body>{body})
        return "a received frame changes when it is encoded and decoded again";
    }
  }
  return std::nullopt;
}

Complaint try_replies(Bytes bytes) {
  Choices choices(bytes);
  host::TestBoard board;
  board.to_host = Hostile(choices);
  host::ConnectOptions options;
  options.reconnect = std::chrono::milliseconds(200);
  {
    auto robot = host::Robot::connect(board, board, options);
    if (!robot) {
      if (robot.error().message.empty()) return "an error without a message";
    } else if (auto wrong = use(*robot, choices)) {
      return wrong;
    }
  }
  // The same board without the one in between.
  board.to_host = nullptr;
  (void)board.sleep_until(board.now() + std::chrono::seconds(1));
  auto robot = host::Robot::connect(board, board, options);
  if (!robot) return "the host cannot connect again: " + robot.error().message;
  const auto posture = robot->state();
  if (!posture) return "the board no longer answers: " + posture.error().message;
  return judge(*posture);
}

Complaint try_raw_picture(Bytes bytes) {
  if (bytes.size() < 8) return std::nullopt;
  host::RawLayout layout;
  layout.format = static_cast<host::PixelFormat>(bytes[0] % 4);
  layout.width = bytes[1] | (bytes[2] & 3) << 8;
  layout.height = bytes[3] | (bytes[4] & 3) << 8;
  layout.bytes_per_line = static_cast<std::size_t>(bytes[5] | bytes[6] << 8);
  layout.yuv = {(bytes[7] & 1) != 0, (bytes[7] & 2) != 0};
  vision::Image image;
  const auto converted = host::convert_picture(bytes.subspan(8), layout, image);
  if (!converted)
    return converted.error().message.empty() ? Complaint("an error without a message")
                                             : std::nullopt;
  if (image.width != layout.width || image.height != layout.height ||
      image.rgb.size() !=
          3 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height))
    return "the converted picture has the wrong size";
  return std::nullopt;
}

}  // namespace kaz::fuzz
