#include "haptics/local_law.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "modules/core/tolerances.h"
#include "tests/dense_algebra.h"

using namespace palpate;
using namespace palpate::haptics;

namespace {

/// Wall z ≤ 0 of 200 N/m, pressed 5 mm deep; tangentially 100 N/m; 0.3 N of friction at the anchor.
LocalLaw pressed_wall() {
  LocalLaw law;
  law.anchor.position = Vec3(0.1, 0.2, -0.005);
  law.friction_coefficient = 0.5;
  law.validity_radius = 0.01;
  law.rows.resize(1);
  law.rows[0].force = Vec3(0.3, 0, 1);
  law.compliance = {1 / 200.0, 0, 1 / 100.0, 0, 0, 1 / 100.0};
  law.stiffness = Vec3(100, 100, 200).asDiagonal();
  return law;
}

LawForce evaluate(const LocalLaw& law, const Pose& pose, double time = 0, double softening = 0) {
  LawSolver solver;
  solver.take(law, softening);
  LawForce result;
  for (int i = 0; i < 100; ++i) result = solver.evaluate(pose, time);
  return result;
}
LawForce evaluate(const LocalLaw& law, const Vec3& away) {
  return evaluate(law, Pose{law.anchor.position + away, law.anchor.rotation});
}

struct Random {
  std::mt19937 engine{5};
  std::normal_distribution<double> any;
  double number() { return any(engine); }
  Vec3 vector() { return Vec3(number(), number(), number()); }
};

/// A law of random rows, flat and round, and a random W.
LocalLaw random_law(Random& random, std::size_t count, double friction) {
  LocalLaw law;
  law.anchor = {random.vector(), Quat(random.number(), random.number(), 1, 2).normalized()};
  law.friction_coefficient = friction;
  law.validity_radius = 0.01;
  for (std::size_t r = 0; r < count; ++r) {
    LawRow row;
    row.point_P = 0.01 * random.vector();
    row.normal = random.vector().normalized();
    const bool presses = r % 3 != 0;
    row.gap = presses ? 0 : 1e-3 * std::abs(random.number());
    if (presses) row.force = std::abs(random.number()) * row.normal;
    row.radius = r % 2 == 0 ? 0.008 : 0;
    law.rows.push_back(row);
  }
  const auto size = static_cast<Eigen::Index>(law.directions() * count);
  Eigen::MatrixXd half(size, size);
  for (double& x : half.reshaped()) x = 0.03 * random.number();
  const Eigen::MatrixXd W = half * half.transpose() + 1e-3 * Eigen::MatrixXd::Identity(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) law.compliance.push_back(W(i, j));
  }
  return law;
}

}  // namespace

TEST_CASE("local law: at its anchor it gives the rows' forces and their torque") {
  // Oracle: the law itself, to rounding.
  Random random;
  for (const double friction : {0.0, 0.4}) {
    const LocalLaw law = random_law(random, 16, friction);
    const LawForce at_anchor = evaluate(law, law.anchor);
    CHECK((at_anchor.wrench.force - law.force()).norm() < 1e-12 * law.force().norm());
    CHECK((at_anchor.wrench.torque - law.torque()).norm() < 1e-12 * law.force().norm());
    CHECK_FALSE(at_anchor.beyond_validity);
  }
}

TEST_CASE("local law: linear near the anchor, and never pulling") {
  // Oracle: analytic, f = force + (anchor − x)/W; the wall's surface is 5 mm above the anchor.
  const LocalLaw law = pressed_wall();
  const auto force_at = [&](double dx, double dz) {
    return evaluate(law, Vec3(dx, 0, dz)).wrench.force;
  };
  CHECK((force_at(0, -0.004) - Vec3(0.3, 0, 1.8)).norm() < 1e-13);
  CHECK((force_at(0.001, 0.001) - Vec3(0.2, 0, 0.8)).norm() < 1e-13);
  CHECK(force_at(0, 0.005).norm() < 1e-13);
  CHECK(force_at(0, 0.007).norm() == 0);
  CHECK(force_at(0, 0.0049).z() == Approx(0.02));
}

