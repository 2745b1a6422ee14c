#include "deformation/contact/constraint_projection.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <random>

#include "tests/deformation/organs.h"
#include "tests/dense_algebra.h"

namespace palpate::deformation {
namespace {

/// A ball's nodes with random inverse_mass_blocks, its volume gradient and some contacts.
struct Fixture {
  OrganModel model = testing::ball_model(1);
  VolumeGradient volume;
  std::vector<Mat3> inverse_mass_blocks;
  std::vector<ContactRow> contacts;
  std::vector<Vec4f> r;
  std::mt19937 random{7};
  std::uniform_real_distribution<double> uniform{-1, 1};

  Vec3 random_vector() { return {uniform(random), uniform(random), uniform(random)}; }

  Fixture() {
    evaluate_volume(model, model.rest_positions, volume);
    for (std::size_t i = 0; i < model.node_count(); ++i) {
      Mat3 factor;
      for (int column = 0; column < 3; ++column) factor.col(column) = random_vector();
      inverse_mass_blocks.push_back(factor * factor.transpose() + 0.1 * Mat3::Identity());
      r.push_back(wide(random_vector()));
    }
    inverse_mass_blocks[3].setZero();  // fixed
  }

  void add_contact(std::size_t triangle) {
    ContactRow row;
    row.nodes = model.triangles[triangle];
    row.weights = Vec3(0.5, 0.3, 0.2);
    row.normal = random_vector().normalized();
    row.normal_impulse = 1;
    contacts.push_back(row);
  }

