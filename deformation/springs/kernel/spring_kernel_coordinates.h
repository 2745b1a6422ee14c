// The parts of a step that treat all coordinates alike, as plain loops: the compiler makes the most
// of the instruction set of the file that includes them. Every coordinate of a slice has sums of
// its own, so the bits are the same for every set.
#pragma once

#include "deformation/springs/kernel/spring_kernel_arrays.h"

namespace palpate::deformation::kernel {
namespace {

inline constexpr std::size_t kSliceCoordinates = 3 * kDoubleLanes;

/// By coordinate of eight nodes.
struct CoordinateSums {
  double denominator[kSliceCoordinates] = {};
  double volume_velocity[kSliceCoordinates] = {};
};

inline double sum(const double (&values)[kSliceCoordinates]) {
  double total = 0;
  for (const double value : values) total += value;
  return total;
}

/// Where forces and 6 g were: v̂ = v + h (F/m + gravity − drag v), at rest where nodes are fixed,
/// and g. @param first  coordinate, at a slice's begin
template <bool kVolume>
inline void finish_slice(const Layout& layout, const Step& step, std::size_t first,
                         std::size_t count, CoordinateSums& sums) {
  const double h = step.h, drag = step.drag;
  const double* __restrict gravity = step.gravity;
  const double* __restrict inverse_masses = layout.inverse_masses + first;
  const double* __restrict velocities = step.velocities + first;
  double* __restrict new_velocities = step.new_velocities + first;
  double* __restrict gradient = step.gradient + first;
  double* __restrict denominator = sums.denominator;
  double* __restrict volume_velocity = sums.volume_velocity;
  for (std::size_t c = 0; c < count; ++c) {
    const double v = velocities[c], inverse_mass = inverse_masses[c];
    const double a = new_velocities[c] * inverse_mass + gravity[c] - drag * v;
    const double stepped = v + h * a;
    const double next = inverse_mass > 0 ? stepped : 0;
    new_velocities[c] = next;
    if constexpr (kVolume) {
      const double g = gradient[c] * (1.0 / 6);
      gradient[c] = g;
      denominator[c] += g * g * inverse_mass;
      volume_velocity[c] += g * next;
    }
  }
}

/// finish_slice() of the coordinates [first, last), and their sums.
template <bool kVolume>
inline ChunkSums finish_slices(const Layout& layout, const Step& step, std::size_t first,
                               std::size_t last) {
  CoordinateSums sums;
  for (; first + kSliceCoordinates <= last; first += kSliceCoordinates) {
    finish_slice<kVolume>(layout, step, first, kSliceCoordinates, sums);
  }
  if (first < last) finish_slice<kVolume>(layout, step, first, last - first, sums);
  return {0, sum(sums.denominator), sum(sums.volume_velocity)};
}

/// Where 6 g was: g, and the chunk's sums with the velocities there are; V = ⅓ Σ (x − origin)·g.
inline ChunkSums finish_volume(const Layout& layout, const Step& step, std::size_t first,
                               std::size_t last) {
  CoordinateSums sums;
  double threefold[kSliceCoordinates] = {};
  for (; first < last; first += kSliceCoordinates) {
    const std::size_t count = last - first < kSliceCoordinates ? last - first : kSliceCoordinates;
    const double* __restrict origin = step.origin;
    const double* __restrict inverse_masses = layout.inverse_masses + first;
    const double* __restrict velocities = step.velocities + first;
    const double* __restrict positions = step.positions + first;
    double* __restrict gradient = step.gradient + first;
    for (std::size_t c = 0; c < count; ++c) {
      const double g = gradient[c] * (1.0 / 6);
      gradient[c] = g;
      threefold[c] += (positions[c] - origin[c]) * g;
      sums.denominator[c] += g * g * inverse_masses[c];
      sums.volume_velocity[c] += g * velocities[c];
    }
  }
  return {sum(threefold) / 3, sum(sums.denominator), sum(sums.volume_velocity)};
}

inline void move(const Move& move, std::size_t first, std::size_t last) {
  const double* __restrict inverse_masses = move.inverse_masses;
  const double* __restrict gradient = move.gradient;
  double* __restrict velocities = move.velocities;
  double* __restrict positions = move.positions;
  const double h = move.h, sigma = move.volume_impulse;
  for (std::size_t c = first; c < last; ++c) {
    velocities[c] -= (inverse_masses[c] * sigma) * gradient[c];
    positions[c] += h * velocities[c];
  }
}

}  // namespace
}  // namespace palpate::deformation::kernel
