// Baud rates of serial ports and their termios codes, for hosts and virtual ports.
// SPDX-License-Identifier: Apache-2.0
#ifndef KAZ_SHARED_BASE_SERIAL_RATES_HPP
#define KAZ_SHARED_BASE_SERIAL_RATES_HPP

#include <termios.h>

namespace kaz {

struct SerialRate {
  int baud;
  speed_t code;  // for cfsetspeed()
};

// Both ends of a pty share this list, so that a virtual port recognizes each rate that a host can set.
inline constexpr SerialRate kSerialRates[] = {
    {1200, B1200},     {2400, B2400},     {4800, B4800},     {9600, B9600},      {19200, B19200},
    {38400, B38400},   {57600, B57600},   {115200, B115200}, {230400, B230400},  {460800, B460800},
    {500000, B500000}, {576000, B576000}, {921600, B921600}, {1000000, B1000000}};

}  // namespace kaz

#endif
