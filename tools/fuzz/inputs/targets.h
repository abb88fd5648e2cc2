// Every kind of bytes that comes from outside, but those of vision and of the emulator, which have
// targets of their own. tools/fuzz/targets.txt lists all targets with the parsers that they drive.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/fuzz/target.h"

namespace kaz::fuzz {

// Files on the command line (bodies.cpp, files.cpp).
Complaint try_robot(Bytes bytes);        // URDF
Complaint try_world(Bytes bytes);        // SDF
Complaint try_motor(Bytes bytes);        // motor.xml; written and read again
Complaint try_sensors(Bytes bytes);      // sensors.xml
Complaint try_mesh(Bytes bytes);         // first byte: the ending; OBJ, STL
Complaint try_camera_file(Bytes bytes);  // camera.json
Complaint try_faults(Bytes bytes);       // schedules of faults; written and read again
Complaint try_memory(Bytes bytes);       // a board's memory, which the native board then runs on
Complaint try_state(Bytes bytes);        // a saved state: facts and parts
Complaint try_flash_image(Bytes bytes);  // S-record, Intel HEX, COFF, ELF as kaz flash takes them
Complaint try_arguments(Bytes bytes);    // addresses and lists on the command line

// Results that are read back (reports.cpp, kept.cpp, recording.cpp).
Complaint try_bench_report(Bytes bytes);  // result.json of kaz bench; written and read again
Complaint try_bench_limits(Bytes bytes);
Complaint try_balance(Bytes bytes);    // weights of a balance policy; one step with them
Complaint try_servo_log(Bytes bytes);  // a servo's log; written and read again
Complaint try_episodes(Bytes bytes);   // an episode of kaz evaluate
Complaint try_kept(Bytes bytes);       // notes of a run that alters a board; written and read again
Complaint try_output_list(Bytes bytes);  // a folder's list of results; written and read again
Complaint try_recording(Bytes bytes);    // MCAP, and what kaz replay takes out of it

// Lines and sockets (wire.cpp, flash.cpp, sockets.cpp).
Complaint try_frames(Bytes bytes);         // the receiver against the second one of conformance
Complaint try_replies(Bytes bytes);        // a hostile board at the host's Robot
Complaint try_flash_replies(Bytes bytes);  // a hostile board at kaz flash: boot mode and writer
Complaint try_camera_stream(Bytes bytes);  // published cameras, at the reader
Complaint try_raw_picture(Bytes bytes);    // pictures of a V4L2 camera
Complaint try_clock(Bytes bytes);          // another machine's clock, at kaz sim
Complaint try_control(Bytes bytes);        // the control socket of kaz sim, a motor stand behind it
Complaint try_control_reply(Bytes bytes);  // its replies, at the host

// Buses and networks (links.cpp, ports.cpp).
Complaint try_can(Bytes bytes);         // ISO-TP messages and error frames
Complaint try_telnet(Bytes bytes);      // RFC 2217, both ends
Complaint try_boards(Bytes bytes);      // files of boards
Complaint try_serve_port(Bytes bytes);  // a hostile client at kaz serve-port
Complaint try_rfc2217(Bytes bytes);     // a hostile server of RFC 2217, at the host

// Servo buses (servo_bus.cpp).
Complaint try_servo_bus(Bytes bytes);    // a hostile host at a virtual servo
Complaint try_bus_file(Bytes bytes);     // bus.json
Complaint try_bus_answers(Bytes bytes);  // of hostile servos, at the host
Complaint try_poses(Bytes bytes);        // files of poses

// Viewers of a run (viewers.cpp).
Complaint try_entry(Bytes bytes);   // the HTTP request that asks for a file, or to be a viewer
Complaint try_viewer(Bytes bytes);  // requests; messages of a recording that is played

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
