// Channels, schemas and messages of the recording.
// SPDX-License-Identifier: Apache-2.0
//
// ROS 1 encoding (fields in order, little-endian, no padding), which viewers decode with the schema text in
// the file.
#include "sim/runtime/simulation/recorder.h"

#include <algorithm>
#include <array>
#include <utility>

#include "sim/runtime/formats/little_endian.h"
#include "sim/runtime/formats/mcap_reader.h"
#include "sim/runtime/time.h"

namespace kaz::sim {
namespace {

constexpr char wire_schema[] =
    "# Bytes whose last stop bit passed within one millisecond, which ends at the message's time.\n"
    "uint8[] value\n"
    "uint16[] state  # crystal periods from the beginning of that millisecond to the stop bit\n"
    "uint8[] framing_error\n";
constexpr char pins_schema[] =
    "# High counts out of 256 of the PWM pins, levels of the ports without multiplexer selects.\n"
    "uint16[16] pw\nuint16[2] tmo\nuint8 p3\nuint8 p4\nuint8 p5\nuint8 p6\n";
constexpr char analog_schema[] =
    "# A/D codes 0..1023 of one tick of the firmware, by multiplexer * 8 + input.\n"
    "uint32 tick\nuint16[24] code\n";
constexpr char joints_schema[] =
    "# True joint states, by joint number: rad, Nm, temperature of the motor's winding.\n"
    "float64[18] angle\nfloat64[18] torque\nfloat64[18] winding_celsius\n";
constexpr char point_schema[] = "# World frame, m.\nfloat64 x\nfloat64 y\nfloat64 z\n";
constexpr char supply_schema[] =
    "# What the board's supply gives, and what the motors draw from it.\n"
    "float64 volts\nfloat64 amperes\n";
constexpr char contacts_schema[] =
    "# Where shapes touch: every 10 ms, the contacts of the millisecond that ends then.\n"
    "kaz/Contact[] contacts\n"
    "================================================================================\n"
    "MSG: kaz/Contact\n"
    "string a\nstring b\n"
    "float64[3] at     # world frame, m\n"
    "float64[3] force  # on a, N\n";
constexpr char link_forces_schema[] =
    "# What everything but the robot itself does to its links, mean of the millisecond that ends\n"
    "# then; of the links that touch something. In the link's axes.\n"
    "kaz/LinkForce[] links\n"
    "================================================================================\n"
    "MSG: kaz/LinkForce\n"
    "string link\n"
    "float64[3] force   # N\n"
    "float64[3] moment  # Nm, about the link's origin\n"
    "float64[3] centre  # of pressure, in the link's frame, m\n"
    "float64 pressure   # sum of the normal forces, N\n";
constexpr char joint_loads_schema[] =
    "# What each joint bears, from parent to child, by joint number, three numbers each: every\n"
    "# 10 ms, of the millisecond that ends then. At the joint's origin, in the child's axes; "
    "along\n"
    "# the joint's axis the moment is motor and stop.\n"
    "float64[54] force   # N\n"
    "float64[54] moment  # Nm\n";
constexpr char eyes_schema[] =
    "# SHA-256 of the RGB bytes of a stereo pair; the message's time is the exposure.\n"
    "uint64 sequence\nstring left_sha256\nstring right_sha256\n";
// As ROS has it, so that viewers show the pictures.
constexpr char picture_schema[] =
    "# As the host gets it, rectified; 8-bit RGB without loss. The message's time is its arrival\n"
    "# at the host, the stamp its exposure, seq the pair's number.\n"
    "std_msgs/Header header\nstring format\nuint8[] data\n"
    "================================================================================\n"
    "MSG: std_msgs/Header\n"
    "uint32 seq\ntime stamp\nstring frame_id\n";
constexpr char fault_schema[] = "# A fault that begins, or was asked for.\nstring line\n";
constexpr char behavior_schema[] = R"({"type": "object"})";

}  // namespace

Result<std::unique_ptr<Recorder>> Recorder::create(const std::string& path,
                                                   const McapWriter::Metadata& facts) {
  auto file = KAZ_TRY(McapWriter::create(path, "kaz"));
  file->add_metadata("kaz", facts);
  return std::unique_ptr<Recorder>(new Recorder(std::move(file)));
}

Recorder::Recorder(std::unique_ptr<McapWriter> file) : file_(std::move(file)) {
  const auto numbers = [this](const char* topic, std::uint16_t schema) {
    return file_->add_channel(schema, topic, "ros1");
  };
  const auto wire_bytes = file_->add_schema("kaz/WireBytes", "ros1msg", wire_schema);
  to_board_ = numbers("/wire/to_board", wire_bytes);
  to_host_ = numbers("/wire/to_host", wire_bytes);
  pins_ = numbers("/board/pins", file_->add_schema("kaz/Pins", "ros1msg", pins_schema));
  analog_ = numbers("/board/analog", file_->add_schema("kaz/Analog", "ros1msg", analog_schema));
  joints_ = numbers("/truth/joints", file_->add_schema("kaz/Joints", "ros1msg", joints_schema));
  ball_ = numbers("/truth/ball", file_->add_schema("kaz/Point", "ros1msg", point_schema));
  supply_ = numbers("/board/supply", file_->add_schema("kaz/Supply", "ros1msg", supply_schema));
  contacts_ =
      numbers("/truth/contacts", file_->add_schema("kaz/Contacts", "ros1msg", contacts_schema));
  link_forces_ = numbers("/truth/link_forces",
                         file_->add_schema("kaz/LinkForces", "ros1msg", link_forces_schema));
  joint_loads_ = numbers("/truth/joint_loads",
                         file_->add_schema("kaz/JointLoads", "ros1msg", joint_loads_schema));
  eyes_ = numbers("/eyes", file_->add_schema("kaz/StereoDigest", "ros1msg", eyes_schema));
  const auto pictures = file_->add_schema("sensor_msgs/CompressedImage", "ros1msg", picture_schema);
  left_eye_ = numbers("/eyes/left", pictures);
  right_eye_ = numbers("/eyes/right", pictures);
  behavior_ = file_->add_channel(file_->add_schema("kaz/Behavior", "jsonschema", behavior_schema),
                                 "/behavior", "json");
  faults_ = numbers("/faults", file_->add_schema("kaz/Fault", "ros1msg", fault_schema));
}

void Recorder::put(std::uint16_t channel, Time time) {
  file_->add_message(channel, static_cast<std::uint64_t>(time.count()), data_);
}

void Recorder::wire(Direction direction, States step_start, std::span<const SerialByte> bytes) {
  if (bytes.empty()) return;
  data_.clear();
  LittleEndian to(data_);
  const auto count = static_cast<std::uint32_t>(bytes.size());
  to.number(count);
  for (const SerialByte& byte : bytes) to.number(byte.value);
  to.number(count);
  for (const SerialByte& byte : bytes) to.number(static_cast<std::uint16_t>(byte.at - step_start));
  to.number(count);
  for (const SerialByte& byte : bytes) to.number(static_cast<std::uint8_t>(byte.framing_error));
  put(direction == Direction::to_board ? to_board_ : to_host_,
      time_of(step_start + KZ_STATES_PER_TICK));
}

void Recorder::pins(States at, const PinLevels& pins) {
  data_.clear();
  LittleEndian to(data_);
  for (const std::uint16_t counts : pins.pw) to.number(counts);
  for (const std::uint16_t counts : pins.tmo) to.number(counts);
  const auto p4 = static_cast<std::uint8_t>(pins.p4 & ~KZ_P4_MUX_MASK);
  to.number(pins.p3).number(p4).number(pins.p5).number(pins.p6);
  put(pins_, time_of(at));
}

void Recorder::analog(States at, const kz_tick_input& input) {
  data_.clear();
  LittleEndian to(data_);
  to.number(std::uint32_t{input.tick});
  for (const u16 code : input.analog) to.number(std::uint16_t{code});
  put(analog_, time_of(at));
}

void Recorder::joints(States at, std::span<const JointState, KZ_JOINTS> joints) {
  data_.clear();
  std::array<double, 3 * KZ_JOINTS> values{};
  for (std::size_t j = 0; j < KZ_JOINTS; ++j) {
    values[j] = joints[j].angle;
    values[KZ_JOINTS + j] = joints[j].torque;
    values[2 * KZ_JOINTS + j] = joints[j].winding_celsius;
  }
  LittleEndian(data_).reals(values);
  put(joints_, time_of(at));
}

void Recorder::ball(States at, const Eigen::Vector3d& position) {
  data_.clear();
  LittleEndian(data_).real(position.x()).real(position.y()).real(position.z());
  put(ball_, time_of(at));
}

void Recorder::supply(States at, double volts, double amperes) {
  data_.clear();
  LittleEndian(data_).real(volts).real(amperes);
  put(supply_, time_of(at));
}

void Recorder::contacts(States at, std::span<const ContactPoint> points) {
  data_.clear();
  LittleEndian to(data_);
  to.number(static_cast<std::uint32_t>(points.size()));
  for (const ContactPoint& point : points) {
    to.text(point.a).text(point.b);
    to.reals({point.at.data(), 3}).reals({point.force.data(), 3});
  }
  put(contacts_, time_of(at));
}

void Recorder::link_forces(States at, std::span<const std::string> names,
                           std::span<const LinkForce> links) {
  data_.clear();
  LittleEndian to(data_);
  const auto touches = [](const LinkForce& link) { return link.pressure > 0; };
  to.number(static_cast<std::uint32_t>(std::ranges::count_if(links, touches)));
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (!touches(links[i])) continue;
    to.text(names[i]);
    for (const Eigen::Vector3d* v : {&links[i].force, &links[i].moment, &links[i].centre})
      to.reals({v->data(), 3});
    to.real(links[i].pressure);
  }
  put(link_forces_, time_of(at));
}

