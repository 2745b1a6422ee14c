// What an organ publishes, looked at as anybody may who knows nothing of its guards.
#pragma once

#include <vector>

#include "modules/geometry/triangle_surface.h"
#include "modules/messages/messages.h"

namespace palpate::fuzz {

class OrganWatch {
 public:
  /// @param size    of the organ [m]
  /// @param mass    of what moves of it [kg]
  /// @param period  of an advance [s]
  OrganWatch(const SurfaceTopology& surface, double size, double mass, double period);

  /// After an advance.
  /// @param replaced  a guard has said that it put an organ's state back
  /// @throws Failure if a node is far away or moved too fast, or the organ is back at rest without
  ///         a word
  void look(const NodePositions& nodes, bool replaced);

  /// After the last advance. @throws Failure if the organ is shaking, grown or turned inside out:
  /// what the guards would have replaced long before
  void look_last() const;

 private:
  double size_, mass_, period_;             ///< [m], [kg], [s]
  double volume_ = 0, kinetic_energy_ = 0;  ///< [m³], [J]
  std::vector<geometry::Triangle> triangles_;
  std::vector<Vec3> rest_, seen_, before_;  ///< [m]
  double away_ = 0;                         ///< largest way from rest when last looked at [m]
};

}  // namespace palpate::fuzz