TEST_CASE("local law: a gap is crossed before there is a force") {
  // Oracle: analytic. 1 mm to go, then 1/W.
  LocalLaw law = pressed_wall();
  law.rows[0].force.setZero();
  law.rows[0].gap = 1e-3;
  CHECK(evaluate(law, Vec3(0, 0, -0.9e-3)).wrench.force.norm() == 0);
  CHECK(evaluate(law, Vec3(0, 0, -3e-3)).wrench.force.z() == Approx(0.4));
}

TEST_CASE("local law: the tangential force stays on the friction cone, and springs back") {
  // Oracle: analytic, |f_t| = min(spring, μ f_n) in the spring's direction; from the cone the
  // spring begins anew where the probe turns round.
  const LocalLaw law = pressed_wall();
  LawSolver solver;
  solver.take(law);
  const auto force_at = [&](double x) {
    return solver.evaluate({law.anchor.position + Vec3(x, 0, 0), law.anchor.rotation}, 0)
        .wrench.force;
  };
  CHECK((force_at(0.009) - Vec3(-0.5, 0, 1)).norm() < 1e-9);
  LocalLaw smooth = law;
  smooth.friction_coefficient = 0;
  smooth.compliance = {1 / 200.0};
  CHECK((evaluate(smooth, Vec3::Zero()).wrench.force - Vec3(0, 0, 1)).norm() < 1e-13);
}

TEST_CASE("local law: beyond the validity radius it is evaluated at the radius") {
  // Oracle: analytic. 30 mm deeper counts as 10 mm.
  const LocalLaw law = pressed_wall();
  const LawForce far = evaluate(law, Vec3(0, 0, -0.03));
  CHECK(far.beyond_validity);
  CHECK((far.wrench.force - Vec3(0.3, 0, 3)).norm() < 1e-9);
  CHECK_FALSE(evaluate(law, Vec3(0, 0, -0.0099)).beyond_validity);
}

TEST_CASE("local law: a turn of the probe moves its rows, and their arms give the torque") {
  // Oracle: analytic. A bar of ±20 mm on two rows of 100 N/m, 0.5 N each; turned by 10 mrad about y
  // one end goes 0.2 mm down, the other up: ±0.02 N, torque 2 · 0.02 N · 20 mm. Second order: 1e-4.
  LocalLaw law;
  law.validity_radius = 0.01;
  for (const double x : {-0.02, 0.02}) {
    LawRow row;
    row.point_P = Vec3(x, 0, 0);
    row.force = Vec3(0, 0, 0.5);
    law.rows.push_back(row);
  }
  law.compliance = {0.01, 0, 0.01};
  const Pose turned{Vec3::Zero(), Quat(Eigen::AngleAxisd(0.01, Vec3::UnitY()))};
  const Wrench wrench = evaluate(law, turned).wrench;
  CHECK(wrench.force.z() == Approx(1).epsilon(1e-4));
  CHECK(wrench.torque.y() == Approx(-2 * 0.02 * 0.02).epsilon(1e-3));
}

TEST_CASE("local law: the normal of a round probe turns as it slides over its place") {
  // Oracle: analytic. A ball of 8 mm whose middle moves 1 mm sideways off a place it touches from
  // above: the normal leans by atan(1/8), the distance grows to √(8² + 1²) − 8 mm.
  LocalLaw law;
  law.validity_radius = 0.01;
  LawRow row;
  row.point_P = Vec3(0, 0, -0.008);
  row.force = Vec3(0, 0, 0.1);
  row.radius = 0.008;
  law.rows.push_back(row);
  law.compliance = {0.01};
  const Vec3 force = evaluate(law, Vec3(0.001, 0, 0)).wrench.force;
  CHECK(force.x() / force.z() == Approx(1.0 / 8));
  CHECK(force.norm() == Approx(0.1 - (std::hypot(0.008, 0.001) - 0.008) / 0.01));
}

