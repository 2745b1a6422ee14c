#include "deformation/contact/organ_contact_solve.h"

#include <catch2/catch.hpp>
#include <random>

#include "tests/deformation/organs.h"

namespace palpate::deformation {
namespace {

Body loose_body(std::vector<double> masses) {
  Body body;
  body.masses = std::move(masses);
  for (const double mass : body.masses) body.inverse_masses.push_back(mass > 0 ? 1 / mass : 0);
  return body;
}

OrganPlace at_node(std::uint32_t organ, std::uint32_t node) {
  return {organ, {node, 0, 0}, Vec3(1, 0, 0)};
}

OrganContactRow head_on(double friction, double gap) {
  OrganContactRow row;
  row.places = {at_node(0, 0), at_node(1, 0)};
  row.normal = Vec3::UnitX();
  row.friction = friction;
  row.approach = allowed_approach(gap, 1e-3);
  return row;
}

Vec3 momentum(std::span<const TouchedOrgan> organs) {
  Vec3 sum = Vec3::Zero();
  for (const TouchedOrgan& organ : organs) {
    for (std::size_t i = 0; i < organ.velocities.size(); ++i) {
      sum += organ.body->masses[i] * organ.velocities[i];
    }
  }
  return sum;
}

double energy(std::span<const TouchedOrgan> organs) {
  double sum = 0;
  for (const TouchedOrgan& organ : organs) sum += kinetic_energy(*organ.body, organ.velocities);
  return sum;
}

TEST_CASE("organ contacts: two nodes that meet go on together, with their common momentum") {
  // Oracle: the plastic collision.
  const Body light = loose_body({1}), heavy = loose_body({3});
  std::vector<TouchedOrgan> organs{{&light, {Vec3(2, 0, 0)}}, {&heavy, {Vec3(-1, 0, 0)}}};
  std::vector<OrganContactRow> rows{head_on(0, 0)};
  const auto report = solve_organ_contacts(rows, organs);
  CHECK(report.converged);
  CHECK(organs[0].velocities[0].x() == Approx(-0.25));
  CHECK(organs[1].velocities[0].x() == Approx(-0.25));
  CHECK(rows[0].normal_impulse == Approx(2.25));
}

TEST_CASE("organ contacts: a gap may be closed and is not overshot, what parts is left alone") {
  // Oracle: approach · h = gap; unilaterality.
  const Body body = loose_body({1});
  for (const double speed : {-1.0, 0.5, 2.0}) {
    std::vector<TouchedOrgan> organs{{&body, {Vec3(speed, 0, 0)}}, {&body, {Vec3::Zero()}}};
    std::vector<OrganContactRow> rows{head_on(0, 1e-3)};
    solve_organ_contacts(rows, organs);
    const double approach = organs[0].velocities[0].x() - organs[1].velocities[0].x();
    CHECK(approach == Approx(std::min(speed, 1.0)));
    CHECK((rows[0].normal_impulse > 0) == (speed > 1));
  }
}

TEST_CASE("organ contacts: places nearer than they rest part slowly, deep ones no faster") {
  // Oracle: kOpenedInStep of the gap in a step, at most kOpeningSpeed.
  const Body body = loose_body({1});
  for (const double gap : {-1e-5, -1e-2}) {
    std::vector<TouchedOrgan> organs{{&body, {Vec3::Zero()}}, {&body, {Vec3::Zero()}}};
    std::vector<OrganContactRow> rows{head_on(0, gap)};
    solve_organ_contacts(rows, organs);
    const double parting = organs[1].velocities[0].x() - organs[0].velocities[0].x();
    CHECK(parting == Approx(std::min(kOpenedInStep * -gap / 1e-3, kOpeningSpeed)));
  }
}

TEST_CASE("organ contacts: friction stops sliding, within Coulomb's cone") {
  // Oracle: the impulse that makes sliding 0 is m/2 · speed; friction · j is the most there is.
  const Body body = loose_body({1});
  for (const double friction : {0.1, 2.0}) {
    std::vector<TouchedOrgan> organs{{&body, {Vec3(1, 0.6, 0)}}, {&body, {Vec3(-1, 0, 0)}}};
    std::vector<OrganContactRow> rows{head_on(friction, 0)};
    solve_organ_contacts(rows, organs);
    CHECK(rows[0].normal_impulse == Approx(1));
    const double most = std::min(0.3, friction * rows[0].normal_impulse);
    CHECK((rows[0].tangential_impulse - Vec3(0, most, 0)).norm() < 1e-12);
    CHECK(organs[0].velocities[0].y() == Approx(0.6 - most));
  }
}

/// Two balls, or one twice, with rows between random places; some nodes are fixed.
struct RandomRows {
  OrganModel model;
  VolumeGradient gradient;
  std::vector<TouchedOrgan> organs;
  std::vector<OrganContactRow> rows;

