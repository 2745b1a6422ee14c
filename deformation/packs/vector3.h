// Vectors of space, as many side by side as an instruction set has lanes. A `Set` is Floats or
// Doubles of the <set>_packs.h, kWidth lanes:
//
//   Pack                        kWidth numbers with + − * / elementwise
//   load, store, broadcast      a Pack from and to memory
//   fma(a, b, c), fnma(a, b, c) c + a b and c − a b, rounded once where the CPU can
//   larger(a, b, yes, no)       yes where a > b, else no
//   root(Pack)                  elementwise
//
// Of the Floats further, a quad being four floats:
//   load_nodes(base, offsets)   x, y, z of kWidth packed nodes
//   load_pairs(base, offsets)   both vectors of kWidth packed nodes
//   bits(pack), of_bits(bits)   as unsigned integers
//   absolute(Pack)              elementwise
//   store_nodes(base, nodes)    of kWidth consecutive nodes of four floats, the fourth 0
//   pack_node(from, origin, to) one vector of a packed node
//   gather_quads(base, offsets) kWidth / 4 quads side by side
//   add_quads(base, offsets, p) adds them, one after the other
//   transpose(a, b, c, d)       each four lanes of the four: rows to columns
//   fold(packs)                 (q0 + q2) + (q1 + q3) of the four quads of sixteen lanes
// and of Doubles
//   load_nodes(base, offsets)   x, y, z of kWidth nodes of three doubles each
//   store_nodes(base, nodes)    of kWidth consecutive nodes
//   load_quads(base, offsets)   the four numbers of kWidth nodes of four doubles each
//   widen(from), narrow(to, p)  kWidth floats
//   any_larger(a, b)            whether a > b in any lane
#pragma once

namespace palpate::deformation::kernel {
namespace {

template <class Set>
struct Vector3 {
  typename Set::Pack x, y, z;
};

template <class Set>
struct Vector4 {
  typename Set::Pack x, y, z, w;
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
