// Owners of ODE's objects, and its vectors as Eigen's.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <type_traits>

#include <ode/ode.h>
#include <Eigen/Geometry>

namespace kaz::sim {

// To be called in each thread before ODE is used in it.
void enter_ode();

template <auto Destroy>
struct OdeDelete {
  template <class T>
  void operator()(T* object) const {
    Destroy(object);
  }
};

// Destroying an ODE world destroys its bodies and joints. Shapes on bodies must be gone before.
using OdeWorldHandle = std::unique_ptr<dxWorld, OdeDelete<dWorldDestroy>>;
// What runs a world's step. ODE's own is one for all worlds, and does not stand two of them at a time.
using OdeThreadingHandle =
    std::unique_ptr<dxThreadingImplementation, OdeDelete<dThreadingFreeImplementation>>;
using OdeGeomHandle = std::unique_ptr<dxGeom, OdeDelete<dGeomDestroy>>;
using OdeJointGroupHandle = std::unique_ptr<dxJointGroup, OdeDelete<dJointGroupDestroy>>;

inline Eigen::Vector3d to_eigen(const dReal* v) {
  return {v[0], v[1], v[2]};
}

// ODE's rotation matrices are 3 rows of 4.
inline Eigen::Matrix3d rotation_to_eigen(const dReal* r) {
  return Eigen::Map<const Eigen::Matrix<dReal, 3, 4, Eigen::RowMajor>>(r).leftCols<3>();
}

inline void to_ode(const Eigen::Matrix3d& rotation, dMatrix3 out) {
  Eigen::Map<Eigen::Matrix<dReal, 3, 4, Eigen::RowMajor>> to(out);
  to.setZero();
  to.leftCols<3>() = rotation;
}

}  // namespace kaz::sim
