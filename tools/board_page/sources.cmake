# What the board in a page is made of besides kaz::h8s: for the libraries of the tree, and for emscripten's build.
# SPDX-License-Identifier: Apache-2.0
set(board_page_sources script.cpp session.cpp view.cpp)
# Of the tree, the few sources that need no library: those of the folders as a whole need ODE, libsdformat, OpenCV.
set(board_page_tree_sources
  shared/board/table.c
  shared/faults/faults.cpp shared/faults/link_faults.cpp
  shared/protocol/crc16.c shared/protocol/frame.c shared/protocol/frame_encode.c
  shared/servo/fields.c shared/servo/status.c
  sim/board/imu.cpp sim/board/potentiometer.cpp sim/board/servo_board.cpp
  sim/body/description/joint_names.cpp sim/body/motor/joint_motor.cpp
  sim/mcu/h8_layout.cpp sim/mcu/h8_mcu.cpp
  sim/runtime/simulation/serial_line.cpp
  sim/stand/motor_stand.cpp)
