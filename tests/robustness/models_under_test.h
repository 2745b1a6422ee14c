// Every model of the scene, with what holds for it.
#pragma once

#include <array>
#include <vector>

#include "deformation/models.h"
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

/// Every row of the table of models, by each integrator it has. Modal is linear about the rest
/// shape: a turned scene is a symmetry; angular momentum, that of a turned organ, is kept about the
/// rest positions only and not looked at here.
inline std::vector<ModelUnderTest> models_under_test() {
  using scene::Integrator;
  std::vector<ModelUnderTest> all;
  for (const ModelRow& row : model_rows()) {
    ModelUnderTest one{row.word};
    one.momentum = row.conserves_momentum;
    one.angular_momentum = row.conserves_angular_momentum;
    one.scale_free =
        one.model != "penalty" && one.model != "bourguignon_cani" && one.model != "zordan";
    one.sequential = one.model == "xpbd_springs";
    const bool chooses = scene::format_of(row.word).has_integrator;
    if (chooses) one.integrator = Integrator::kSymplecticEuler;
    all.push_back(one);
    if (!chooses) continue;
    one.integrator = Integrator::kBackwardEuler;
    one.angular_momentum = false;
    all.push_back(one);
  }
  return all;
}

/// A lopsided organ of about 5 cm: no axis, plane or two nodes of it are alike. Quadratic models
/// factorise matrices: 12 tetrahedra for them, 72 for the other solids.
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

/// A ball about the origin, of solids a cube as wide. Quadratic models factorise matrices: 6
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
