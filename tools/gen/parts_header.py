#!/usr/bin/env python3
# Writes the parameters of motor and sensors as a C++ header, for programs without an XML parser.
# SPDX-License-Identifier: Apache-2.0
"""usage: parts_header.py MOTOR_XML SENSORS_XML HEADER

The default motor of MOTOR_XML and the sensors of SENSORS_XML, as functions motor_params(), sensor_params().
Numbers are copied as they are written; a unit is a factor, as in sim/body/description/motor_file.cpp and
sim/board/sensor_file.cpp. A test compares both with what those read.
"""
import os
import re
import sys
from xml.etree import ElementTree

DEGREE = "(std::numbers::pi / 180)"
# Element of a motor -> member of MotorParams, unit.
MOTOR = {
    "stall_slope": ("stall_slope_nm_per_v", ""), "friction": ("friction_nm", ""),
    "back_emf": ("back_emf_nms_per_rad", ""), "stiction_ratio": ("stiction_ratio", ""),
    "rotor_inertia": ("rotor_inertia_kgm2", ""), "max_supply": ("max_supply_v", ""),
    "backlash_degrees": ("backlash_rad", DEGREE), "winding_heat_capacity": ("winding_heat_capacity", ""),
    "winding_to_case": ("winding_to_case", ""), "case_heat_capacity": ("case_heat_capacity", ""),
    "case_to_air": ("case_to_air", ""), "copper_per_kelvin": ("copper_per_kelvin", ""),
    "air_celsius": ("air_celsius", ""),
}
# Element of the sensors' file -> member of SensorParams, unit. The board option `imu` is not fitted here.
SENSORS = {
    "potentiometer/noise": ("potentiometer.noise_codes", ""),
    "potentiometer/linearity": ("potentiometer.linearity", ""),
    "potentiometer/mounting": ("potentiometer.mounting_rad", DEGREE),
    "potentiometer/terminal": ("potentiometer.terminal_rad", DEGREE),
    "potentiometer/open_level": ("potentiometer.open_level", ""),
    "supply/noise": ("supply.noise_codes", ""), "reference/noise": ("reference.noise_codes", ""),
    "driver_temperature/noise": ("driver.noise_codes", ""),
    "driver_temperature/ambient": ("driver.ambient_celsius", ""),
    "driver_temperature/bridge_drop": ("driver.drop_volts", ""),
    "driver_temperature/thermal_resistance": ("driver.kelvin_per_watt", ""),
    "driver_temperature/time_constant": ("driver.time_constant_s", ""),
}
LEFT_OUT = {"gyro", "accelerometer"}
NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")


class Refused(Exception):
    """One sentence with the file."""


def elements(path, root):
    try:
        top = ElementTree.parse(path).getroot()
    except (OSError, ElementTree.ParseError) as error:
        raise Refused(f"{path}: {error}") from None
    if top.tag != root:
        raise Refused(f"{path}: the root element is <{top.tag}>, not <{root}>")
    return top


def assignment(path, name, element, table):
    if name not in table:
        raise Refused(f"{path}: <{name}> has no member in tools/gen/parts_header.py")
    value = element.get("value", "").strip()
    if not NUMBER.fullmatch(value):
        raise Refused(f"{path}: the value of <{name}> is no number: '{value}'")
    member, unit = table[name]
    return f"  params.{member} = {value}{f' * {unit}' if unit else ''};"


def motor_lines(path):
    top = elements(path, "motors")
    motors = {motor.get("name"): motor for motor in top.findall("motor")}
    name = top.get("default")
    values, chain = {}, name
    while chain is not None:  # a variant's own values come first
        if chain not in motors:
            raise Refused(f"{path}: there is no motor '{chain}'")
        motor = motors.pop(chain)
        for element in motor:
            values.setdefault(element.tag, element)
        chain = motor.get("based_on")
    return [f'  params.name = "{name}";',
            *(assignment(path, tag, element, MOTOR) for tag, element in values.items())]


def sensor_lines(path):
    return [assignment(path, f"{section.tag}/{element.tag}", element, SENSORS)
            for section in elements(path, "sensors") if section.tag not in LEFT_OUT for element in section]


def function(kind, name, lines):
    return [f"inline sim::{kind} {name}() {{", f"  sim::{kind} params;", *lines, "  return params;", "}"]


def header(motor, sensors):
    return "\n".join([
        "// Parameters of motor and sensors, made by tools/gen/parts_header.py.", "#pragma once", "",
        "#include <numbers>", "", '#include "sim/board/sensor_file.h"',
        '#include "sim/body/description/motor_file.h"', "", "namespace kaz::board_page {", "",
        *function("MotorParams", "motor_params", motor_lines(motor)), "",
        *function("SensorParams", "sensor_params", sensor_lines(sensors)), "",
        "}  // namespace kaz::board_page", ""])


def main(arguments):
    if len(arguments) != 3:
        print(__doc__, file=sys.stderr)
        return 2
    try:
        text = header(*arguments[:2])
        with open(arguments[2] + ".new", "w", encoding="utf-8") as out:
            out.write(text)
        os.replace(arguments[2] + ".new", arguments[2])
    except (Refused, OSError) as error:
        print(f"parts_header.py: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
