// Fuzz targets for all external inputs except those of vision and of the emulator, which have their own.
// tools/fuzz/targets.txt lists all targets with the parsers that they drive.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/fuzz/target.h"

namespace kaz::fuzz {

// Files on the command line (bodies.cpp, files.cpp).
Complaint try_robot(Bytes bytes);        // URDF
Complaint try_world(Bytes bytes);        // SDF
Complaint try_motor(Bytes bytes);        // motor.xml; written and read again
Complaint try_sensors(Bytes bytes);      // sensors.xml
Complaint try_mesh(Bytes bytes);         // OBJ or STL, chosen by the first byte
Complaint try_camera_file(Bytes bytes);  // camera.json
Complaint try_faults(Bytes bytes);       // fault schedules; written and read again
Complaint try_memory(Bytes bytes);       // a board's memory; the native board then runs with it
Complaint try_state(Bytes bytes);        // a saved state: facts and parts
Complaint try_flash_image(Bytes bytes);  // S-record, Intel HEX, COFF, ELF, as read by kaz flash
Complaint try_arguments(Bytes bytes);    // addresses and lists on the command line

// Results that programs read back (reports.cpp, kept.cpp, recording.cpp).
Complaint try_bench_report(Bytes bytes);  // result.json of kaz bench; written and read again
Complaint try_bench_limits(Bytes bytes);
Complaint try_balance(Bytes bytes);    // weights of a balance policy; one step with them
Complaint try_servo_log(Bytes bytes);  // a servo's log; written and read again
Complaint try_episodes(Bytes bytes);   // an episode of kaz evaluate
Complaint try_kept(Bytes bytes);       // notes of a run that alters a board; written and read again
Complaint try_output_list(Bytes bytes);  // a folder's list of results; written and read again
Complaint try_recording(Bytes bytes);    // MCAP, and its decoding by kaz replay

// Lines and sockets (wire.cpp, flash.cpp, sockets.cpp).
Complaint try_frames(Bytes bytes);         // the receiver, compared with the one of conformance
Complaint try_replies(Bytes bytes);        // a hostile board for the host's Robot
Complaint try_flash_replies(Bytes bytes);  // a hostile board for kaz flash: boot mode and writer
Complaint try_camera_stream(Bytes bytes);  // a hostile publisher of a camera stream
Complaint try_raw_picture(Bytes bytes);    // pictures of a V4L2 camera
Complaint try_clock(Bytes bytes);          // another machine's clock, for kaz sim
Complaint try_control(Bytes bytes);        // the control socket of kaz sim with a motor stand
Complaint try_control_reply(Bytes bytes);  // hostile replies of that socket to the host

// Buses and networks (links.cpp, ports.cpp).
Complaint try_can(Bytes bytes);         // ISO-TP messages and error frames
Complaint try_telnet(Bytes bytes);      // RFC 2217, both ends
Complaint try_boards(Bytes bytes);      // files of boards
Complaint try_serve_port(Bytes bytes);  // a hostile client of kaz serve-port
Complaint try_rfc2217(Bytes bytes);     // a hostile server of RFC 2217 for the host

// Servo buses (servo_bus.cpp).
Complaint try_servo_bus(Bytes bytes);    // a hostile host for a virtual servo
Complaint try_bus_file(Bytes bytes);     // bus.json
Complaint try_bus_answers(Bytes bytes);  // hostile servos for the host
Complaint try_poses(Bytes bytes);        // files of poses

// Viewers of a run (viewers.cpp).
Complaint try_entry(Bytes bytes);   // HTTP requests for a file or a WebSocket
Complaint try_viewer(Bytes bytes);  // requests of viewers; messages of a played recording

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
                                           {"episodes", try_episodes},
                                           {"kept", try_kept},
                                           {"output_list", try_output_list},
                                           {"recording", try_recording},
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
