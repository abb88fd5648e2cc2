// Files of text: motors, sensors, cameras, faults.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "host/motion/pose_sequence.h"
#include "shared/faults/faults.h"
#include "sim/board/sensor_file.h"
#include "sim/body/description/motor_file.h"
#include "sim/runtime/eyes/eyes.h"
#include "tools/fuzz/inputs/input.h"
#include "tools/fuzz/inputs/targets.h"

namespace kaz::fuzz {
namespace {

bool finite(const sim::MotorParams& m) {
  for (const double value :
       {m.stall_slope_nm_per_v, m.friction_nm, m.back_emf_nms_per_rad, m.stiction_ratio,
        m.rotor_inertia_kgm2, m.max_supply_v, m.backlash_rad, m.winding_heat_capacity,
        m.winding_to_case, m.case_heat_capacity, m.case_to_air, m.copper_per_kelvin, m.air_celsius,
        m.torque_constant(), m.resistance_ohm()}) {
    if (!std::isfinite(value)) return false;
  }
  return m.stall_slope_nm_per_v > 0 && m.back_emf_nms_per_rad > 0 && m.rotor_inertia_kgm2 > 0 &&
         m.max_supply_v > 0 && m.friction_nm >= 0 && m.stiction_ratio >= 1;
}

bool valid(const sim::ImuAxisParams& a) {
  for (const double value : {a.share_per_unit, a.zero_offset, a.wander, a.wander_time_s,
                             a.bandwidth_hz, a.noise_density, a.range}) {
    if (!(std::isfinite(value) && value >= 0)) return false;
  }
  return a.wander_time_s > 0 && a.bandwidth_hz > 0;
}

}  // namespace

// Joints of any name are those of a robot that has them, as far as there are numbers.
Complaint try_poses(Bytes bytes) {
  const auto read = motion::parse_poses(text_of(bytes), "poses.json");
  if (!read) return judge_error(read.error(), "poses.json");
  const std::string written = motion::text_of(*read);
  const auto again = motion::parse_poses(written, "written");
  if (again && motion::text_of(*again) != written)
    return "the poses change when they are written and read back";
  std::vector<std::string> joints;
  for (const motion::Pose& pose : read->poses) {
    for (const auto& [name, angle] : pose.angles_rad) {
      if (joints.size() < 18) joints.push_back(name);
    }
  }
  const auto motion = motion::PoseMotion::create(*read, joints);
  if (!motion) return judge_error(motion.error(), "the poses");
  for (const auto& extent : motion->extents()) {
    if (!(extent.fastest_rad_per_s >= 0)) return "an invalid speed";
    for (double time = -1; time < motion->end_s() + 1; time += motion->end_s() / 50 + 0.01) {
      for (const auto& [joint, angle] : motion->at(time)) {
        if (joint != extent.joint) continue;
        if (!(angle >= extent.lowest_rad - 1e-6 && angle <= extent.highest_rad + 1e-6))
          return "an angle outside the range of the poses";
      }
    }
  }
  return std::nullopt;
}

Complaint try_motor(Bytes bytes) {
  const std::string path = input_file(bytes, "motor.xml");
  const auto motor = sim::load_motor_file(path, "");
  if (!motor) return judge_error(motor.error(), path);
  if (!finite(*motor)) return "an invalid motor was read";
  if (motor->servo) return std::nullopt;  // motor_file_text() has no <servo>
  const std::string text = sim::motor_file_text(*motor, "case");
  const auto* first = reinterpret_cast<const std::uint8_t*>(text.data());
  const auto again = sim::load_motor_file(input_file({first, text.size()}, "again.xml"), "");
  if (!again) return "written data cannot be read back: " + again.error().message;
  sim::MotorParams same = *again;
  if (std::abs(same.backlash_rad - motor->backlash_rad) <= 1e-15 * motor->backlash_rad)
    same.backlash_rad = motor->backlash_rad;
  // Without heat capacity the file has no other thermal parameters.
  if (motor->winding_heat_capacity == 0) {
    same.winding_to_case = motor->winding_to_case;
    same.case_heat_capacity = motor->case_heat_capacity;
    same.case_to_air = motor->case_to_air;
    same.copper_per_kelvin = motor->copper_per_kelvin;
  }
  if (same != *motor) return "the motor changes when it is written and read back";
  return std::nullopt;
}

Complaint try_servo_file(Bytes bytes) {
  const auto servo = servo_model::parse_servo_file("servo.json", text_of(bytes));
  if (!servo) return judge_error(servo.error(), "servo.json");
  const servo_model::ServoParams params = servo->params();
  for (const double speed : {0.0, 1.0, -30.0}) {
    const double friction =
        servo_model::friction_limit(servo->model, params, speed, 2, -1, speed == 0);
    if (!(friction >= 0 && std::isfinite(friction))) return "an invalid friction";
  }
  const std::string text = servo_model::servo_file_text(*servo);
  const auto again = servo_model::parse_servo_file("written", text);
  if (!again) return "written data cannot be read back: " + again.error().message;
  if (servo_model::servo_file_text(*again) != text)
    return "the servo changes when it is written and read back";
  return std::nullopt;
}

Complaint try_sensors(Bytes bytes) {
  const std::string path = input_file(bytes, "sensors.xml");
  const auto sensors = sim::load_sensor_file(path);
  if (!sensors) return judge_error(sensors.error(), path);
  for (const double value :
       {sensors->potentiometer.noise_codes, sensors->potentiometer.linearity,
        sensors->potentiometer.mounting_rad, sensors->potentiometer.terminal_rad,
        sensors->potentiometer.open_level, sensors->supply.noise_codes,
        sensors->reference.noise_codes, sensors->driver.noise_codes, sensors->driver.drop_volts,
        sensors->driver.kelvin_per_watt, sensors->driver.time_constant_s}) {
    if (!(std::isfinite(value) && value >= 0)) return "an invalid sensor was read";
  }
  if (!valid(sensors->gyro) || !valid(sensors->accelerometer))
    return "an inertial sensor is invalid";
  return std::nullopt;
}

Complaint try_camera_file(Bytes bytes) {
  const std::string path = input_file(bytes, "camera.json");
  auto camera = sim::CameraFile::load(path);
  if (!camera) return judge_error(camera.error(), path);
  if (camera->eye.width < 16 || camera->eye.width > 4096 || camera->eye.height < 16 ||
      camera->eye.height > 4096 || !(camera->rate_hz > 0 && camera->rate_hz <= 500) ||
      !(camera->latency_s >= 0 && camera->latency_s <= 1))
    return "a camera with a value out of range was read";
  for (const bool ideal : {true, false}) {
    camera->ideal = ideal;
    const vision::CameraModel m = camera->model();
    if (m.width != camera->eye.width || m.height != camera->eye.height ||
        !(std::isfinite(m.fx) && m.fx > 0 && std::isfinite(m.fy) && m.fy > 0) ||
        !std::isfinite(m.cx) || !std::isfinite(m.cy))
      return "an invalid camera model was read";
  }
  return std::nullopt;
}

Complaint try_faults(Bytes bytes) {
  const auto schedule = faults::Schedule::parse(text_of(bytes), "case");
  if (!schedule) return judge_error(schedule.error(), "case:");
  for (const faults::Fault& fault : schedule->faults()) {
    const faults::Kind& kind = faults::kind_of(fault.name);
    if (!kind.parameter.empty() && !(fault.value >= kind.low && fault.value <= kind.high))
      return "a value outside of its bounds was read: " + faults::text_of(fault);
    if ((kind.target == faults::Target::joint) != (fault.joint >= 0))
      return "a fault has a missing or unexpected joint";
    for (const Time t : {Time::min(), Time(0), Time::max()}) (void)fault.active(t);
  }
  // Nine digits are written: what has more loses them once.
  const auto again = faults::Schedule::parse(schedule->text(), "again");
  if (!again) return "written data cannot be read back: " + again.error().message;
  if (again->text() != schedule->text())
    return "the schedule changes when it is written and read back";
  return std::nullopt;
}

}  // namespace kaz::fuzz
