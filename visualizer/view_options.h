// Parts of the picture that the person looking has switched on.
#pragma once

#include <array>
#include <optional>

namespace palpate::visualizer {

enum class Coloring { kStrain, kDisplacement };

struct ViewOptions {
  Coloring coloring = Coloring::kStrain;
  std::array<bool, 3> springs{false, false, false};  ///< by SpringFamily
  bool wireframe = false;
  bool tetrahedra = false;    ///< their edges, of solids
  std::optional<double> cut;  ///< a plane across the line of sight; from the organs' middle towards
                              ///< the eye, in radii; what is nearer is cut away
  bool slow_motion = false;
  bool recording = false;
  bool help = false;
};

}  // namespace palpate::visualizer
