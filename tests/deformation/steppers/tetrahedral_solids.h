// Solid organs the tests of their models share.
#pragma once

#include <catch2/catch.hpp>
#include <random>

#include "deformation/models.h"
#include "modules/scene/models.h"
#include "tests/modules/geometry/tetrahedra.h"

namespace palpate::deformation::testing {

/// E 5 kPa, 1060 kg/m³, neither drag nor damping.
inline scene::Organ solid_organ(const std::string& model, double poisson_ratio) {
  scene::Organ organ;
  organ.name = "solid";
  organ.model = model;
  organ.tissue.youngs_modulus = 5e3;
  organ.tissue.density = 1060;
  organ.tissue.drag = organ.tissue.damping_ratio = 0;
  organ.solid.poisson_ratio = poisson_ratio;
  return organ;
}

/// Cube of 6 cm, 4 × 4 × 4 cells of six tetrahedra.
inline OrganModel cube_model(const scene::Organ& organ, const Vec3& gravity = Vec3::Zero(),
                             int cells = 4) {
  const auto mesh = geometry::testing::block(Vec3::Constant(0.06), cells, cells, cells);
  auto shape = geometry::shape_of(mesh);
  if (scene::is_quadratic(organ.model)) shape = geometry::with_edge_nodes(shape);
  return build_organ_model(organ, gravity, shape);
}

/// Rest positions off by up to `by` [m], the same every time.
inline std::vector<Vec3> shaken(const OrganModel& model, double by) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(-1, 1);
  std::vector<Vec3> positions = model.rest_positions;
  for (Vec3& x : positions) x += by * Vec3(any(random), any(random), any(random));
  return positions;
}

}  // namespace palpate::deformation::testing
