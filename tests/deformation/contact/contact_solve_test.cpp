#include "deformation/contact/contact_solve.h"

#include <Eigen/Core>
#include <catch2/catch.hpp>
#include <random>

#include "tests/deformation/organs.h"
#include "tests/dense_algebra.h"

namespace palpate::deformation {
namespace {

struct Case {
  OrganModel model;
  VolumeGradient at;
  std::vector<Vec3> free_velocities;
  std::vector<ContactRow> rows;
};

/// A ball with random velocities and `count` random contacts that are all pressed.
Case random_case(unsigned seed, std::size_t count, double friction) {
  Case c{testing::ball_model(1), {}, {}, {}};
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto any = [&] { return Vec3(uniform(random), uniform(random), uniform(random)); };
  evaluate_volume(c.model, c.model.rest_positions, c.at);
  for (std::size_t i = 0; i < c.model.node_count(); ++i) c.free_velocities.push_back(0.05 * any());
  std::uniform_int_distribution<std::size_t> pick(0, c.model.triangles.size() - 1);
  while (c.rows.size() < count) {
    ContactRow row;
    const auto& triangle = c.model.triangles[pick(random)];
    row.nodes = triangle;
    const Vec3 weights = any().cwiseAbs() + Vec3::Constant(0.05);
    row.weights = weights / weights.sum();
    row.normal = geometry::area_vector(c.model.rest_positions, triangle).normalized();
    row.gap = 1e-5 * uniform(random);
    row.probe_velocity = -0.1 * row.normal + 0.05 * any();
    row.friction = friction;
    c.rows.push_back(row);
  }
  return c;
}

Vec3 tissue_velocity(const ContactRow& row, const std::vector<Vec3>& velocities) {
  Vec3 velocity = Vec3::Zero();
  for (int k = 0; k < 3; ++k) velocity += row.weights[k] * velocities[row.nodes[k]];
  return velocity;
}

double volume_rate(const Case& c, const std::vector<Vec3>& velocities) {
  double rate = 0;
  for (std::size_t i = 0; i < c.at.gradient.size(); ++i) {
    rate += c.at.gradient[i].dot(velocities[i]);
  }
  return rate;
}

/// Contacts, and the volume's impulse, for nodes that answer by W.
void solve_blocks(const std::vector<Mat3>& inverse_mass_blocks, const VolumeRow* volume, double h,
                  std::vector<ContactRow>& rows, std::vector<Vec3>& velocities, WarmStart start) {
  double volume_velocity = 0;
  for (std::size_t i = 0; volume != nullptr && i < volume->at.gradient.size(); ++i) {
    volume_velocity += volume->at.gradient[i].dot(velocities[i]);
  }
  const double sigma =
      solve_contacts(inverse_mass_blocks, volume, volume_velocity, h, rows, velocities, start, 60)
          .volume_impulse;
  for (std::size_t i = 0; volume != nullptr && i < volume->at.gradient.size(); ++i) {
    velocities[i] -= sigma * (inverse_mass_blocks[i] * volume->at.gradient[i]);
  }
}

TEST_CASE("contact solve: without contacts it is the scalar division") {
  // Oracle: analytic, σ = (rate + g·v̂)/gᵀM⁻¹g.
  auto c = random_case(1, 0, 0);
  auto velocities = c.free_velocities;
  const double rate = 3e-6;
  const VolumeRow volume{c.at, rate};
  const auto report = solve_contacts_and_volume(c.model, &volume, 1e-3, c.rows, velocities);
  CHECK(report.volume_impulse ==
        Approx((rate + volume_rate(c, c.free_velocities)) / c.at.denominator).epsilon(1e-12));
  CHECK(volume_rate(c, velocities) == Approx(-rate).epsilon(1e-9));
  CHECK(report.sweeps == 0);
}

TEST_CASE("contact solve: frictionless contacts satisfy their complementarity conditions") {
  // Oracle: the KKT conditions of the problem, each to the solver's stated 1e-9 m/s (1e-7 after
  // the linear convergence of neighbouring rows), and the volume to rounding.
  const auto seed = GENERATE(range(1u, 9u));
  auto c = random_case(seed, 12, 0);
  auto velocities = c.free_velocities;
  const VolumeRow volume{c.at, 1e-6};
  const double h = 1e-3;
  const auto report = solve_contacts_and_volume(c.model, &volume, h, c.rows, velocities);
  CHECK_FALSE(report.volume_skipped);
  CHECK(volume_rate(c, velocities) == Approx(-1e-6).margin(1e-15));
  for (const auto& row : c.rows) {
    const double separation =
        row.normal.dot(row.probe_velocity - tissue_velocity(row, velocities)) + row.gap / h;
    CHECK(row.normal_impulse >= 0);
    CHECK(separation > -1e-7);
    CHECK(separation * row.normal_impulse < 1e-9);
  }
}

enum class Touched { kOnce, kSomeTwice };

/// The same with each row on one node, as a plate's; every second node of the ball is touched.
Case node_case(unsigned seed, double friction, Touched touched = Touched::kSomeTwice) {
  auto c = random_case(seed, 0, friction);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (std::uint32_t node = 0; node < c.at.gradient.size(); ++node) {
    const bool twice = touched == Touched::kSomeTwice && node % 5 == 0;
    for (std::uint32_t k = 0; k < (node % 2 == 0 ? 0 : twice ? 2 : 1); ++k) {
      ContactRow row;
      row.nodes = {node, node, node};
      row.weights = Vec3::UnitX();
      row.normal =
          (c.at.gradient[node].normalized() + 0.5 * k * Vec3(uniform(random), 0, 0)).normalized();
      row.gap = 1e-5 * uniform(random);
      row.probe_velocity = 0.1 * uniform(random) * row.normal;
      row.friction = friction;
      c.rows.push_back(row);
    }
  }
  return c;
}

TEST_CASE("contact solve: rows of one node each satisfy the same conditions in few sweeps") {
  // Oracle: as above. Rows on nodes of their own take 3 or 4 sweeps (8 to 12 with σ eliminated),
  // the pairs on one node some more.
  const auto seed = GENERATE(range(1u, 9u));
  auto c = node_case(seed, 0);
  auto velocities = c.free_velocities;
  const VolumeRow volume{c.at, 1e-6};
  const double h = 1e-3;
  const auto report = solve_contacts_and_volume(c.model, &volume, h, c.rows, velocities);
  CHECK(report.sweeps <= 14);
  CHECK(volume_rate(c, velocities) == Approx(-1e-6).margin(1e-15));
  double pressed = 0;
  for (const auto& row : c.rows) {
    const double separation =
        row.normal.dot(row.probe_velocity - tissue_velocity(row, velocities)) + row.gap / h;
    CHECK(row.normal_impulse >= 0);
    CHECK(separation > -1e-7);
    CHECK(separation * row.normal_impulse < 1e-9);
    pressed += row.normal_impulse;
  }
  CHECK(pressed > 0);
}

TEST_CASE("contact solve: contacts without friction on a node each are solved as by sweeps") {
  // Oracle: the sweeps, to their 1e-9 m/s; friction of 1e-300 is none, but makes them be used.
  // Blocks I/m answer as masses do; impulses brought and already in the velocities change nothing.
  const auto seed = GENERATE(range(1u, 9u));
  const bool keeps_volume = GENERATE(true, false);
  auto at_once = node_case(seed, 0, Touched::kOnce),
       swept = node_case(seed, 1e-300, Touched::kOnce);
  const VolumeRow row{at_once.at, 1e-6};
  const VolumeRow* const volume = keeps_volume ? &row : nullptr;
  auto velocities = at_once.free_velocities, expected = velocities;
  const auto report =
      solve_contacts_and_volume(at_once.model, volume, 1e-3, at_once.rows, velocities);
  solve_contacts_and_volume(swept.model, volume, 1e-3, swept.rows, expected);
  if (keeps_volume) CHECK(volume_rate(at_once, velocities) == Approx(-1e-6).margin(1e-15));
  CHECK(report.sweeps <= 5);
  std::vector<Mat3> inverse_mass_blocks;
  for (const double inverse_mass : swept.model.inverse_masses) {
    inverse_mass_blocks.emplace_back(inverse_mass * Mat3::Identity());
  }
  auto started = swept;
  auto again = swept.free_velocities;
  for (auto& contact : started.rows) {
    contact.friction = 0;
    contact.normal_impulse = 1e-4;
    again[contact.nodes[0]] -=
        contact.normal_impulse * (inverse_mass_blocks[contact.nodes[0]] * contact.normal);
  }
  solve_blocks(inverse_mass_blocks, volume, 1e-3, started.rows, again, WarmStart::kApplied);
  double pressed = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    REQUIRE((velocities[i] - expected[i]).norm() < 1e-8);
    REQUIRE((again[i] - expected[i]).norm() < 1e-8);
  }
  for (const auto& contact : at_once.rows) pressed += contact.normal_impulse;
  CHECK(pressed > 0);
}

TEST_CASE("contact solve: kept friction stays in its cone, and rows that close find theirs") {
  // Oracle: Coulomb's law, and impulse = mass times change of velocity, friction that was kept in
  // the velocities before. Row 0 presses less than its friction needs, row 1 begins to press.
  const double mass = 2e-3, h = 1e-3, friction = 0.5;
  const std::vector<Mat3> inverse_mass_blocks(2, Mat3::Identity() / mass);
  std::vector<ContactRow> rows(2);
  for (std::uint32_t i = 0; i < 2; ++i) {
    rows[i].nodes = {i, i, i};
    rows[i].weights = Vec3(1, 0, 0);
    rows[i].friction = friction;
  }
  rows[0].normal_impulse = 1e-4;
  rows[0].tangential_impulse = Vec3(5e-5, 0, 0);
  const std::vector<Vec3> before{Vec3(0, 0, -0.02), Vec3(0.3, 0, 0.1)};
  auto velocities = before;
  solve_blocks(inverse_mass_blocks, nullptr, h, rows, velocities, WarmStart::kFrictionKept);
  CHECK(rows[0].normal_impulse == Approx(1e-4 - 0.02 * mass));
  CHECK(rows[0].tangential_impulse.x() == Approx(friction * rows[0].normal_impulse));
  CHECK(rows[1].normal_impulse == Approx(0.1 * mass));
  CHECK(rows[1].tangential_impulse.x() == Approx(-friction * rows[1].normal_impulse));
  CHECK(velocities[0].x() == Approx((rows[0].tangential_impulse.x() - 5e-5) / mass));
  CHECK(velocities[1].x() == Approx(0.3 + rows[1].tangential_impulse.x() / mass));
}

TEST_CASE("contact solve: nodes that answer by 3×3 blocks do as those that answer by their mass") {
  // Oracle: the scalar form, with blocks I/m; both solve to 1e-9 m/s.
  for (const bool on_nodes : {false, true}) {
    auto by_mass = on_nodes ? node_case(4, 0.2) : random_case(4, 10, 0.2), by_block = by_mass;
    std::vector<Mat3> inverse_mass_blocks;
    for (const double inverse_mass : by_mass.model.inverse_masses) {
      inverse_mass_blocks.emplace_back(inverse_mass * Mat3::Identity());
    }
    const VolumeRow volume{by_mass.at, 1e-6};
    auto expected = by_mass.free_velocities, velocities = expected;
    solve_contacts_and_volume(by_mass.model, &volume, 1e-3, by_mass.rows, expected);
    solve_blocks(inverse_mass_blocks, &volume, 1e-3, by_block.rows, velocities,
                 WarmStart::kToApply);
    double difference = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      difference = std::max(difference, (velocities[i] - expected[i]).norm());
    }
    CHECK(difference < 1e-7);
  }
}

