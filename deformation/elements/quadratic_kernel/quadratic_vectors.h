// Vectors of space and quads of memory, as many side by side as an instruction set has lanes. A
// `Set` gives
//
//   kWidth           lanes: 4, 8 or 16
//   Pack, Unaligned  so many floats in a register, and anywhere in memory
//   join(quads)      kWidth/4 quads side by side
//   part(pack, k)    the k-th of them
//   root(pack)       elementwise
#pragma once

#include <cstddef>
#include <cstdint>

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
Vectors<Set> operator*(float s, const Vectors<Set>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class Set>
Vectors<Set> scaled(const typename Set::Pack& s, const Vectors<Set>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class Set>
typename Set::Pack dot(const Vectors<Set>& a, const Vectors<Set>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class Set>
Vectors<Set> cross(const Vectors<Set>& a, const Vectors<Set>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class Set>
typename Set::Pack load(const float* from) {
  return *reinterpret_cast<const typename Set::Unaligned*>(from);
}
template <class Set>
void store(float* to, const typename Set::Pack& pack) {
  *reinterpret_cast<typename Set::Unaligned*>(to) = pack;
}
template <class Set>
typename Set::Pack larger(const typename Set::Pack& a, const typename Set::Pack& b) {
  return a > b ? a : b;
}
template <class Set>
typename Set::Pack smaller(const typename Set::Pack& a, const typename Set::Pack& b) {
  return a < b ? a : b;
}

/// x, y and z of kWidth nodes of four floats each.
template <class Set>
Vectors<Set> gather(const float* base, const std::uint32_t* nodes) {
  Quad x[Set::kWidth / 4], y[Set::kWidth / 4], z[Set::kWidth / 4];
  for (std::size_t k = 0; k < Set::kWidth / 4; ++k) {
    Quad node[4];
    for (std::size_t i = 0; i < 4; ++i) {
      node[i] = *reinterpret_cast<const UnalignedQuad*>(base + 4 * std::size_t{nodes[4 * k + i]});
    }
    const Quad xy_01 = __builtin_shufflevector(node[0], node[1], 0, 4, 1, 5);
    const Quad xy_23 = __builtin_shufflevector(node[2], node[3], 0, 4, 1, 5);
    const Quad z_01 = __builtin_shufflevector(node[0], node[1], 2, 6, 3, 7);
    const Quad z_23 = __builtin_shufflevector(node[2], node[3], 2, 6, 3, 7);
    x[k] = __builtin_shufflevector(xy_01, xy_23, 0, 1, 4, 5);
    y[k] = __builtin_shufflevector(xy_01, xy_23, 2, 3, 6, 7);
    z[k] = __builtin_shufflevector(z_01, z_23, 0, 1, 4, 5);
  }
  return {Set::join(x), Set::join(y), Set::join(z)};
}

/// Adds the k-th quad of lanes to four floats of each of its nodes, one node after the other.
/// @param stride  floats from node to node
template <class Set>
void scatter_quad(std::size_t k, float* base, const std::uint32_t* nodes, std::size_t stride,
                  const Vectors<Set>& vectors, const typename Set::Pack& fourth) {
  const Quad x = Set::part(vectors.x, k), y = Set::part(vectors.y, k);
  const Quad z = Set::part(vectors.z, k), w = Set::part(fourth, k);
  const Quad xy_01 = __builtin_shufflevector(x, y, 0, 4, 1, 5);
  const Quad xy_23 = __builtin_shufflevector(x, y, 2, 6, 3, 7);
  const Quad zw_01 = __builtin_shufflevector(z, w, 0, 4, 1, 5);
  const Quad zw_23 = __builtin_shufflevector(z, w, 2, 6, 3, 7);
  const Quad rows[4] = {__builtin_shufflevector(xy_01, zw_01, 0, 1, 4, 5),
                        __builtin_shufflevector(xy_01, zw_01, 2, 3, 6, 7),
                        __builtin_shufflevector(xy_23, zw_23, 0, 1, 4, 5),
                        __builtin_shufflevector(xy_23, zw_23, 2, 3, 6, 7)};
  for (std::size_t i = 0; i < 4; ++i) {
    auto& sum = *reinterpret_cast<UnalignedQuad*>(base + stride * std::size_t{nodes[4 * k + i]});
    sum = sum + rows[i];
  }
}

}  // namespace
}  // namespace palpate::deformation::kernel
