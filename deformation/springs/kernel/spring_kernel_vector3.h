// Vectors of space, as many side by side as an instruction set has lanes; `Set` as in
// spring_kernel_body.h.
#pragma once

namespace palpate::deformation::kernel {
namespace {

template <class Set>
struct Vector3 {
  typename Set::Pack x, y, z;
};

/// The two vectors of packed nodes.
template <class Set>
struct NodePairs {
  Vector3<Set> first, second;
};

template <class Set>
inline Vector3<Set> operator-(const Vector3<Set>& a, const Vector3<Set>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

/// a·b + start
template <class Set>
inline typename Set::Pack dot(const Vector3<Set>& a, const Vector3<Set>& b,
                              const typename Set::Pack& start) {
  return Set::fma(a.x, b.x, Set::fma(a.y, b.y, Set::fma(a.z, b.z, start)));
}

template <class Set>
inline typename Set::Pack dot(const Vector3<Set>& a, const Vector3<Set>& b) {
  return Set::fma(a.x, b.x, Set::fma(a.y, b.y, a.z * b.z));
}

/// sum += s a
template <class Set>
inline void add_scaled(Vector3<Set>& sum, const typename Set::Pack& s, const Vector3<Set>& a) {
  sum.x = Set::fma(s, a.x, sum.x);
  sum.y = Set::fma(s, a.y, sum.y);
  sum.z = Set::fma(s, a.z, sum.z);
}

/// sum += a × b
template <class Set>
inline void add_cross(Vector3<Set>& sum, const Vector3<Set>& a, const Vector3<Set>& b) {
  sum.x = Set::fnma(a.z, b.y, Set::fma(a.y, b.z, sum.x));
  sum.y = Set::fnma(a.x, b.z, Set::fma(a.z, b.x, sum.y));
  sum.z = Set::fnma(a.y, b.x, Set::fma(a.x, b.y, sum.z));
}

}  // namespace
}  // namespace palpate::deformation::kernel
