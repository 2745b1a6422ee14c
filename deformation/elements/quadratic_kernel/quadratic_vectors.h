// Vectors of space and quads of memory, as many side by side as an instruction set has lanes. A
// `Set` is Floats of a packs/<set>_packs.h, whose fma() rounds once whatever the CPU, and beside
// that gives
//
//   Number       of which a Pack is
//   join(quads)  kWidth/4 quads side by side
//   Doubles      those of the same file, their load() of floats
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>

namespace palpate::deformation::kernel {
namespace {

using Quad = float __attribute__((vector_size(16)));
using UnalignedQuad = float __attribute__((vector_size(16), aligned(4), may_alias));

template <class Set>
struct Vectors {
  typename Set::Pack x, y, z;
};

template <class Set>
Vectors<Set> operator+(const Vectors<Set>& a, const Vectors<Set>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class Set>
Vectors<Set> operator-(const Vectors<Set>& a, const Vectors<Set>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class Set>
Vectors<Set> operator-(const Vectors<Set>& a) {
  return {-a.x, -a.y, -a.z};
}
template <class Set>
Vectors<Set> operator*(typename Set::Number s, const Vectors<Set>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class Set>
Vectors<Set> scaled(const typename Set::Pack& s, const Vectors<Set>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
/// sum + s a
template <class Set>
Vectors<Set> plus(const Vectors<Set>& sum, const typename Set::Pack& s, const Vectors<Set>& a) {
  return {Set::fma(s, a.x, sum.x), Set::fma(s, a.y, sum.y), Set::fma(s, a.z, sum.z)};
}
template <class Set>
Vectors<Set> plus(const Vectors<Set>& sum, typename Set::Number s, const Vectors<Set>& a) {
  return plus(sum, typename Set::Pack{} + s, a);
}
/// sum + a·b
template <class Set>
typename Set::Pack plus_dot(const typename Set::Pack& sum, const Vectors<Set>& a,
                            const Vectors<Set>& b) {
  return Set::fma(a.z, b.z, Set::fma(a.y, b.y, Set::fma(a.x, b.x, sum)));
}
template <class Set>
typename Set::Pack dot(const Vectors<Set>& a, const Vectors<Set>& b) {
  return Set::fma(a.z, b.z, Set::fma(a.y, b.y, a.x * b.x));
}
template <class Set>
Vectors<Set> cross(const Vectors<Set>& a, const Vectors<Set>& b) {
  return {Set::fnma(a.z, b.y, a.y * b.z), Set::fnma(a.x, b.z, a.z * b.x),
          Set::fnma(a.y, b.x, a.x * b.y)};
}
/// sum + a × b
template <class Set>
Vectors<Set> plus_cross(const Vectors<Set>& sum, const Vectors<Set>& a, const Vectors<Set>& b) {
  return {Set::fnma(a.z, b.y, Set::fma(a.y, b.z, sum.x)),
          Set::fnma(a.x, b.z, Set::fma(a.z, b.x, sum.y)),
          Set::fnma(a.y, b.x, Set::fma(a.x, b.y, sum.z))};
}

template <class Set>
typename Set::Pack larger(const typename Set::Pack& a, const typename Set::Pack& b) {
  return a > b ? a : b;
}
template <class Set>
typename Set::Pack smaller(const typename Set::Pack& a, const typename Set::Pack& b) {
  return a < b ? a : b;
}

/// In every quad of lanes: of its four of `a`, 0 to 3, and of `b`, 4 to 7, those named.
template <class Set, int... of_quad, std::size_t... lanes>
typename Set::Pack shuffled(const typename Set::Pack& a, const typename Set::Pack& b,
                            std::index_sequence<lanes...>) {
  constexpr int named[] = {of_quad...};
  constexpr auto place = [](std::size_t lane) {
    const int from = named[lane % 4], quad = static_cast<int>(lane / 4) * 4;
    return from < 4 ? quad + from : static_cast<int>(Set::kWidth) + quad + from - 4;
  };
  return __builtin_shufflevector(a, b, place(lanes)...);
}

/// Each quad of the four packs, as a matrix, the other way round: four of a node from x, y, z and w
/// of four nodes, and back.
template <class Set>
void transpose(typename Set::Pack (&packs)[4]) {
  using Pack = typename Set::Pack;
  constexpr auto lanes = std::make_index_sequence<Set::kWidth>();
  const Pack low_01 = shuffled<Set, 0, 4, 1, 5>(packs[0], packs[1], lanes);
  const Pack low_23 = shuffled<Set, 0, 4, 1, 5>(packs[2], packs[3], lanes);
  const Pack high_01 = shuffled<Set, 2, 6, 3, 7>(packs[0], packs[1], lanes);
  const Pack high_23 = shuffled<Set, 2, 6, 3, 7>(packs[2], packs[3], lanes);
  packs[0] = shuffled<Set, 0, 1, 4, 5>(low_01, low_23, lanes);
  packs[1] = shuffled<Set, 2, 3, 6, 7>(low_01, low_23, lanes);
  packs[2] = shuffled<Set, 0, 1, 4, 5>(high_01, high_23, lanes);
  packs[3] = shuffled<Set, 2, 3, 6, 7>(high_01, high_23, lanes);
}

/// A node's four floats.
inline const UnalignedQuad& quad_of(const float* base, std::size_t node) {
  return *reinterpret_cast<const UnalignedQuad*>(base + 4 * node);
}
inline UnalignedQuad& quad_of(float* base, std::size_t node) {
  return *reinterpret_cast<UnalignedQuad*>(base + 4 * node);
}

/// x, y and z of kWidth nodes of four floats each.
template <class Set>
Vectors<Set> gather(const float* base, const std::uint32_t* nodes) {
  typename Set::Pack packs[4];
  for (std::size_t i = 0; i < 4; ++i) {
    Quad quads[Set::kWidth / 4];
    for (std::size_t k = 0; k < Set::kWidth / 4; ++k) {
      quads[k] = quad_of(base, nodes[4 * k + i]);
    }
    packs[i] = Set::join(quads);
  }
  transpose<Set>(packs);
  return {packs[0], packs[1], packs[2]};
}

/// What is added to kWidth nodes: of the i-th of each quad of lanes four floats in packs[i].
template <class Set>
struct Addends {
  typename Set::Pack packs[4];

  Addends(const Vectors<Set>& vectors, const typename Set::Pack& fourth)
      : packs{vectors.x, vectors.y, vectors.z, fourth} {
    transpose<Set>(packs);
  }
  /// Those of the k-th quad of lanes, one node after the other.
  void add(std::size_t k, float* base, const std::uint32_t* nodes) const {
    for (std::size_t i = 0; i < 4; ++i) {
      UnalignedQuad& sum = quad_of(base, nodes[4 * k + i]);
      sum = sum + reinterpret_cast<const UnalignedQuad*>(&packs[i])[k];
    }
  }
};

}  // namespace
}  // namespace palpate::deformation::kernel