TEST_CASE(
    "local law: tissue that goes on at its velocity, its forces growing, meets the probe so") {
  // Oracle: analytic. A probe that goes with the tissue meets what has grown since the middle of
  // the last period; two periods after the anchor it all stands still.
  LocalLaw law = pressed_wall();
  law.period = 0.004;
  law.growth = 10;
  law.rows[0].force = Vec3(0, 0, 1);
  law.rows[0].velocity = Vec3(0, 0, -0.05);
  const auto force_at = [&](double time, double moved_for) {
    Pose pose = law.anchor;
    pose.position += moved_for * law.rows[0].velocity;
    return evaluate(law, pose, time).wrench.force.z();
  };
  CHECK(force_at(0, 0) == Approx(1 + 10 * 0.002));
  CHECK(force_at(0.004, 0.004) == Approx(1 + 10 * 0.006));
  CHECK(force_at(0.1, 0.008) == Approx(1 + 10 * 0.010));
}

TEST_CASE("local law: softened, it keeps the tissue's force and changes it less") {
  // Oracle: analytic. 200 N/m behind 200 N/m give 100, from the anchor's 1 N on.
  LocalLaw law = pressed_wall();
  law.friction_coefficient = 0;
  law.compliance = {1 / 200.0};
  law.rows[0].force = Vec3(0, 0, 1);
  LawSolver solver;
  solver.take(law, 1 / 200.0);
  const auto force_at = [&](double deeper) {
    const Vec3 position = law.anchor.position - Vec3(0, 0, deeper);
    return solver.evaluate({position, Quat::Identity()}, 0).wrench.force.z();
  };
  CHECK(force_at(0) == Approx(1));
  CHECK(force_at(0.004) == Approx(1.4));
  CHECK(force_at(-0.004) == Approx(0.6));
  CHECK(force_at(-0.011) == 0);
}

namespace {

/// Total force of frictionless flat rows, by trying which of them press.
Vec3 force_by_trial(const LocalLaw& law, const Vec3& away) {
  const auto count = static_cast<Eigen::Index>(law.rows.size());
  Eigen::MatrixXd W(count, count);
  Eigen::VectorXd gaps(count), forces(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const LawRow& row = law.rows[static_cast<std::size_t>(i)];
    for (Eigen::Index j = 0; j <= i; ++j) {
      W(i, j) = W(j, i) = law.compliance[static_cast<std::size_t>(i * (i + 1) / 2 + j)];
    }
    gaps[i] = row.gap + row.normal.dot(away);
    forces[i] = row.normal.dot(row.force);
  }
  gaps -= W * forces;
  for (unsigned set = 0; set < (1u << count); ++set) {
    Eigen::MatrixXd system = Eigen::MatrixXd::Identity(count, count);
    Eigen::VectorXd load = Eigen::VectorXd::Zero(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      if ((set >> i & 1u) == 0) continue;
      for (Eigen::Index j = 0; j < count; ++j) system(i, j) = (set >> j & 1u) ? W(i, j) : 0;
      load[i] = -gaps[i];
    }
    const Eigen::VectorXd trial = solved(system, load);
    const Eigen::VectorXd apart = gaps + W * trial;
    if (trial.minCoeff() < -1e-12 || apart.minCoeff() < -1e-12) continue;
    Vec3 sum = Vec3::Zero();
    for (Eigen::Index i = 0; i < count; ++i) {
      sum += trial[i] * law.rows[static_cast<std::size_t>(i)].normal;
    }
    return sum;
  }
  return Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
}

}  // namespace

TEST_CASE("local law: random rows open and close as trial of all their sets says") {
  // Oracle: brute force over the sets of pressing rows. Tolerance: Gauss–Seidel ends where no force
  // changes by 1e-6 N; it was given a hundred ticks, and W's condition is at most some hundred.
  Random random;
  int opened = 0;
  for (int i = 0; i < 300; ++i) {
    LocalLaw law = random_law(random, 1 + static_cast<std::size_t>(i) % 6, 0);
    for (LawRow& row : law.rows) row.radius = 0;
    REQUIRE(is_usable(law));
    const Vec3 away = 2e-3 * random.vector();
    const Vec3 expected = force_by_trial(law, away);
    CHECK((evaluate(law, away).wrench.force - expected).norm() < 2e-4 * (1 + expected.norm()));
    opened += (expected - law.force()).norm() > 0.1;
  }
  CHECK(opened > 100);
}

