// The lights of the picture: key light from the upper left, warm; weak cool fill from the right;
// rim light from behind.
#pragma once

#include <array>

namespace palpate::visualizer {

struct Lamp {
  std::array<double, 3> from;   ///< in the camera's frame: right, up, towards the eye; any length
  std::array<double, 3> color;  ///< 0 … 1
  double intensity;
};

inline constexpr std::array<Lamp, 3> kLamps{{{{-0.7, 0.9, 0.9}, {1.0, 0.97, 0.92}, 0.92},
                                             {{0.9, -0.25, 0.7}, {0.86, 0.92, 1.0}, 0.34},
                                             {{0.55, 0.7, -0.8}, {0.9, 0.95, 1.0}, 0.55}}};

}  // namespace palpate::visualizer