  RandomRows(unsigned seed, bool itself, double friction) : model(fixed_ball()) {
    std::mt19937 engine(seed);
    std::uniform_real_distribution<double> any(-1, 1);
    const auto vector = [&] { return Vec3(any(engine), any(engine), any(engine)); };
    evaluate_volume(model, model.rest_positions, gradient);
    for (int i = 0; i < (itself ? 1 : 2); ++i) {
      TouchedOrgan organ{&model, std::vector<Vec3>(model.node_count(), Vec3::Zero()), &gradient};
      for (std::size_t k = 0; k < model.node_count(); ++k) {
        if (model.inverse_masses[k] > 0) organ.velocities[k] = 0.1 * vector();
      }
      organs.push_back(std::move(organ));
    }
    for (std::uint32_t r = 0; r < 12; ++r) {
      OrganContactRow row;
      for (std::uint32_t s = 0; s < 2; ++s) {
        OrganPlace& place = row.places[s];
        place.organ = itself ? 0 : s;
        for (std::uint32_t k = 0; k < 3; ++k) place.nodes[k] = 6 * r % 36 + 3 * s + k;
        place.weights = vector().cwiseAbs();
        place.weights /= place.weights.sum();
      }
      row.normal = vector().normalized();
      row.approach = r % 3 == 0 ? 0 : 0.01 * (1 + any(engine));
      row.friction = friction;
      rows.push_back(row);
    }
  }

  static OrganModel fixed_ball() {
    auto organ = testing::ball_organ();
    organ.fixed.push_back(scene::BoxRegion{Vec3(-1, -1, -1), Vec3(1, 1, -0.03)});
    return testing::ball_model(1, organ);
  }