TEST_CASE("local law: random rows with friction never pull and never leave the cone") {
  // Oracle: invariants of one row's force. Tolerance: 1e-12 of it, rounding.
  Random random;
  for (int i = 0; i < 2000; ++i) {
    LocalLaw law = random_law(random, 1, std::abs(random.number()));
    law.rows[0].radius = 0;
    const Vec3 force = evaluate(law, 5e-3 * random.vector()).wrench.force;
    const double normal = law.rows[0].normal.dot(force);
    const double tangential = (force - normal * law.rows[0].normal).norm();
    REQUIRE(normal >= -1e-12 * force.norm());
    REQUIRE(tangential <= law.friction_coefficient * normal + 1e-12 * force.norm());
  }
}

TEST_CASE("local law: only complete, finite laws are usable") {
  // Oracle: the stated rules, one violated at a time.
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(is_usable(pressed_wall()));
  CHECK(is_usable(LocalLaw{}));
  const auto refused = [](auto corrupt) {
    LocalLaw law = pressed_wall();
    corrupt(law);
    return !is_usable(law);
  };
  CHECK(refused([&](LocalLaw& m) { m.anchor.position.x() = nan; }));
  CHECK(refused([&](LocalLaw& m) { m.anchor.rotation.coeffs() *= 2; }));
  CHECK(refused([&](LocalLaw& m) { m.anchor_age = -1; }));
  CHECK(refused([&](LocalLaw& m) { m.period = nan; }));
  CHECK(refused([&](LocalLaw& m) { m.growth = HUGE_VAL; }));
  CHECK(refused([&](LocalLaw& m) { m.stiffness(1, 2) = nan; }));
  CHECK(refused([&](LocalLaw& m) { m.friction_coefficient = -0.1; }));
  CHECK(refused([&](LocalLaw& m) { m.friction_coefficient = nan; }));
  CHECK(refused([&](LocalLaw& m) { m.validity_radius = -1; }));
  CHECK(refused([&](LocalLaw& m) { m.validity_radius = HUGE_VAL; }));
  CHECK(refused([&](LocalLaw& m) { m.rows[0].point_P.z() = nan; }));
  CHECK(refused([&](LocalLaw& m) { m.rows[0].normal *= 1 + 2 * kUnitTolerance; }));
  CHECK(refused([&](LocalLaw& m) { m.rows[0].normal.setZero(); }));
  CHECK(refused([&](LocalLaw& m) { m.rows[0].gap = -1e-6; }));
  CHECK(refused([&](LocalLaw& m) { m.rows[0].radius = -1; }));
  CHECK(refused([&](LocalLaw& m) { m.rows[0].force.y() = HUGE_VAL; }));
  CHECK(refused([&](LocalLaw& m) { m.rows[0].force.z() = -1; }));
  CHECK(refused([&](LocalLaw& m) { m.rows[0].velocity.x() = nan; }));
  CHECK(refused([&](LocalLaw& m) { m.rows.resize(kMaxLawRows + 1, m.rows[0]); }));
  CHECK(refused([&](LocalLaw& m) { m.compliance.pop_back(); }));
  CHECK(refused([&](LocalLaw& m) { m.compliance[0] = 0; }));
  CHECK(refused([&](LocalLaw& m) { m.compliance[2] = nan; }));
  CHECK(refused([&](LocalLaw& m) { m.compliance[1] = 0.0072; }));  // > √(1/200 · 1/100)
}

TEST_CASE("local law: a state that is no law's is refused") {
  // Oracle: the members of a law; 16 rows of 1 or 3 directions at most.
  const auto read = [](int directions, int per_row) {
    Pose anchor;
    double number = 0;
    StateArchive archive;
    archive(anchor, number, number, number, number, number, directions, per_row);
    StateArchive from(std::span(archive.bytes()));
    LawSolver solver;
    solver.exchange(from);
  };
  for (const auto& [directions, per_row] :
       {std::pair{-1, 1}, {2, 2}, {0, 0}, {0, 100}, {4, 3}, {17, 1}, {48, 1}, {51, 3}}) {
    CAPTURE(directions, per_row);
    CHECK_THROWS_WITH(read(directions, per_row), "its state is no law");
  }
  CHECK_NOTHROW(read(0, 1));
  CHECK_NOTHROW(read(0, 3));
}
