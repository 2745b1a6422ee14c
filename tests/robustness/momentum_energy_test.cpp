// What no model may make out of nothing: momentum, angular momentum, energy.
#include <catch2/catch.hpp>
#include <random>

#include "deformation/steppers/newton_backward_euler.h"
#include "modules/scene/models.h"
#include "tests/robustness/models_under_test.h"

namespace palpate::deformation {
namespace {

using testing::lopsided_shape;
using testing::models_under_test;
using testing::name_of;
using testing::organ_of;

struct Moving {
  OrganModel model;
  std::unique_ptr<OrganDynamics> dynamics;
  OrganState state;
  double step;
  bool lumped = true;  ///< by what mass it moves
};

/// Each node off by up to 1 mm, with up to 0.1 m/s.
Moving moving(const testing::ModelUnderTest& kind, double damping_ratio, double drag) {
  auto organ = organ_of(kind);
  organ.tissue.damping_ratio = damping_ratio;
  organ.tissue.drag = drag;
  Moving out{build_organ_model(organ, Vec3::Zero(), lopsided_shape(kind.model)), nullptr, {}, 0};
  out.lumped = !scene::is_quadratic(kind.model) || kind.model == "quadratic_pressure";
  out.dynamics = make_dynamics(organ, out.model, testing::kPeriod);
  out.step = std::min(out.dynamics->largest_step(), 1e-3);
  out.state = rest_state(out.model);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-1, 1);
  for (std::size_t i = 0; i < out.model.node_count(); ++i) {
    out.state.positions[i] += 1e-3 * Vec3(any(random), any(random), any(random));
    out.state.velocities[i] = 0.1 * Vec3(any(random), any(random), any(random));
  }
  return out;
}

struct Sums {
  Vec3 momentum = Vec3::Zero(), angular = Vec3::Zero();
  double kinetic = 0, mass = 0;
};

/// M v of each node [kg m/s]. Quadratic models that are solved to the end, and their modes, move by
/// the mass of their elements, not by lumps.
std::vector<Vec3> momenta(const Moving& m) {
  std::vector<Vec3> momenta(m.model.node_count(), Vec3::Zero());
  for (std::size_t i = 0; m.lumped && i < momenta.size(); ++i) {
    momenta[i] = m.model.masses[i] * m.state.velocities[i];
  }
  if (m.lumped) return momenta;
  const auto solid = quadratic_solid(m.model);
  for (std::size_t e = 0; e < solid.element_count(); ++e) {
    const auto& nodes = solid.mesh().elements[e];
    const deformation::ElementMass mass = solid.mass(e);
    for (std::size_t a = 0; a < nodes.size(); ++a) {
      for (std::size_t b = 0; b < nodes.size(); ++b) {
        momenta[nodes[a]] += mass(Eigen::Index(a), Eigen::Index(b)) * m.state.velocities[nodes[b]];
      }
    }
  }
  return momenta;
}

Sums sums_of(const Moving& m) {
  Sums sums;
  const auto all = momenta(m);
  for (std::size_t i = 0; i < m.model.node_count(); ++i) {
    const Vec3& p = all[i];
    sums.momentum += p;
    sums.angular += m.state.positions[i].cross(p);
    sums.kinetic += p.dot(m.state.velocities[i]) / 2;
    sums.mass += m.model.masses[i];
  }
  return sums;
}

TEST_CASE("momentum: kept by every model but the kinematic one") {
  // Oracle: Newton's third law, 300 steps without outside forces. 1e-6: springs in float keep
  // it to 1e-7 of the impulses of a step (docs/decisions/0005).
  for (const auto& kind : models_under_test()) {
    if (!kind.momentum) continue;
    auto m = moving(kind, 0, 0);
    const Sums before = sums_of(m);
    for (int s = 0; s < 300; ++s) m.dynamics->step(m.step, {}, m.state);
    const Sums after = sums_of(m);
    const double scale = before.mass * 0.1;
    INFO(name_of(kind) << ": momentum " << (after.momentum - before.momentum).norm() / scale
                       << ", angular " << (after.angular - before.angular).norm() / scale / 0.05);
    CHECK((after.momentum - before.momentum).norm() < 1e-6 * scale);
    if (!kind.angular_momentum) continue;
    CHECK((after.angular - before.angular).norm() < 1e-6 * scale * testing::kBallRadius);
  }
}

TEST_CASE("energy: with damping it falls, for every model") {
  // Oracle: dissipation. Symplectic steps let it swing within a period of the highest mode, so the
  // largest of 50 steps is compared with that of the 50 before.
  for (const auto& kind : models_under_test()) {
    auto m = moving(kind, 0.1, 2);
    double last = 1e300;
    for (int window = 0; window < 20; ++window) {
      double most = 0;
      for (int s = 0; s < 50; ++s) {
        m.dynamics->step(m.step, {}, m.state);
        most = std::max(most, sums_of(m).kinetic + m.dynamics->elastic_energy(m.state));
      }
      INFO(name_of(kind) << ", window " << window << ": " << most << " after " << last);
      CHECK(most <= last * (1 + 1e-6) + 1e-12);
      last = most;
    }
  }
}

}  // namespace
}  // namespace palpate::deformation
