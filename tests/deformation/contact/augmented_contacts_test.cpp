#include "deformation/contact/augmented_contacts.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace palpate;
using namespace palpate::deformation;

namespace {

ContactRow row_at(const Vec3& weights, double friction) {
  ContactRow row;
  row.nodes = {0, 1, 2};
  row.weights = weights;
  row.gap = row.full_gap = 1e-3;
  row.friction = friction;
  row.normal_impulse = 0.5;
  return row;
}

/// Velocities of all nodes to `velocity` from what they are.
void go_to(const Vec3& velocity, Vec3& now, std::vector<ContactRow>& rows,
           AugmentedContacts& contacts) {
  std::vector<Vec4f> product(3, Vec4f::Zero());
  contacts.set_direction(rows, std::vector<Vec4f>(3, wide(velocity - now)));
  contacts.advance(rows, 1, product);
  now = velocity;
}

}  // namespace

TEST_CASE("augmented contacts: impulses change with velocities as the product says") {
  // Oracle: finite differences of a function that is linear while no contact changes its kind.
  const std::vector<Mat3> inverse_mass_blocks(3, 2 * Mat3::Identity());
  const std::vector<Vec3> velocities{Vec3(0.01, 0, 0.12), Vec3(0, 0.02, 0.11), Vec3(0, 0, 0.12)};
  std::vector<std::vector<Vec4f>> directions{
      {Vec4f(1, 2, 3, 0), Vec4f(0, -1, 1, 0), Vec4f(2, 0, -1, 0)}};
  for (std::size_t i = 0; i < 3; ++i) {
    directions.emplace_back(3, Vec4f::Zero())[i] = Vec4f(1, -2, 0.5F, 0);
  }
  for (const auto& p : directions) {
    std::vector<ContactRow> rows{row_at({0.2, 0.3, 0.5}, 0), row_at({1, 0, 0}, 10)};
    rows[0].yielding = 1e-4;
    AugmentedContacts contacts;
    contacts.begin(inverse_mass_blocks, rows, 0.01, velocities);
    CHECK(rows[0].normal_impulse > 0);
    CHECK(rows[0].tangential_impulse.norm() == 0);
    CHECK(rows[1].tangential_impulse.norm() > 0);
    std::vector<Mat3> diagonal(3, Mat3::Zero());
    contacts.add_to_diagonal(rows, diagonal);
    std::vector<Vec4f> before(3, Vec4f::Zero()), after = before, lost = before;
    contacts.add_impulses(rows, before);
    contacts.set_direction(rows, p);
    CHECK_FALSE(contacts.advance(rows, 1e-3, lost));
    contacts.add_impulses(rows, after);
    for (std::size_t i = 0; i < 3; ++i) {
      CHECK((after[i] - before[i] + 1e-3F * lost[i]).norm() < 1e-5);
      // The block of one node: what a velocity of that node alone is answered by.
      if (&p == &directions.front() || p[i].isZero(0)) continue;
      const Vec3 answer = lost[i].head<3>().cast<double>();
      CHECK((answer - diagonal[i] * p[i].head<3>().cast<double>()).norm() < 1e-4);
    }
  }
}

TEST_CASE("augmented contacts: a step ends where the energy of nodes and contacts is least") {
  // Oracle: definition, the sum of the potentials of springs that only press, ρ = 10 / the inverse
  // mass, 15 of contacts that did not press, beside shorter and longer steps. Some contacts close
  // on the way and some open.
  const std::vector<Mat3> inverse_mass_blocks(3, Mat3::Identity());
  const double h = 0.01, curvature = 2;
  const double descent = GENERATE(0.05, 0.5, 5.0);
  std::vector<ContactRow> rows;
  for (int k = 0; k < 12; ++k) {
    ContactRow& row = rows.emplace_back(row_at({1, 0, 0}, 0));
    row.gap = 1e-3 * (k - 4);
    row.normal = k % 3 == 0 ? Vec3(0, 0, -1) : Vec3(0, 0.6, 0.8);
    row.normal_impulse = k % 2 == 0 ? 0.3 : 0;
  }
  const auto given = rows;
  AugmentedContacts contacts;
  contacts.begin(inverse_mass_blocks, rows, h, std::vector<Vec3>(3, Vec3::Zero()));
  const std::vector<Vec4f> p(3, Vec4f(0, 0, 1, 0));
  contacts.set_direction(rows, p);
  const auto contact_energy = [&](double length) {
    double sum = 0;
    for (const ContactRow& row : given) {
      const double approach = length * row.normal.z() - allowed_approach(row, h);
      const double rho = row.normal_impulse > 0 ? 10 : 15;
      sum += std::pow(std::max(0.0, row.normal_impulse + rho * approach), 2) / (2 * rho);
    }
    return sum;
  };
  // r·p has the contacts' part in it.
  double of_nodes = descent;
  for (const ContactRow& row : rows) of_nodes += row.normal_impulse * row.normal.z();
  const auto energy = [&](double length) {
    return length * length / 2 * curvature - length * of_nodes + contact_energy(length);
  };
  const double length = contacts.step_length(rows, descent, curvature);
  CHECK(length > 0);
  for (const double other : {0.0, 0.5, 0.9, 0.99, 1.01, 1.1, 2.0, 10.0}) {
    CHECK(energy(length) < energy(other * length));
  }
}

TEST_CASE("augmented contacts: never pull, and rub within Coulomb's cone") {
  // Oracle: invariants.
  const std::vector<Mat3> inverse_mass_blocks(3, 2 * Mat3::Identity());
  std::vector<ContactRow> rows{row_at({0.2, 0.3, 0.5}, 0.5), row_at({1, 0, 0}, 0.5)};
  rows[1].tangential_impulse = Vec3(3, 0, 1);
  AugmentedContacts contacts;
  Vec3 now(0.3, 0, 0.15);
  contacts.begin(inverse_mass_blocks, rows, 0.01, std::vector<Vec3>(3, now));
  for (const double speed : {-1.0, 0.05, 0.2}) {
    go_to(Vec3(0.3, 0.1, speed), now, rows, contacts);
    for (const ContactRow& row : rows) {
      CHECK(row.normal_impulse >= 0);
      CHECK(row.tangential_impulse.norm() <= 0.5 * row.normal_impulse + 1e-12);
      if (speed < 0) CHECK(row.normal_impulse == 0);
    }
  }
}

TEST_CASE("augmented contacts: on fixed nodes there is nothing to solve") {
  // Oracle: analytic.
  std::vector<ContactRow> rows{row_at({1, 0, 0}, 0)};
  AugmentedContacts contacts;
  Vec3 now = Vec3::Zero();
  contacts.begin(std::vector<Mat3>(3, Mat3::Zero()), rows, 0.01, std::vector<Vec3>(3, now));
  go_to(Vec3(0, 0, 1), now, rows, contacts);
  CHECK(rows[0].normal_impulse == 0);
}