  /// Rows as a dense matrix, the volume's first.
  Eigen::MatrixXd dense_rows() const {
    std::vector<Eigen::VectorXd> rows(1, Eigen::VectorXd::Zero(size()));
    for (std::size_t i = 0; i < volume.gradient.size(); ++i) {
      rows[0].segment<3>(3 * static_cast<Eigen::Index>(i)) = volume.gradient[i];
    }
    for (const ContactRow& contact : contacts) {
      Eigen::VectorXd row = Eigen::VectorXd::Zero(size());
      for (int k = 0; k < 3; ++k) {
        row.segment<3>(3 * contact.nodes[k]) = contact.weights[k] * contact.normal;
      }
      rows.push_back(row);
    }
    Eigen::MatrixXd dense(static_cast<Eigen::Index>(rows.size()), size());
    for (std::size_t k = 0; k < rows.size(); ++k) {
      dense.row(static_cast<Eigen::Index>(k)) = rows[k].transpose();
    }
    return dense;
  }
  Eigen::Index size() const { return 3 * static_cast<Eigen::Index>(model.node_count()); }
};

Eigen::VectorXd flat(const std::vector<Vec4f>& v) {
  Eigen::VectorXd out(3 * static_cast<Eigen::Index>(v.size()));
  for (std::size_t i = 0; i < v.size(); ++i) {
    out.segment<3>(3 * static_cast<Eigen::Index>(i)) = v[i].head<3>().cast<double>();
  }
  return out;
}

TEST_CASE("constraint projection: agrees with dense linear algebra") {
  // Oracle: z = W r − W Bᵀ (B W Bᵀ)⁻¹ B W r by a dense LU. 1e-5: float.
  Fixture f;
  f.add_contact(0);
  f.add_contact(1);
  f.add_contact(12);
  ConstraintProjection projection;
  projection.prepare(f.inverse_mass_blocks, f.volume.gradient, f.contacts);
  std::vector<Vec4f> z(f.r.size());
  auto rest = f.r;
  projection.project(rest, z);

  Eigen::MatrixXd w = Eigen::MatrixXd::Zero(f.size(), f.size());
  for (std::size_t i = 0; i < f.inverse_mass_blocks.size(); ++i) {
    const auto at = 3 * static_cast<Eigen::Index>(i);
    w.block<3, 3>(at, at) = f.inverse_mass_blocks[i];
  }
  const Eigen::MatrixXd b = f.dense_rows();
  const Eigen::VectorXd mu = solved(b * w * b.transpose(), b * w * flat(f.r));
  const Eigen::VectorXd expected = w * (flat(f.r) - b.transpose() * mu);
  CHECK((flat(z) - expected).norm() < 1e-5 * expected.norm());

  // … and the impulses handed over are μ: what is left of r gives z without any row.
  double volume_impulse = 0.25;
  const auto before = f.contacts;
  projection.take_impulses(f.contacts, volume_impulse, rest);
  CHECK(volume_impulse == Approx(0.25 + mu[0]).epsilon(1e-5));
  CHECK(f.contacts[0].normal_impulse == Approx(before[0].normal_impulse + mu[1]).epsilon(1e-5));
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const Vec3 answer = f.inverse_mass_blocks[i] * rest[i].head<3>().cast<double>();
    CHECK((wide(answer) - z[i]).norm() < 1e-5f);
  }
}

TEST_CASE("constraint projection: a step in one pass is the same as its parts") {
  // Oracle: x + s p, r − s q, project() and a dot product; both leave the same of r. 1e-5: float.
  Fixture f;
  f.add_contact(0);
  f.add_contact(12);
  ConstraintProjection projection;
  projection.prepare(f.inverse_mass_blocks, f.volume.gradient, f.contacts);
  const double step = 0.3, kept = 0.6;
  AlignedVector<WideNode> p(f.r.size());
  std::vector<Vec4f> q = f.r, x(f.r.size(), Vec4f::Ones()), r(f.r.size()), z(f.r.size());
  std::reverse(q.begin(), q.end());
  for (std::size_t i = 0; i < p.size(); ++i) {
    p[i].vector = q[i] - f.r[i];
    r[i] = f.r[i] - static_cast<float>(step) * q[i];
  }
  const double expected = projection.project(r, z);
  CHECK(expected == Approx(dot(r, z)).epsilon(1e-5));
  auto contacts = f.contacts;
  double pressure = 0;
  projection.take_impulses(contacts, pressure, r);

  projection.prepare(f.inverse_mass_blocks, f.volume.gradient, f.contacts);
  auto rest = f.r;
  auto found_z = z, found_x = x;
  auto turned = p;
  CHECK(projection.descend(step, p, q, found_x, rest, found_z) == Approx(expected).epsilon(1e-5));
  projection.turn(kept, found_z, turned);
  projection.take_impulses(contacts, pressure, rest);
  const float size = z[0].norm();
  for (std::size_t i = 0; i < p.size(); ++i) {
    CHECK((rest[i] - r[i]).norm() < 1e-6f * q[i].norm());
    CHECK((found_x[i] - x[i] - static_cast<float>(step) * p[i].vector).norm() < 1e-5f);
    const Vec4f direction = z[i] + static_cast<float>(kept) * p[i].vector;
    CHECK((turned[i].vector - direction).norm() < 1e-5f * (size + p[i].vector.norm()));
  }
}

TEST_CASE("constraint projection: rows that take all but a millionth leave the rest right") {
  // Oracle: r = Bᵀ10⁶ + s has the projection of s, and r·z is zᵀW⁻¹z. 0.1: floats know r to 0.06.
  // Without a second projection r·z is rounding of 10¹², a thousand times itself and of any sign.
  Fixture f;
  f.add_contact(0);
  f.add_contact(12);
  ConstraintProjection projection;
  projection.prepare(f.inverse_mass_blocks, f.volume.gradient, f.contacts);
  auto small = f.r;
  std::vector<Vec4f> z_small(f.r.size()), z(f.r.size());
  const double expected = projection.project(small, z_small);

  const Eigen::MatrixXd b = f.dense_rows();
  Eigen::VectorXd impulses = Eigen::VectorXd::Constant(b.rows(), 1e6);
  impulses[0] /= b.row(0).norm();
  const Eigen::VectorXd along = b.transpose() * impulses;
  auto large = f.r;
  for (std::size_t i = 0; i < large.size(); ++i) {
    large[i] += wide(along.segment<3>(3 * static_cast<Eigen::Index>(i)));
  }
  projection.prepare(f.inverse_mass_blocks, f.volume.gradient, f.contacts);
  CHECK(projection.project(large, z) == Approx(expected).epsilon(0.1));
  CHECK((flat(z) - flat(z_small)).norm() < 0.1 * flat(z_small).norm());
}

TEST_CASE("constraint projection: dependent contacts hold what one of them would") {
  // Oracle: definition. Twice the same contact: B W Bᵀ is singular.
  Fixture once, twice;
  once.add_contact(5);
  twice.add_contact(5);
  twice.contacts.push_back(twice.contacts[0]);
  std::vector<Vec4f> z(once.r.size()), z_twice(once.r.size());
  ConstraintProjection projection;
  projection.prepare(once.inverse_mass_blocks, once.volume.gradient, once.contacts);
  projection.project(once.r, z);
  projection.prepare(twice.inverse_mass_blocks, twice.volume.gradient, twice.contacts);
  projection.project(twice.r, z_twice);
  CHECK((flat(z) - flat(z_twice)).norm() < 1e-5 * flat(z).norm());
}

TEST_CASE("constraint projection: without rows it is W r, and held nodes do not move") {
  // Oracle: definition; a contact that holds fixed nodes only, or gives no impulse, is no row.
  Fixture f;
  f.add_contact(5);
  f.contacts[0].normal_impulse = 0;
  f.add_contact(6);
  for (const std::uint32_t node : f.contacts[1].nodes) f.inverse_mass_blocks[node].setZero();
  ConstraintProjection projection;
  projection.prepare(f.inverse_mass_blocks, {}, f.contacts);
  std::vector<Vec4f> z(f.r.size());
  projection.project(f.r, z);
  for (std::size_t i = 0; i < z.size(); ++i) {
    const Vec3 answer = f.inverse_mass_blocks[i] * f.r[i].head<3>().cast<double>();
    CHECK((z[i] - wide(answer)).norm() <= 1e-6f * z[i].norm());
  }
}

TEST_CASE("constraint projection: contacts that hold every node leave the volume nothing to do") {
  // Oracle: invariant, no NaN where g · W g vanishes.
  Fixture f;
  for (std::size_t t = 0; t < f.model.triangles.size(); ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      f.add_contact(t);
      f.contacts.back().weights = Vec3::Unit(corner);
    }
  }
  ConstraintProjection projection;
  projection.prepare(f.inverse_mass_blocks, f.volume.gradient, f.contacts);
  std::vector<Vec4f> z(f.r.size());
  projection.project(f.r, z);
  for (std::size_t i = 0; i < f.model.surface_node_count; ++i) CHECK(z[i].norm() < 1e-4f);
}

}  // namespace
}  // namespace palpate::deformation
