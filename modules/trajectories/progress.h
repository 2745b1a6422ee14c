// What a reader tells of itself while it reads.
#pragma once

#include <cstddef>
#include <functional>

namespace palpate::trajectories {

inline constexpr std::size_t kProgressEvery = 1 << 16;  ///< lines or messages

/// Called now and then with how much of the file is read, 0 … 1, and how many poses that were.
using Progress = std::function<void(double part, std::size_t poses)>;

}  // namespace palpate::trajectories
