#include "deformation/contact/lagged_friction.h"

#include <catch2/catch.hpp>
#include <random>

namespace palpate::deformation {
namespace {

constexpr double kMass = 2e-3;  // of each node [kg]

/// A row on three free nodes of equal mass.
struct SlidingRow {
  std::vector<Mat3> inverse_mass_blocks = std::vector<Mat3>(3, Mat3::Identity() / kMass);
  std::vector<Vec3> velocities = std::vector<Vec3>(3, Vec3::Zero());
  std::vector<ContactRow> rows = std::vector<ContactRow>(1);
  LaggedFriction friction;

  SlidingRow() {
    rows[0].nodes = {0, 1, 2};
    rows[0].weights = Vec3(0.2, 0.3, 0.5);
    rows[0].friction = 0.3;
    rows[0].normal_impulse = 1e-4;
  }
  double cone() const { return rows[0].friction * rows[0].normal_impulse; }
  Vec3 sliding() const {
    Vec3 sum = -rows[0].probe_velocity;
    for (int k = 0; k < 3; ++k) sum += rows[0].weights[k] * velocities[static_cast<std::size_t>(k)];
    return sum - rows[0].normal * rows[0].normal.dot(sum);
  }
  void linearise() {
    friction.begin(rows);
    friction.linearise(inverse_mass_blocks, velocities, rows);
  }
};

TEST_CASE("lagged friction: what slides is dragged by μ j against its way, whatever its speed") {
  // Oracle: Coulomb's law.
  SlidingRow f;
  for (const double speed : {0.01, 1.0}) {
    f.rows[0].tangential_impulse.setZero();
    f.velocities.assign(3, speed * Vec3(0.6, -0.8, 5));  // along the normal as well
    f.linearise();
    CHECK((f.rows[0].tangential_impulse - f.cone() * Vec3(-0.6, 0.8, 0)).norm() < 1e-9 * f.cone());
  }
}

TEST_CASE("lagged friction: what sticks keeps its friction while it rests") {
  // Oracle: definition; a probe that moves along changes nothing.
  SlidingRow f;
  const Vec3 held = 0.5 * f.cone() * Vec3(0, 1, 0);
  f.rows[0].tangential_impulse = held;
  f.rows[0].probe_velocity = Vec3(0.1, 0.2, 0.3);
  f.velocities.assign(3, f.rows[0].probe_velocity);
  f.linearise();
  CHECK((f.rows[0].tangential_impulse - held).norm() < 1e-12 * f.cone());
  f.friction.apply(f.inverse_mass_blocks, f.velocities, f.rows);
  CHECK((f.rows[0].tangential_impulse - held).norm() < 1e-12 * f.cone());
}

TEST_CASE("lagged friction: its couplings are how it changes with the velocities") {
  // Oracle: finite differences of apply() of a row that sticks, by random velocities.
  SlidingRow f;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  f.linearise();
  f.rows[0].normal_impulse *= 1e6;  // so that apply() cuts nothing
  const Vec3 before = f.rows[0].tangential_impulse;
  std::vector<ContactCoupling> couplings;
  f.friction.append_couplings(f.rows, couplings);
  std::vector<Vec3> change(3, Vec3::Zero());
  for (Vec3& v : change) {
    for (double& x : v) x = 0.01 * uniform(random);
  }
  for (std::size_t k = 0; k < 3; ++k) f.velocities[k] += change[k];
  f.friction.apply(f.inverse_mass_blocks, f.velocities, f.rows);
  const Vec3 changed = f.rows[0].tangential_impulse - before;
  for (std::size_t node = 0; node < 3; ++node) {
    Vec3 found = Vec3::Zero();
    for (const ContactCoupling& coupling : couplings) {
      double speed = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        speed += coupling.arms[k].head<3>().cast<double>().dot(change[k]);
      }
      found -= speed * coupling.arms[node].head<3>().cast<double>();
    }
    const Vec3 expected = f.rows[0].weights[static_cast<Eigen::Index>(node)] * changed;
    CHECK((found - expected).norm() < 1e-6 * changed.norm());
  }
}

TEST_CASE("lagged friction: stays in its cone and never drives what slides") {
  // Oracle: Coulomb's law and energy, for random velocities before and after the solve. From no
  // friction before.
  SlidingRow f;
  std::mt19937 random(6);
  std::normal_distribution<double> normal;
  const auto disturb = [&] {
    for (Vec3& v : f.velocities) {
      for (double& x : v) x = 0.02 * normal(random);
    }
  };
  for (int k = 0; k < 1000; ++k) {
    f.rows[0].tangential_impulse.setZero();
    disturb();
    f.linearise();
    disturb();
    const Vec3 sliding = f.sliding();
    f.friction.apply(f.inverse_mass_blocks, f.velocities, f.rows);
    CHECK(f.rows[0].tangential_impulse.norm() <= f.cone() * (1 + 1e-12));
    CHECK(f.rows[0].tangential_impulse.dot(sliding) <= 0);
  }
}

TEST_CASE("lagged friction: nodes take what the cone cuts of the linear law") {
  // Oracle: impulse over mass. With a tenth of the force that it was linearised at.
  SlidingRow f;
  f.velocities.assign(3, Vec3(0.02, 0, 0));
  f.linearise();
  const Vec3 linear = f.rows[0].tangential_impulse;
  f.rows[0].normal_impulse *= 0.1;
  const auto before = f.velocities;
  f.friction.apply(f.inverse_mass_blocks, f.velocities, f.rows);
  const Vec3 cut = f.rows[0].tangential_impulse - linear;
  CHECK(cut.norm() > 0.8 * linear.norm());
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 expected = f.rows[0].weights[static_cast<Eigen::Index>(k)] / kMass * cut;
    CHECK((f.velocities[k] - before[k] - expected).norm() < 1e-12);
  }
}

TEST_CASE("lagged friction: none of a row that does not press, or holds what is fixed") {
  // Oracle: definition.
  SlidingRow f;
  std::vector<ContactCoupling> couplings;
  f.velocities.assign(3, Vec3(0.05, 0.02, 0));
  SECTION("no force") { f.rows[0].normal_impulse = 0; }
  SECTION("fixed") { f.inverse_mass_blocks.assign(3, Mat3::Zero()); }
  SECTION("smooth") { f.rows[0].friction = 0; }
  f.rows[0].tangential_impulse = Vec3(1e-5, 0, 0);
  f.linearise();
  f.friction.append_couplings(f.rows, couplings);
  CHECK(couplings.empty());
  CHECK(f.rows[0].tangential_impulse.isZero(0));
}

}  // namespace
}  // namespace palpate::deformation
