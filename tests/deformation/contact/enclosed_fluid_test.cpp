#include "deformation/contact/enclosed_fluid.h"

#include <catch2/catch.hpp>

#include "deformation/contact/rigid_contact.h"
#include "deformation/steppers/quasi_static_newton.h"
#include "tests/deformation/elements/solids.h"

namespace palpate::deformation {
namespace {

constexpr double kCell = 0.01;

/// A block of 3×3×3 cells without the one in the middle.
TaylorHoodElements hollow_block() {
  auto mesh = testing::block({3 * kCell, 3 * kCell, 3 * kCell}, 3, 3, 3);
  std::erase_if(mesh.tetrahedra, [&](const geometry::Tetrahedron& t) {
    Vec3 middle = Vec3::Zero();
    for (const auto node : t) middle += mesh.nodes[node] / 4;
    return (middle - Vec3::Constant(1.5 * kCell)).cwiseAbs().maxCoeff() < kCell / 2;
  });
  return testing::solid(mesh, 0.5);
}

TEST_CASE("enclosed fluid: the cavity's faces are found, and its volume") {
  // Oracle: the cell that is missing; every node moved by one affine map changes it by its
  // determinant.
  const auto solid = hollow_block();
  const auto faces = cavity_faces(solid.mesh());
  CHECK(faces.size() == 12);
  const EnclosedFluid fluid(solid, faces);
  CHECK(fluid.rest_volume() == Approx(kCell * kCell * kCell));
  auto state = solid.rest_state();
  Mat3 F;
  F << 1.1, 0.2, 0, 0.05, 0.9, 0.1, 0, -0.1, 1.05;
  for (Vec3& x : state.positions) x = F * x + Vec3(1, 2, 3);
  CHECK(fluid.volume(state) == Approx(F.determinant() * fluid.rest_volume()));
}

TEST_CASE("enclosed fluid: forces and tangent are the volume's derivatives") {
  // Oracle: central differences, where nodes are anywhere.
  const auto solid = hollow_block();
  const EnclosedFluid fluid(solid, cavity_faces(solid.mesh()));
  auto state = testing::shaken(solid, 1e-3);
  state.fluid_pressure = 70;
  const Eigen::VectorXd gradient = fluid.gradient(state);
  double largest = 0;
  for (std::size_t e = 0; e < solid.element_count(); ++e) {
    ElementMatrix tangent = ElementMatrix::Zero();
    fluid.add_tangent(e, state, tangent);
    largest = std::max(largest, tangent.norm());
    for (int a = 0; a < kElementNodes; ++a) {
      const auto node = solid.mesh().elements[e][a];
      for (int i = 0; i < 3; ++i) {
        double& unknown = state.positions[node][i];
        const double at = unknown, step = 1e-6;
        ElementVector up = ElementVector::Zero(), down = up;
        unknown = at + step;
        fluid.add_residual(e, state, up);
        const double more = fluid.volume(state);
        unknown = at - step;
        fluid.add_residual(e, state, down);
        const double less = fluid.volume(state);
        unknown = at;
        CHECK((up - down - 2 * step * tangent.col(3 * a + i)).norm() <= 1e-6 * 2 * step * largest);
        const auto dof = static_cast<Eigen::Index>(3 * node + static_cast<std::uint32_t>(i));
        CHECK((less - more) / (2 * step) == Approx(gradient[dof]).margin(1e-12));
      }
    }
  }
  CHECK(largest > 0);
}

TEST_CASE("quasi-static Newton: what encloses a fluid keeps the cavity's volume") {
  // Oracle: the volume, which without fluid shrinks; the force, which is larger with it; the
  // pressure, which pushes out.
  const auto solid = hollow_block();
  std::vector<char> constrained(solid.displacement_count(), 0);
  for (std::size_t i = 0; i < solid.mesh().nodes.size(); ++i) {
    if (solid.mesh().nodes[i].z() < 1e-9) std::fill_n(constrained.begin() + 3 * i, 3, char{1});
  }
  const EnclosedFluid fluid(solid, cavity_faces(solid.mesh()));
  std::vector<std::uint32_t> top;
  for (std::uint32_t f = 0; f < solid.mesh().faces.size(); ++f) {
    const auto& face = solid.mesh().faces[f];
    if (solid.mesh().nodes[solid.mesh().face_node(face, 3)].z() > 2.9 * kCell) top.push_back(f);
  }
  std::array<double, 2> forces{}, volumes{};
  SolidState state;
  for (const bool with : {false, true}) {
    RigidContact contact(solid, top, 1e4 * 1000 / kCell);
    contact.set_obstacles({Plane{Vec3(0, 0, 2.7 * kCell), -Vec3::UnitZ()}});
    QuasiStaticNewton solver(solid, constrained, &contact, with ? &fluid : nullptr);
    state = solid.rest_state();
    REQUIRE(solver.solve(state).converged);
    forces[with] = contact.outcomes(state)[0].force.z();
    volumes[with] = fluid.volume(state) / fluid.rest_volume();
  }
  CHECK(volumes[false] < 0.95);
  CHECK(volumes[true] == Approx(1).margin(1e-6));
  CHECK(forces[true] > 1.01 * forces[false]);
  CHECK(state.fluid_pressure > 0);
}

}  // namespace
}  // namespace palpate::deformation
