// A flat block on its held base under a sphere that slides at constant depth, without friction. Its
// tissue is the same everywhere, so the force is constant but for the mesh (and the far sides).
#pragma once

#include "modules/geometry/tet_mesh.h"
#include "studies/rigs/pressed_organ.h"

namespace palpate::rigs {

/// Edges [m] and their growth with the distance from where the sphere may be.
struct SmallEdges {
  double edge = 0, growth = 0;
};

struct BlockSlide {
  double rate = 100;                     ///< of deformation [Hz]
  double radius = 8e-3, depth = 4e-3;    ///< of the sphere [m]
  double coarse_edge = 14e-3;            ///< [m]
  double direction = 0;                  ///< from x [rad]
  std::optional<SmallEdges> small = {};  ///< all along the way, in advance

  static constexpr double kHalfWay = 25e-3;  ///< [m]
  Vec3 along() const;                        ///< unit
};

/// 12 × 12 × 5 cm, its top at z = 0, its edges coarse. @throws InputError if gmsh is missing
geometry::TetMesh coarse_block(double edge);
/// Where it is held.
scene::Region slid_block_base();

class SlidBlock {
 public:
  /// @param organ  all but its place, shape and what holds it
  SlidBlock(const BlockSlide& slide, scene::Organ organ);

  /// The sphere's middle: so far along the way from the block's middle, so deep [m].
  Vec3 at(double way, double depth) const;
  /// In a straight line at `speed` [m/s], then to rest.
  void go(const Vec3& to, double speed);
  /// One period. @returns the force upwards [N]
  double step(const Vec3& to);
  PressedOrgan& pressed() { return pressed_; }
  const geometry::OrganShape& shape() const { return shape_; }

 private:
  BlockSlide slide_;
  geometry::OrganShape shape_;
  PressedOrgan pressed_;
};

}  // namespace palpate::rigs
