// What the kernel of quadratic tetrahedra works on: ../quadratic_pressure.h, lane by lane.
//
// Known to the files compiled for one instruction set each, so it must stay free of inline library
// code: the linker would keep one copy of it, possibly of an instruction set the CPU has not.
#pragma once

#include <cstddef>
#include <cstdint>

namespace palpate::deformation::kernel {

/// Tetrahedra side by side, floats in the widest register. The same for every instruction set, so
/// that all add in the same order.
inline constexpr std::size_t kQuadraticLanes = 16;

/// Barycentric coordinates of the four points: of the corner that is near, of the others.
inline constexpr double kNearCorner = 0.58541019662496845, kFarCorner = 0.13819660112501052;

/// Lanes left over are of node 0 alone and have no volume.
struct alignas(64) QuadraticBatch {
  template <std::size_t count>
  using Floats = float[count][kQuadraticLanes];

  std::uint32_t nodes[10][kQuadraticLanes];  ///< corners, then middles of kTetrahedronEdges
  Floats<6> metric;                          ///< ∇L_i·∇L_j of ij = 11 22 33 12 13 23 [1/m²]
  Floats<1> volume;                          ///< V at rest [m³]
  Floats<1> per_volume;                      ///< 1/V; 0 of a lane left over
  Floats<1> pressure;                        ///< kept from steps before; of press() κ' ε [Pa]
  Floats<1> share;                           ///< of κ' that resists at once
  // As linearised last, at the four points q:
  Floats<36> tangents;  ///< ∂x/∂L_j at 9 q + 3 (j − 1) + axis [m]
  Floats<4> shapes;     ///< scale V/4 (μ + θ)
  Floats<4> turnings;   ///< scale c'/24
};

struct QuadraticPass {
  QuadraticBatch* batches = nullptr;
  std::size_t batch_count = 0;
  double shear_modulus = 0;  ///< μ [Pa]
  double point_modulus = 0;  ///< α [Pa]
  double bulk_modulus = 0;   ///< κ' [Pa]
  float scale = 0;           ///< h² of a step [s²]

  // Of linearise(), measure(), and press(), which sets pressures:
  const double* positions = nullptr;  ///< three a node [m]
  // Of linearise(), added to:
  float* forces = nullptr;    ///< four a node [N]
  float* diagonal = nullptr;  ///< xx yy zz xy of each node's block [kg]
  float* mixed_z = nullptr;   ///< xz yz 0 0

  // Of measure():
  double* energies = nullptr;  ///< by batch and lane, set; of lanes left over no numbers [J]

  // Of multiply():
  const float* vector = nullptr;  ///< four a node
  float* product = nullptr;       ///< four a node, added to
};

/// The code of one instruction set.
struct QuadraticKernel {
  void (*press)(const QuadraticPass&);
  void (*linearise)(const QuadraticPass&);
  void (*multiply)(const QuadraticPass&);
  void (*measure)(const QuadraticPass&);  ///< in double
};

QuadraticKernel portable_quadratic_kernel();
QuadraticKernel avx2_quadratic_kernel();
QuadraticKernel avx512_quadratic_kernel();

}  // namespace palpate::deformation::kernel
