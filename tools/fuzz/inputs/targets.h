// Fuzz targets for all external inputs, except inputs of vision and of the emulator. tools/fuzz/targets.txt
// lists all targets with the parsers that each target tests.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/fuzz/target.h"

namespace kaz::fuzz {

// Files on the command line (bodies.cpp, files.cpp).
Complaint try_robot(Bytes bytes);        // URDF, MJCF
Complaint try_world(Bytes bytes);        // SDF
Complaint try_motor(Bytes bytes);        // motor.xml; a valid input is also written and read again
Complaint try_sensors(Bytes bytes);      // sensors.xml
Complaint try_mesh(Bytes bytes);         // OBJ, STL or COLLADA, chosen by the first byte
Complaint try_camera_file(Bytes bytes);  // camera.json
// Fault schedules; a valid input is also written and read again.
Complaint try_faults(Bytes bytes);
// A board's memory; the native board then runs with this memory.
Complaint try_memory(Bytes bytes);
Complaint try_state(Bytes bytes);  // a saved state: facts and parts
// S-record, Intel HEX, COFF and ELF files, as read by `kaz flash`.
Complaint try_flash_image(Bytes bytes);
Complaint try_arguments(Bytes bytes);  // addresses and lists on the command line

// Files of results that programs read again (reports.cpp, kept.cpp, recording.cpp).
// Report (result.json) of `kaz bench`; a valid input is also written and read again.
Complaint try_bench_report(Bytes bytes);
Complaint try_bench_limits(Bytes bytes);
Complaint try_balance(Bytes bytes);  // weights of a balance policy; the policy then runs one step
// Log of a servo; a valid input is also written and read again.
Complaint try_servo_log(Bytes bytes);
// File of an identified servo; a valid input is also written and read again.
Complaint try_servo_file(Bytes bytes);
Complaint try_episodes(Bytes bytes);  // episode file of `kaz evaluate`
// Notes of a run that changes a board; a valid input is also written and read again.
Complaint try_kept(Bytes bytes);
Complaint try_recording(Bytes bytes);  // MCAP file, and its decoding by `kaz replay`
Complaint try_can_log(Bytes bytes);    // candump log, and the comparison of its answers (can_logs.cpp)

// Lines and sockets (wire.cpp, flash.cpp, sockets.cpp).
// Receiver of frames, compared with the receiver of the conformance tests.
Complaint try_frames(Bytes bytes);
// Replies of a hostile board to the class Robot of the host.
Complaint try_replies(Bytes bytes);
// Replies of a hostile board to `kaz flash`: boot mode and writer.
Complaint try_flash_replies(Bytes bytes);
Complaint try_camera_stream(Bytes bytes);  // bytes from a hostile publisher of a camera stream
Complaint try_raw_picture(Bytes bytes);    // raw pictures of a V4L2 camera
Complaint try_clock(Bytes bytes);          // messages with another machine's clock to `kaz sim`
// Requests to the control socket of `kaz sim` with a motor stand.
Complaint try_control(Bytes bytes);
Complaint try_control_reply(Bytes bytes);  // hostile replies of the control socket to the host

// Buses and networks (links.cpp, ports.cpp).
Complaint try_can(Bytes bytes);         // ISO-TP messages and error frames
Complaint try_telnet(Bytes bytes);      // RFC 2217 bytes to both ends
Complaint try_boards(Bytes bytes);      // files for `--robot boards:FILE`
Complaint try_serve_port(Bytes bytes);  // bytes from a hostile client to `kaz serve-port`
Complaint try_rfc2217(Bytes bytes);     // bytes from a hostile RFC 2217 server to the host

// Servo buses (servo_bus.cpp).
Complaint try_servo_bus(Bytes bytes);    // bytes from a hostile host to a virtual servo
Complaint try_bus_file(Bytes bytes);     // bus.json
Complaint try_bus_answers(Bytes bytes);  // bytes from hostile servos to the host
Complaint try_poses(Bytes bytes);        // files of poses

// Viewers of a run (viewers.cpp).
Complaint try_entry(Bytes bytes);   // HTTP requests for a file or a WebSocket
Complaint try_viewer(Bytes bytes);  // requests of viewers, and messages of a played recording

inline constexpr Target kInputTargets[] = {{"robot", try_robot},
                                           {"world", try_world},
                                           {"motor", try_motor},
                                           {"sensors", try_sensors},
                                           {"mesh", try_mesh},
                                           {"camera_file", try_camera_file},
                                           {"faults", try_faults},
                                           {"memory", try_memory},
                                           {"state", try_state},
                                           {"flash_image", try_flash_image},
                                           {"arguments", try_arguments},
                                           {"bench_report", try_bench_report},
                                           {"bench_limits", try_bench_limits},
                                           {"balance", try_balance},
                                           {"servo_log", try_servo_log},
                                           {"servo_file", try_servo_file},
                                           {"episodes", try_episodes},
                                           {"kept", try_kept},
                                           {"recording", try_recording},
                                           {"can_log", try_can_log},
                                           {"frames", try_frames},
                                           {"replies", try_replies},
                                           {"flash_replies", try_flash_replies},
                                           {"camera_stream", try_camera_stream},
                                           {"raw_picture", try_raw_picture},
                                           {"clock", try_clock},
                                           {"control", try_control},
                                           {"control_reply", try_control_reply},
                                           {"can", try_can},
                                           {"telnet", try_telnet},
                                           {"boards", try_boards},
                                           {"serve_port", try_serve_port},
                                           {"rfc2217", try_rfc2217},
                                           {"servo_bus", try_servo_bus},
                                           {"bus_file", try_bus_file},
                                           {"bus_answers", try_bus_answers},
                                           {"poses", try_poses},
                                           {"entry", try_entry},
                                           {"viewer", try_viewer}};

}  // namespace kaz::fuzz
