#include "deformation/contact/taylor_hood_contact.h"

#include "deformation/steppers/newton_backward_euler.h"
#include "tests/deformation/steppers/squeeze.h"

namespace palpate::deformation {
namespace {

/// A cube with a barycentric row on its triangle 0, pressed in and off its stuck place.
struct Pressed {
  OrganModel model = testing::block_model(testing::reference_ball("quadratic_elements"), 1);
  deformation::TaylorHoodElements solid = quadratic_solid(model);
  TaylorHoodContact contact{model, solid};
  deformation::SolidState state = solid.rest_state();
  std::vector<ContactRow> rows = {ContactRow{.nodes = model.triangles[0]}};

  Pressed(double friction, double gap, const Vec3& slide, double yielding = 0) {
    rows[0].weights = Vec3(0.2, 0.3, 0.5);
    rows[0].normal = Vec3(1, 2, -2) / 3;
    rows[0].gap = rows[0].full_gap = gap;
    rows[0].yielding = yielding;
    rows[0].friction = friction;
    rows[0].normal_impulse = 0.01;  // 1 N: the bound is the friction coefficient in N
    const double h = 0.01;
    contact.take(rows, h, state.positions);
    contact.begin_part(h, h, state.positions);
    for (const auto node : rows[0].nodes) state.positions[node] += slide;
  }
  Eigen::VectorXd residual(const deformation::SolidState& at) const {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(solid.dof_count()));
    for (std::size_t e = 0; e < solid.element_count(); ++e) {
      deformation::ElementVector local = deformation::ElementVector::Zero();
      contact.add_residual(e, at, local);
      sum(solid.dofs(e)) += local;
    }
    return sum;
  }
};

TEST_CASE("Taylor–Hood contact: the tangent is the residual's derivative") {
  // Oracle: central differences; the law is linear pressed without friction or sticking, and where
  // what is fixed yields, too.
  for (const auto& [friction, yielding] : {std::pair(0.0, 0.0), {100.0, 0.0}, {0.0, 0.02}}) {
    Pressed pressed(friction, -2e-3, Vec3(1e-4, 0, 2e-4), yielding);
    Eigen::VectorXd direction(static_cast<Eigen::Index>(pressed.solid.dof_count()));
    for (Eigen::Index i = 0; i < direction.size(); ++i) direction[i] = std::sin(3.0 * i);
    Eigen::VectorXd change = Eigen::VectorXd::Zero(direction.size());
    for (std::size_t e = 0; e < pressed.solid.element_count(); ++e) {
      deformation::ElementMatrix tangent = deformation::ElementMatrix::Zero();
      pressed.contact.add_tangent(e, pressed.state, tangent, false);
      const auto dofs = pressed.solid.dofs(e);
      change(dofs) += tangent * direction(dofs);
    }
    const auto moved = [&](double by) {
      deformation::SolidState other = pressed.state;
      for (std::size_t i = 0; i < other.positions.size(); ++i) {
        other.positions[i] += by * direction.segment<3>(static_cast<Eigen::Index>(3 * i));
      }
      return pressed.residual(other);
    };
    const Eigen::VectorXd difference = (moved(1e-5) - moved(-1e-5)) / 2e-5;
    CHECK(change.norm() > 0);
    CHECK((change - difference).norm() < 1e-6 * change.norm());
  }
}

TEST_CASE("Taylor–Hood contact: forces are the impulses told, within Coulomb's cone") {
  // Oracle: action = reaction, and the law f = −ε g on the row's nodes by their weights.
  const Vec3 slide(0, 3e-3, 3e-3);  // across n
  Pressed pressed(0.4, -1e-5, slide);
  CHECK_FALSE(pressed.contact.is_settled(pressed.state));
  pressed.contact.augment(pressed.state);
  CHECK_FALSE(pressed.residual(pressed.state).isZero(0));
  std::vector<ContactRow> rows = pressed.rows;
  rows[0].normal_impulse = 0;
  pressed.contact.add_impulses(pressed.state, 0.01, rows);
  const Vec3 impulse = rows[0].tangential_impulse - rows[0].normal_impulse * rows[0].normal;
  CHECK(rows[0].normal_impulse > 0);
  // The bound is 0.4 of the force before it was augmented, λ + (−ε g); now that is twice as much
  // but for the 1 N it began with.
  const double before = (rows[0].normal_impulse + 0.01) / 2;
  CHECK(rows[0].tangential_impulse.norm() == Approx(0.4 * before).epsilon(1e-9));
  CHECK(std::abs(rows[0].tangential_impulse.dot(rows[0].normal)) < 1e-12 * rows[0].normal_impulse);
  CHECK(rows[0].tangential_impulse.dot(slide) < 0);
  const Eigen::VectorXd residual = pressed.residual(pressed.state);
  for (int k = 0; k < 3; ++k) {
    const Vec3 force = residual.segment<3>(
        3 * static_cast<Eigen::Index>(pressed.rows[0].nodes[static_cast<std::size_t>(k)]));
    CHECK((force + rows[0].weights[k] * impulse / 0.01).norm() < 1e-9 * force.norm());
  }
}

TEST_CASE("Taylor–Hood contact: an open contact does nothing") {
  // Oracle: the definition.
  const Pressed open(0.4, 1e-3, Vec3::Zero());
  CHECK(open.residual(open.state).isZero(0));
  CHECK(open.contact.deepest(open.state) == 0);
}

}  // namespace
}  // namespace palpate::deformation