void Recorder::joint_loads(States at, std::span<const JointLoad, KZ_JOINTS> loads) {
  data_.clear();
  LittleEndian to(data_);
  for (const JointLoad& load : loads) to.reals({load.force.data(), 3});
  for (const JointLoad& load : loads) to.reals({load.moment.data(), 3});
  put(joint_loads_, time_of(at));
}

void Recorder::eyes(const Eyes::Digest& digest) {
  data_.clear();
  LittleEndian(data_).number(digest.sequence).text(digest.kept.left).text(digest.kept.right);
  put(eyes_, digest.exposure);
  picture(left_eye_, "left_eye", digest, digest.kept.left_png);
  picture(right_eye_, "right_eye", digest, digest.kept.right_png);
}

void Recorder::picture(std::uint16_t channel, const char* eye, const Eyes::Digest& digest,
                       std::span<const std::uint8_t> png) {
  if (png.empty()) return;
  constexpr std::int64_t second = 1'000'000'000;
  const std::int64_t stamp = digest.exposure.count();
  data_.clear();
  LittleEndian(data_)
      .number(static_cast<std::uint32_t>(digest.sequence))
      .number(static_cast<std::uint32_t>(stamp / second))
      .number(static_cast<std::uint32_t>(stamp % second))
      .text(eye)
      .text("png")
      .number(static_cast<std::uint32_t>(png.size()))
      .bytes(png);
  put(channel, digest.arrival);
}

void Recorder::behavior(States at, std::string_view json) {
  data_.assign(json.begin(), json.end());
  put(behavior_, time_of(at));
}

void Recorder::fault(States at, std::string_view line) {
  data_.clear();
  LittleEndian(data_).text(std::string(line));
  put(faults_, time_of(at));
}

void Recorder::interrupted(const std::string& by) {
  file_->add_metadata("end", {{McapRecording::kInterrupted, by}});
}

}  // namespace kaz::sim
