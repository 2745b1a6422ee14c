// A small sphere pressed along the normal at random places of a shipped organ as a solid. All
// meshes are halvings of one, so all have the same surface, the truth's too.
#pragma once

#include <vector>

#include "modules/geometry/tet_mesh.h"
#include "studies/chart/cases.h"
#include "studies/rigs/poked_organ.h"

namespace palpate::chart {

inline constexpr std::array kSiteDepths{3e-3, 6e-3, 9e-3};  ///< [m]

struct Site {
  Vec3 touched = Vec3::Zero();  ///< on the surface at rest [m]
  Vec3 into = Vec3::UnitY();    ///< unit, along the normal
};

class OrganSites {
 public:
  /// @param radius  of the sphere [m]
  /// @throws InputError if the organ cannot be read, or gmsh is missing
  OrganSites(const rigs::PokedPlace& place, double radius);

  /// Places on the skin, area by area alike: 15 mm from what is fixed, 25 mm thick at least, and
  /// free for a sphere of kClearRadius to come along the normal.
  std::vector<Site> random(std::size_t count, unsigned seed) const;

  /// A sample per depth: the force along the normal, the profile beside it.
  /// @throws InputError as DeformationWorld; what `keep_going` throws
  Measurement press(const Site& site, const Setting& setting, const KeepGoing& keep_going) const;
  /// The same by equilibria of quadratic elements on two nested meshes, with a bar; unknown
  /// where none is found.
  Measurement truth(const Site& site, const KeepGoing& keep_going) const;

  const geometry::TriangleSurface& surface() const { return surface_; }

 private:
  Vec3 centre(const Site& site, double depth) const {
    return site.touched + (depth - radius_) * site.into;
  }
  Vec3 normal_of(const geometry::Triangle& triangle) const;
  bool is_fit(const Site& site) const;
  std::vector<Vec3> marks(const Site& site) const;
  scene::Scene scene_for(const Setting& setting) const;
  geometry::OrganShape shape_at(const Site& site, const Setting& setting) const;

  double radius_;
  scene::Organ organ_;
  geometry::TriangleSurface surface_;
  geometry::TetMesh mesh_;
};

/// Measurements of many places as one: sizes and cost are medians.
Measurement joined(const std::vector<Measurement>& places);

}  // namespace palpate::chart
