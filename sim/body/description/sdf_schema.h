// Specification of the elements of world files, in the format of libsdformat's own specification.
// SPDX-License-Identifier: Apache-2.0
//
// Before libsdformat parses a world file, libsdformat parses its own specification of all possible elements
// (sensors, physics, actors). For each element, libsdformat then copies all possible children. For this
// reason, a world with only a floor takes 65 ms to load, and a world with ten props takes 130 ms. The
// specification in this header contains only the subset that check_sdf() lets through. With this subset, the
// same worlds load in 1 ms and 7 ms. Each element of the subset has the same attributes, types and defaults
// as in libsdformat's specification. sdf_schema_test.cpp compares the two specifications. `include` refers to
// files of libsdformat.
#pragma once

#include <string>

namespace kaz::sim {

inline constexpr const char* kSdfModelStart = R"(
  <element name="model" required="*">
    <attribute name="name" type="string" default="__default__" required="1"/>
    <attribute name="canonical_link" type="string" default="" required="0"/>
    <attribute name="placement_frame" type="string" default="" required="0"/>
    <element name="static" type="bool" default="false" required="0"/>
    <include filename="pose.sdf" required="0"/>
)";

// Only in worlds with one of these elements.
inline constexpr const char* kSdfJoint = R"(
    <element name="joint" required="*">
      <attribute name="name" type="string" default="__default__" required="1"/>
      <attribute name="type" type="string" default="__default__" required="1"/>
      <element name="parent" type="string" default="__default__" required="1"/>
      <element name="child" type="string" default="__default__" required="1"/>
      <element name="axis" required="0">
        <element name="xyz" type="vector3" default="0 0 1" required="1">
          <attribute name="expressed_in" type="string" default="" required="0"/>
        </element>
        <element name="dynamics" required="0">
          <element name="damping" type="double" default="0" required="0"/>
          <element name="friction" type="double" default="0" required="0"/>
          <element name="spring_reference" type="double" default="0" required="1"/>
          <element name="spring_stiffness" type="double" default="0" required="1"/>
        </element>
        <element name="limit" required="1">
          <element name="lower" type="double" default="-1e16" required="1"/>
          <element name="upper" type="double" default="1e16" required="1"/>
          <element name="effort" type="double" default="-1" required="0"/>
          <element name="velocity" type="double" default="-1" required="0"/>
          <element name="stiffness" type="double" default="1e8" required="0"/>
          <element name="dissipation" type="double" default="1.0" required="0"/>
        </element>
      </element>
      <include filename="pose.sdf" required="0"/>
    </element>
)";
inline constexpr const char* kSdfFrame = R"(<include filename="frame.sdf" required="*"/>)";
inline constexpr const char* kSdfMesh = R"(
            <element name="mesh" required="0">
              <element name="uri" type="string" default="__default__" required="1"/>
              <element name="scale" type="vector3" default="1 1 1" required="0"/>
            </element>
)";
inline constexpr const char* kSdfMask = R"(
              <element name="collide_bitmask" type="unsigned int" default="65535" required="0"/>
)";

inline std::string sdf_geometry_schema(bool plain) {
  return std::string(R"(
          <element name="geometry" required="1">
            <include filename="box_shape.sdf" required="0"/>
            <include filename="capsule_shape.sdf" required="0"/>
            <include filename="cylinder_shape.sdf" required="0"/>
            <include filename="plane_shape.sdf" required="0"/>
            <include filename="sphere_shape.sdf" required="0"/>
)") + (plain ? "" : kSdfMesh) +
         "</element>";
}

inline std::string sdf_link_schema(bool plain) {
  return R"(
      <element name="link" required="*">
        <attribute name="name" type="string" default="__default__" required="1"/>
        <include filename="pose.sdf" required="0"/>
        <include filename="inertial.sdf" required="0"/>
        <element name="collision" required="*">
          <attribute name="name" type="string" default="__default__" required="1"/>
          <include filename="pose.sdf" required="0"/>
)" + sdf_geometry_schema(plain) +
         R"(
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
)" + (plain ? "" : kSdfMask) +
         R"(
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
            <element name="diffuse" type="color" default="0 0 0 1" required="0"/>
          </element>
)" + sdf_geometry_schema(plain) +
         "</element></element>";
}

// Returns the specification of a model with models nested up to `nesting` levels.
inline std::string sdf_model_schema(bool plain, int nesting) {
  std::string text = kSdfModelStart;
  if (!plain) text += std::string(kSdfJoint) + kSdfFrame;
  text += sdf_link_schema(plain);
  if (nesting > 0) text += sdf_model_schema(plain, nesting - 1);
  return text + "</element>";
}

// Returns the specification of a world, and of a file with a model. `plain`: without joints, frames, meshes
// and masks, which would make each world slower to load.
inline std::string sdf_schema(bool plain, int nesting) {
  const std::string model = sdf_model_schema(plain, nesting);
  return R"(
<element name="sdf" required="1">
  <attribute name="version" type="string" default="1.9" required="1"/>
  <element name="world" required="*">
    <attribute name="name" type="string" default="__default__" required="1"/>
    <element name="gravity" type="vector3" default="0 0 -9.8" required="1"/>
)" + (plain ? "" : std::string(kSdfFrame)) +
         model + "</element>" + (plain ? "" : model) + "</element>";
}

}  // namespace kaz::sim