  double volume_velocity(std::size_t organ) const {
    double sum = 0;
    for (std::size_t k = 0; k < gradient.gradient.size(); ++k) {
      sum += gradient.gradient[k].dot(organs[organ].velocities[k]);
    }
    return sum;
  }
};

TEST_CASE("organ contacts: the solution meets every condition of the contact problem") {
  // Oracle: the Karush–Kuhn–Tucker conditions, volume included. 1e-4 m/s: the sweeps' tolerance,
  // times 10 for what further sweeps would still add.
  constexpr double kTolerance = 10 * kOrganVelocityTolerance;
  for (unsigned seed = 0; seed < 20; ++seed) {
    for (const bool itself : {false, true}) {
      for (const double friction : {0.0, 0.3}) {
        RandomRows problem(seed, itself, friction);
        std::vector<double> volumes;
        for (std::size_t i = 0; i < problem.organs.size(); ++i)
          volumes.push_back(problem.volume_velocity(i));
        const double before = energy(problem.organs);
        const auto report = solve_organ_contacts(problem.rows, problem.organs);
        INFO("seed " << seed << ", itself " << itself << ", friction " << friction << ", sweeps "
                     << report.sweeps);
        CHECK(report.converged);
        for (std::size_t i = 0; i < volumes.size(); ++i) {
          CHECK(problem.volume_velocity(i) == Approx(volumes[i]).margin(1e-15));
        }
        for (const OrganContactRow& row : problem.rows) {
          const Vec3 relative = relative_velocity(row, problem.organs);
          const double slack = row.normal.dot(relative) + row.approach;
          CHECK(slack > -kTolerance);
          CHECK(row.normal_impulse >= 0);
          if (row.normal_impulse > 0) CHECK(std::abs(slack) < kTolerance);
          CHECK(row.tangential_impulse.norm() <= row.friction * row.normal_impulse * (1 + 1e-12));
          CHECK(std::abs(row.tangential_impulse.dot(row.normal)) <= 1e-15);
          const Vec3 sliding = relative - row.normal * row.normal.dot(relative);
          CHECK(row.tangential_impulse.dot(sliding) <=
                1e-12 + row.tangential_impulse.norm() * kTolerance);
        }
        CHECK(energy(problem.organs) <= before);
      }
    }
  }
}

TEST_CASE("organ contacts: action is reaction to rounding, however few sweeps were made") {
  // Oracle: Newton's third law. A closed surface's pressure pushes no one: Σ g = 0.
  const OrganModel model = testing::ball_model(1);
  for (unsigned seed = 0; seed < 20; ++seed) {
    RandomRows problem(seed, seed % 2 == 0, 0.3);
    for (TouchedOrgan& organ : problem.organs) organ.body = &model;
    const Vec3 before = momentum(problem.organs);
    solve_organ_contacts(problem.rows, problem.organs);
    CHECK((momentum(problem.organs) - before).norm() < 1e-15);
  }
}

TEST_CASE("organ contacts: beside organs a probe's contact is solved anew from its impulse") {
  // Oracle: two nodes in a row against a wall that comes with 1 m/s: all go on with it, so what the
  // wall gave the first alone becomes what both need.
  const Body body = loose_body({1});
  std::vector<TouchedOrgan> organs{{&body, {Vec3(1, 0, 0)}}, {&body, {Vec3::Zero()}}};
  ContactRow wall;
  wall.weights = Vec3(1, 0, 0);
  wall.normal = -Vec3::UnitX();
  wall.probe_velocity = Vec3(1, 0, 0);
  wall.normal_impulse = 1;  // which stopped the node's approach of 1 m/s
  std::vector<OrganContactRow> rows{head_on(0, 0), row_of_probe(0, wall, 1e-3)};
  solve_organ_contacts(rows, organs);
  take_impulses(rows[1], wall);
  CHECK(organs[0].velocities[0].x() == Approx(1).margin(1e-3));
  CHECK(organs[1].velocities[0].x() == Approx(1).margin(1e-3));
  CHECK(rows[0].normal_impulse == Approx(1).margin(1e-3));
  CHECK(wall.normal_impulse == Approx(2).margin(1e-3));
}

TEST_CASE("organ contacts: a probe's contact yields where fixed nodes carry it, too") {
  // Oracle: by hand. A node of 1 kg that comes with 1 m/s, 1 mm deep, against 1e-6 m/N in a step of
  // a millisecond, which is 1/kg: of 2 m/s each gives one.
  const Body body = loose_body({1});
  std::vector<TouchedOrgan> organs{{&body, {Vec3(1, 0, 0)}}};
  ContactRow wall;
  wall.weights = Vec3(1, 0, 0);
  wall.normal = Vec3::UnitX();
  wall.yielding = 1e-6;
  wall.gap = wall.full_gap = -1e-3;
  std::vector<OrganContactRow> rows{row_of_probe(0, wall, 1e-3)};
  rows[0].applied = false;
  solve_organ_contacts(rows, organs);
  CHECK(rows[0].normal_impulse == Approx(1).margin(1e-3));
}

TEST_CASE("organ contacts: between fixed nodes there is no impulse") {
  // Oracle: nothing can move.
  const Body fixed = loose_body({0});
  std::vector<TouchedOrgan> organs{{&fixed, {Vec3::Zero()}}, {&fixed, {Vec3::Zero()}}};
  std::vector<OrganContactRow> rows{head_on(0.1, -1e-4)};
  CHECK(solve_organ_contacts(rows, organs).converged);
  CHECK(rows[0].normal_impulse == 0);
  CHECK(organs[0].velocities[0] == Vec3::Zero());
}

}  // namespace
}  // namespace palpate::deformation
