// Owning handles of ODE's objects, and conversions between the vectors of ODE and Eigen.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <type_traits>

#include <ode/ode.h>
#include <Eigen/Geometry>

namespace kaz::sim {

// Initializes ODE for the calling thread. Call before any use of ODE in a thread; further calls have no
// effect.
void enter_ode();

template <auto Destroy>
struct OdeDelete {
  template <class T>
  void operator()(T* object) const {
    Destroy(object);
  }
};

// Destroying an ODE world destroys its bodies and joints. Shapes attached to bodies must be destroyed before
// the world.
using OdeWorldHandle = std::unique_ptr<dxWorld, OdeDelete<dWorldDestroy>>;
// ODE's threading implementation, which runs the steps of a world. Each world has its own implementation,
// because ODE's default implementation is shared by all worlds and cannot run two steps at a time.
using OdeThreadingHandle =
    std::unique_ptr<dxThreadingImplementation, OdeDelete<dThreadingFreeImplementation>>;
using OdeGeomHandle = std::unique_ptr<dxGeom, OdeDelete<dGeomDestroy>>;
using OdeJointGroupHandle = std::unique_ptr<dxJointGroup, OdeDelete<dJointGroupDestroy>>;

inline Eigen::Vector3d to_eigen(const dReal* v) {
  return {v[0], v[1], v[2]};
}

// ODE stores a rotation matrix as 3 rows of 4 numbers.
inline Eigen::Matrix3d rotation_to_eigen(const dReal* r) {
  return Eigen::Map<const Eigen::Matrix<dReal, 3, 4, Eigen::RowMajor>>(r).leftCols<3>();
}

inline void to_ode(const Eigen::Matrix3d& rotation, dMatrix3 out) {
  Eigen::Map<Eigen::Matrix<dReal, 3, 4, Eigen::RowMajor>> to(out);
  to.setZero();
  to.leftCols<3>() = rotation;
}

}  // namespace kaz::sim
