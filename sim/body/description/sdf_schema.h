// Specification of the elements of world files, in the format of libsdformat's own specification.
// SPDX-License-Identifier: Apache-2.0
//
// Before libsdformat parses a world file, libsdformat parses its own specification of all possible elements
// (sensors, physics, actors). For each element, libsdformat then copies all possible children. For this
// reason, a world with only a floor takes 65 ms to load, and a world with ten props takes 130 ms. The
// specification in this header contains only the subset that check_sdf() accepts. With this subset, the same
// worlds load in 1 ms and 7 ms. Each element of the subset has the same attributes, types and defaults as in
// libsdformat's specification. sdf_schema_test.cpp compares the two specifications. `include` refers to files
// of libsdformat.
#pragma once

namespace kaz::sim {

inline constexpr const char* kSdfSchema = R"(
<element name="sdf" required="1">
  <attribute name="version" type="string" default="1.9" required="1"/>
  <element name="world" required="*">
    <attribute name="name" type="string" default="__default__" required="1"/>
    <element name="gravity" type="vector3" default="0 0 -9.8" required="1"/>
    <element name="model" required="*">
      <attribute name="name" type="string" default="__default__" required="1"/>
      <attribute name="canonical_link" type="string" default="" required="0"/>
      <attribute name="placement_frame" type="string" default="" required="0"/>
      <element name="static" type="bool" default="false" required="0"/>
      <include filename="pose.sdf" required="0"/>
      <element name="link" required="*">
        <attribute name="name" type="string" default="__default__" required="1"/>
        <include filename="pose.sdf" required="0"/>
        <include filename="inertial.sdf" required="0"/>
        <element name="collision" required="*">
          <attribute name="name" type="string" default="__default__" required="1"/>
          <include filename="pose.sdf" required="0"/>
          <element name="geometry" required="1">
            <include filename="box_shape.sdf" required="0"/>
            <include filename="capsule_shape.sdf" required="0"/>
            <include filename="cylinder_shape.sdf" required="0"/>
            <include filename="plane_shape.sdf" required="0"/>
            <include filename="sphere_shape.sdf" required="0"/>
          </element>
          <element name="surface" required="0">
            <element name="bounce" required="0">
              <element name="restitution_coefficient" type="double" default="0"
                       min="0.0" max="1.0" required="0"/>
              <element name="threshold" type="double" default="100000" required="0"/>
            </element>
            <element name="friction" required="0">
              <element name="ode" required="0">
                <element name="mu" type="double" default="1" min="0.0" required="0"/>
              </element>
            </element>
            <element name="contact" required="0">
              <element name="ode" required="0">
                <element name="soft_cfm" type="double" default="0" required="0"/>
              </element>
            </element>
          </element>
        </element>
        <element name="visual" required="*">
          <attribute name="name" type="string" default="__default__" required="1"/>
          <include filename="pose.sdf" required="0"/>
          <element name="material" required="0">
            <element name="ambient" type="color" default="0 0 0 1" required="0"/>
            <element name="diffuse" type="color" default="0 0 0 1" required="0"/>
            <element name="specular" type="color" default="0 0 0 1" required="0"/>
          </element>
          <element name="geometry" required="1">
            <include filename="box_shape.sdf" required="0"/>
            <include filename="capsule_shape.sdf" required="0"/>
            <include filename="cylinder_shape.sdf" required="0"/>
            <include filename="plane_shape.sdf" required="0"/>
            <include filename="sphere_shape.sdf" required="0"/>
          </element>
        </element>
      </element>
    </element>
  </element>
</element>
)";

}  // namespace kaz::sim