TEST_CASE("contact solve: with all rows active it agrees with a dense KKT solve") {
  // Oracle: Eigen's full-pivot LU of the whole system (velocities, σ, impulses).
  auto c = random_case(3, 4, 0);
  for (auto& row : c.rows) row.probe_velocity = -1.0 * row.normal;  // pressed hard: all active
  const double h = 1e-3, rate = -2e-6;
  const auto n = static_cast<Eigen::Index>(3 * c.model.node_count());
  const auto m = static_cast<Eigen::Index>(c.rows.size());
  Eigen::MatrixXd kkt = Eigen::MatrixXd::Zero(n + 1 + m, n + 1 + m);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n + 1 + m);
  for (Eigen::Index i = 0; i < n / 3; ++i) {
    const auto node = static_cast<std::size_t>(i);
    kkt.block<3, 3>(3 * i, 3 * i) = c.model.masses[node] * Mat3::Identity();
    right.segment<3>(3 * i) = c.model.masses[node] * c.free_velocities[node];
    if (node >= c.at.gradient.size()) continue;
    kkt.block<3, 1>(3 * i, n) = c.at.gradient[node];
    kkt.block<1, 3>(n, 3 * i) = c.at.gradient[node].transpose();
  }
  right[n] = -rate;
  for (Eigen::Index r = 0; r < m; ++r) {
    const auto& row = c.rows[static_cast<std::size_t>(r)];
    for (int k = 0; k < 3; ++k) {
      const auto at = static_cast<Eigen::Index>(3 * row.nodes[static_cast<std::size_t>(k)]);
      kkt.block<3, 1>(at, n + 1 + r) += row.weights[k] * row.normal;
      kkt.block<1, 3>(n + 1 + r, at) += row.weights[k] * row.normal.transpose();
    }
    right[n + 1 + r] = row.normal.dot(row.probe_velocity) + row.gap / h;
  }
  const Eigen::VectorXd solution = solved(kkt, right);

  auto velocities = c.free_velocities;
  const VolumeRow volume{c.at, rate};
  const auto report = solve_contacts_and_volume(c.model, &volume, h, c.rows, velocities);
  CHECK(report.volume_impulse == Approx(solution[n]).epsilon(1e-6));
  for (Eigen::Index r = 0; r < m; ++r) {
    CHECK(c.rows[static_cast<std::size_t>(r)].normal_impulse ==
          Approx(solution[n + 1 + r]).epsilon(1e-6));
  }
}

