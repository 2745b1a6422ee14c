// Every model of the scene, with what holds for it.
#pragma once

#include <array>
#include <vector>

#include "modules/scene/models.h"
#include "modules/scene/schema.h"
#include "tests/deformation/steppers/tetrahedral_solids.h"
#include "tests/modules/geometry/tetrahedra.h"
#include "tests/robustness/organs_under_test.h"

namespace palpate::deformation::testing {

/// A model and how it steps; what its headers say it keeps.
struct ModelUnderTest {
  std::string model;
  scene::Integrator integrator = scene::Integrator::kAutomatic;
  bool momentum = true;          ///< without outside forces
  bool angular_momentum = true;  ///< likewise
  /// All its constants scale with the tissue's stiffness: no pressure or length of its own.
  bool scale_free = true;
  /// Visits its parts one after the other, so that the order matters.
  bool sequential = false;
};

inline std::vector<ModelUnderTest> models_under_test() {
  using scene::Integrator;
  constexpr auto kAuto = Integrator::kAutomatic;
  return {{"implicit_volume", Integrator::kSymplecticEuler},
          {"implicit_volume", Integrator::kBackwardEuler, true, false},
          {"mass_spring", Integrator::kSymplecticEuler},
          {"mass_spring", Integrator::kBackwardEuler, true, false},
          {"penalty", kAuto, true, true, false},
          {"baumgarte"},
          {"promayon", kAuto, true, false},
          {"post_stabilisation", kAuto, true, false},
          {"bourguignon_cani", kAuto, true, true, false},
          {"zordan", kAuto, true, true, false},
          {"element_volume"},
          {"chainmail", kAuto, false, false},
          {"xpbd_springs", kAuto, true, false, true, true},
          {"xpbd_tetrahedra", kAuto, true, false},
          {"corotational", kAuto, true, false},
          {"nodal_pressure", kAuto, true, false},
          {"quadratic_elements", kAuto, true, false},
          // Linear about the rest shape: a turned scene is a symmetry; angular momentum, that of
          // a turned organ, is kept about the rest positions only and not looked at here.
          {"modal", kAuto, true, false}};
}

/// A lopsided organ of about 5 cm: no axis, plane or two nodes of it are alike. Quadratic models
/// factorize matrices: 12 tetrahedra for them, 72 for the other solids.
inline geometry::OrganShape lopsided_shape(const std::string& model) {
  const bool quadratic = scene::is_quadratic(model);
  geometry::OrganShape shape;
  if (scene::is_solid(model)) {
    const auto [nx, ny, nz] = quadratic ? std::array{2, 1, 1} : std::array{3, 2, 2};
    shape = geometry::shape_of(geometry::testing::block(Vec3(0.08, 0.06, 0.05), nx, ny, nz));
  } else {
    shape = geometry::make_ball(kBallRadius, 2);
  }
  const auto warp = [](Vec3& p) {
    p = Vec3(1.3 * p.x() + 0.2 * p.y() + 2 * p.z() * p.z(), 0.9 * p.y() + 3 * p.x() * p.x(),
             0.8 * p.z() + 0.1 * p.x() + 1.5 * p.x() * p.y());
  };
  for (Vec3& p : shape.surface.nodes) warp(p);
  for (Vec3& p : shape.inner_nodes) warp(p);
  return quadratic ? geometry::with_edge_nodes(shape) : shape;
}

/// A ball about the origin, of solids a cube as wide. Quadratic models factorize matrices: 6
/// tetrahedra for quadratic_elements, or tests take minutes.
inline geometry::OrganShape compact_shape(const std::string& model) {
  if (!scene::is_solid(model)) return geometry::make_ball(kBallRadius, 2);
  const bool quadratic = scene::is_quadratic(model);
  const int cells = model == "quadratic_elements" ? 1 : quadratic ? 2 : 3;
  auto shape = geometry::shape_of(
      geometry::testing::block(Vec3::Constant(2 * kBallRadius), cells, cells, cells));
  for (Vec3& p : shape.surface.nodes) p -= Vec3::Constant(kBallRadius);
  for (Vec3& p : shape.inner_nodes) p -= Vec3::Constant(kBallRadius);
  return quadratic ? geometry::with_edge_nodes(shape) : shape;
}

inline scene::Organ organ_of(const ModelUnderTest& kind) {
  auto organ = ball_organ();
  organ.model = kind.model;
  organ.integrator = kind.integrator;
  organ.solid.poisson_ratio = 0.45;
  return organ;
}

inline std::string name_of(const ModelUnderTest& kind) {
  return kind.model + std::string(" ") + scene::word_of(kind.integrator);
}

}  // namespace palpate::deformation::testing
