#pragma once

#include "modules/core/state_archive.h"
#include "modules/core/types.h"

namespace palpate::haptics {

/// Force and torque on the probe, in W [N, N·m]; torque about the probe's origin.
struct Wrench {
  Vec3 force = Vec3::Zero();
  Vec3 torque = Vec3::Zero();

  bool is_finite() const { return force.allFinite() && torque.allFinite(); }
  bool is_zero() const { return force.isZero(0) && torque.isZero(0); }
  bool operator==(const Wrench&) const = default;
  void exchange(StateArchive& archive) { archive(force, torque); }
};

inline Wrench operator+(const Wrench& a, const Wrench& b) {
  return {a.force + b.force, a.torque + b.torque};
}
inline Wrench operator-(const Wrench& a, const Wrench& b) {
  return {a.force - b.force, a.torque - b.torque};
}
inline Wrench operator*(double factor, const Wrench& w) {
  return {factor * w.force, factor * w.torque};
}

}  // namespace palpate::haptics