TEST_CASE("contact solve: friction stays in its cone and opposes sliding") {
  // Oracle: Coulomb's law.
  const auto seed = GENERATE(range(1u, 6u));
  auto c = random_case(seed, 8, 0.3);
  auto velocities = c.free_velocities;
  const VolumeRow volume{c.at, 0};
  solve_contacts_and_volume(c.model, &volume, 1e-3, c.rows, velocities);
  for (const auto& row : c.rows) {
    CHECK(std::abs(row.tangential_impulse.dot(row.normal)) < 1e-12);
    CHECK(row.tangential_impulse.norm() <= 0.3 * row.normal_impulse * (1 + 1e-12));
    const Vec3 relative = tissue_velocity(row, velocities) - row.probe_velocity;
    const Vec3 sliding = relative - row.normal * row.normal.dot(relative);
    if (sliding.norm() > 1e-6) CHECK(row.tangential_impulse.dot(sliding) <= 1e-12);
  }
}

TEST_CASE("contact solve: impulses move the tissue by exactly what the probe receives") {
  // Oracle: momentum balance. The volume impulse alone moves nothing (Σ g = 0).
  auto c = random_case(5, 6, 0.2);
  auto velocities = c.free_velocities;
  const VolumeRow volume{c.at, 1e-6};
  solve_contacts_and_volume(c.model, &volume, 1e-3, c.rows, velocities);
  Vec3 change = Vec3::Zero(), impulses = Vec3::Zero();
  double size = 0;
  for (std::size_t i = 0; i < velocities.size(); ++i) {
    change += c.model.masses[i] * (velocities[i] - c.free_velocities[i]);
    size += c.model.masses[i] * velocities[i].norm();
  }
  for (const auto& row : c.rows) {
    impulses += row.tangential_impulse - row.normal_impulse * row.normal;
  }
  REQUIRE(impulses.norm() > 1e-6);
  CHECK((change - impulses).norm() < 1e-12 * size);
}

