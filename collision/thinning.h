// Of very many places on tissue, those that stand for all.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "collision/bounds.h"
#include "modules/core/tolerances.h"

namespace palpate::collision {

/// What remains: so many deepest, and one in each of so many cells along each axis.
inline constexpr std::size_t kThinnedDeepest = 128, kThinnedCells = 4;
inline constexpr std::size_t kMostThinned =
    kThinnedDeepest + kThinnedCells * kThinnedCells * kThinnedCells;

/// Of more than kMostThinned keeps kThinnedDeepest, and of the others the deepest in each cell of a
/// grid over them.
/// @param deeper    (T, T) -> bool: a strict order, so that what is kept depends on no other
/// @param place_of  T -> Vec3 [m]
template <class T, class Deeper, class PlaceOf>
void thin(std::vector<T>& all, const Deeper& deeper, const PlaceOf& place_of) {
  if (all.size() <= kMostThinned) return;
  const auto others = all.begin() + static_cast<std::ptrdiff_t>(kThinnedDeepest);
  std::nth_element(all.begin(), others, all.end(), deeper);
  Bounds box;
  for (auto one = others; one != all.end(); ++one) box.add(place_of(*one));
  const Vec3 size = (box.upper - box.lower).cwiseMax(kDirectionless);
  std::array<T*, kMostThinned - kThinnedDeepest> deepest{};
  for (auto one = others; one != all.end(); ++one) {
    const Vec3 place = (place_of(*one) - box.lower).cwiseQuotient(size) * double{kThinnedCells};
    std::size_t cell = 0;
    for (const double along : place) {
      cell = kThinnedCells * cell + std::min(static_cast<std::size_t>(along), kThinnedCells - 1);
    }
    if (deepest[cell] == nullptr || deeper(*one, *deepest[cell])) deepest[cell] = &*one;
  }
  std::array<T, kMostThinned - kThinnedDeepest> kept;
  std::size_t count = 0;
  for (const T* one : deepest) {
    if (one != nullptr) kept[count++] = *one;
  }
  all.erase(std::copy_n(kept.begin(), count, others), all.end());
}

}  // namespace palpate::collision
