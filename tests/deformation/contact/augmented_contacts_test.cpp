#include "deformation/contact/augmented_contacts.h"

#include <catch2/catch.hpp>

using namespace palpate;
using namespace palpate::deformation;

namespace {

ContactRow row_at(const Vec3& weights, double friction) {
  ContactRow row;
  row.nodes = {0, 1, 2};
  row.weights = weights;
  row.gap = 1e-3;
  row.friction = friction;
  row.normal_impulse = 0.5;
  return row;
}

}  // namespace

TEST_CASE("augmented contacts: impulses change with velocities as apply() says") {
  // Oracle: finite differences of a function that is linear while no contact changes its kind.
  const std::vector<Mat3> inverse_mass_blocks(3, 2 * Mat3::Identity());
  std::vector<ContactRow> rows{row_at({0.2, 0.3, 0.5}, 0), row_at({1, 0, 0}, 10)};
  AugmentedContacts contacts;
  std::vector<Vec3> velocities{Vec3(0.01, 0, 0.12), Vec3(0, 0.02, 0.11), Vec3(0, 0, 0.12)};
  contacts.begin(inverse_mass_blocks, rows, 0.01, velocities);
  contacts.update(rows, velocities);
  CHECK(rows[0].normal_impulse > 0);
  CHECK(rows[0].tangential_impulse.norm() == 0);
  CHECK(rows[1].tangential_impulse.norm() > 0);
  std::vector<Vec4f> before(3, Vec4f::Zero()), after = before, lost = before;
  contacts.add_impulses(rows, before);
  const std::vector<Vec4f> p{Vec4f(1, 2, 3, 0), Vec4f(0, -1, 1, 0), Vec4f(2, 0, -1, 0)};
  for (std::size_t i = 0; i < 3; ++i) velocities[i] += 1e-3 * p[i].head<3>().cast<double>();
  CHECK_FALSE(contacts.update(rows, velocities));
  contacts.add_impulses(rows, after);
  contacts.apply(rows, p, lost);
  std::vector<Mat3> diagonal(3, Mat3::Zero());
  contacts.add_to_diagonal(rows, diagonal);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK((after[i] - before[i] + 1e-3f * lost[i]).norm() < 1e-4);
    // The block of one node: what a velocity of that node alone is answered by.
    std::vector<Vec4f> alone(3, Vec4f::Zero()), answer = alone;
    alone[i] = Vec4f(1, -2, 0.5f, 0);
    contacts.apply(rows, alone, answer);
    CHECK((answer[i].head<3>().cast<double>() - diagonal[i] * Vec3(1, -2, 0.5)).norm() < 1e-4);
  }
}

TEST_CASE("augmented contacts: never pull, and rub within Coulomb's cone") {
  // Oracle: invariants.
  const std::vector<Mat3> inverse_mass_blocks(3, 2 * Mat3::Identity());
  std::vector<ContactRow> rows{row_at({0.2, 0.3, 0.5}, 0.5), row_at({1, 0, 0}, 0.5)};
  rows[1].tangential_impulse = Vec3(3, 0, 1);
  AugmentedContacts contacts;
  contacts.begin(inverse_mass_blocks, rows, 0.01, std::vector<Vec3>(3, Vec3(0.3, 0, 0.15)));
  for (const double speed : {-1.0, 0.05, 0.2}) {
    contacts.update(rows, std::vector<Vec3>(3, Vec3(0.3, 0.1, speed)));
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
  contacts.begin(std::vector<Mat3>(3, Mat3::Zero()), rows, 0.01,
                 std::vector<Vec3>(3, Vec3::Zero()));
  contacts.update(rows, std::vector<Vec3>(3, Vec3(0, 0, 1)));
  CHECK(rows[0].normal_impulse == 0);
}