TEST_CASE("contact solve: starting from the solution takes few sweeps") {
  // Oracle: fixed point.
  auto c = random_case(6, 10, 0.2);
  const VolumeRow volume{c.at, 1e-6};
  auto velocities = c.free_velocities;
  const int cold = solve_contacts_and_volume(c.model, &volume, 1e-3, c.rows, velocities).sweeps;
  velocities = c.free_velocities;
  const int warm = solve_contacts_and_volume(c.model, &volume, 1e-3, c.rows, velocities).sweeps;
  CHECK(warm < cold);
  CHECK(warm <= 6);
}

TEST_CASE("contact solve: a deep penetration is undone at the stated speed, not at once") {
  // Oracle: kMaxSeparationSpeed.
  auto c = random_case(7, 1, 0);
  c.rows[0].gap = -0.02;
  c.rows[0].probe_velocity = Vec3::Zero();
  for (Vec3& v : c.free_velocities) v = Vec3::Zero();
  auto velocities = c.free_velocities;
  solve_contacts_and_volume(c.model, nullptr, 1e-3, c.rows, velocities);
  CHECK(-c.rows[0].normal.dot(tissue_velocity(c.rows[0], velocities)) ==
        Approx(kMaxSeparationSpeed).epsilon(1e-9));
}

TEST_CASE("contact solve: a vanished gradient is skipped and said, not divided by") {
  // Oracle: definition of kVanishedDenominator.
  auto c = random_case(8, 0, 0);
  for (Vec3& g : c.at.gradient) g *= 1e-5;
  c.at.denominator *= 1e-10;
  auto velocities = c.free_velocities;
  const VolumeRow volume{c.at, 1e-3};
  const auto report = solve_contacts_and_volume(c.model, &volume, 1e-3, c.rows, velocities);
  CHECK(report.volume_skipped);
  CHECK(report.volume_impulse == 0);
  CHECK(velocities == c.free_velocities);
}

TEST_CASE("contact solve: a contact on fixed nodes leaves everything finite") {
  // Oracle: definition; nothing there can move.
  auto organ = testing::ball_organ();
  organ.fixed.push_back(scene::SphereRegion{Vec3(0, 0, -0.05), 0.04});
  const auto model = testing::ball_model(1, organ);
  VolumeGradient at;
  evaluate_volume(model, model.rest_positions, at);
  std::vector<ContactRow> rows;
  for (const auto& triangle : model.triangles) {
    ContactRow row;
    row.nodes = triangle;
    row.weights = Vec3::Constant(1.0 / 3);
    row.normal = geometry::area_vector(model.rest_positions, triangle).normalized();
    row.probe_velocity = -0.1 * row.normal;
    rows.push_back(row);
  }
  std::vector<Vec3> velocities(model.node_count(), Vec3::Zero());
  const VolumeRow volume{at, 0};
  solve_contacts_and_volume(model, &volume, 1e-3, rows, velocities);
  for (std::size_t i = 0; i < velocities.size(); ++i) {
    REQUIRE(velocities[i].allFinite());
    if (model.inverse_masses[i] == 0) CHECK(velocities[i] == Vec3::Zero());
  }
}

TEST_CASE("contact solve: the excess depth is what a step leaves beyond what it may") {
  // Oracle: by hand.
  auto organ = testing::ball_organ();
  organ.fixed.push_back(scene::SphereRegion{Vec3(0, 0, -0.05), 0.02});
  const auto model = testing::ball_model(1, organ);
  const auto free = std::ranges::find_if(model.triangles, [&](const geometry::Triangle& t) {
    return std::ranges::all_of(t, [&](std::uint32_t i) { return model.inverse_masses[i] > 0; });
  });
  REQUIRE(free != model.triangles.end());
  std::vector<Vec3> velocities(model.node_count(), Vec3(0, 0, 0.2));
  ContactRow row;
  row.nodes = *free;
  row.weights = Vec3(0.25, 0.25, 0.5);
  row.normal = Vec3::UnitZ();
  row.gap = 1e-4;
  row.probe_velocity = Vec3(3, 0, -0.1);
  // It moves 3e-4 m towards the probe in a millisecond, and may move 1e-4.
  CHECK(excess_depth(model, row, 1e-3, velocities) == Approx(2e-4).epsilon(1e-12));
  row.gap = -0.5;  // it may be pushed out at 1 m/s at most: 1e-3 m
  CHECK(excess_depth(model, row, 1e-3, velocities) == Approx(1.3e-3).epsilon(1e-12));
  row.gap = 1e-3;
  CHECK(excess_depth(model, row, 1e-3, velocities) < 0);
  row.nodes.fill(model.fixed_nodes.front());
  row.gap = -0.5;
  CHECK(excess_depth(model, row, 1e-3, velocities) == 0);
}

}  // namespace
}  // namespace palpate::deformation
