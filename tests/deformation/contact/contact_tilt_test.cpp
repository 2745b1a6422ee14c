#include "deformation/contact/contact_tilt.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "modules/geometry/closest_points.h"

namespace palpate::deformation {
namespace {

constexpr double kRadius = 8e-3, kStep = 0.01, kForce = 0.5e-3;

/// A triangle, and a core over the place of these weights, at the radius; outside of an edge.
struct TiltedContact {
  std::vector<Vec3> positions;
  ContactRow row;
  Vec3 core;

  TiltedContact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& weights)
      : positions{a, b, c} {
    row.nodes = {0, 1, 2};
    row.weights = weights;
    row.normal = (b - a).cross(c - a).normalized();
    for (int k = 0; k < 3; ++k) {
      if (weights[k] > 0) continue;
      const Vec3 edge = positions[static_cast<std::size_t>((k + 2) % 3)] -
                        positions[static_cast<std::size_t>((k + 1) % 3)];
      row.normal = (row.normal + 0.3 * edge.cross(row.normal).normalized()).normalized();
    }
    row.radius = kRadius;
    row.normal_impulse = kStep * kForce;
    core = weights[0] * a + weights[1] * b + weights[2] * c + kRadius * row.normal;
  }

  double distance(const Vec3& heights) const {
    geometry::TriangleCorners corners;
    for (int k = 0; k < 3; ++k) {
      corners[k] = positions[static_cast<std::size_t>(k)] + heights[k] * row.normal;
    }
    return (core - geometry::closest_on_triangle(core, corners).point).norm();
  }

  /// h² Σ (a·heights)² of the couplings, over h² = heights' stiffness heights [N·m]
  double stiffness(const Vec3& heights) const {
    std::vector<ContactCoupling> couplings;
    append_tilt_couplings({&row, 1}, positions, kStep, couplings);
    double sum = 0;
    for (const ContactCoupling& coupling : couplings) {
      double along = 0;
      for (int k = 0; k < 3; ++k) {
        const auto& arm = coupling.arms[static_cast<std::size_t>(k)];
        along += heights[k] * arm.head<3>().cast<double>().dot(row.normal);
      }
      sum += along * along;
    }
    return sum / (kStep * kStep);
  }
};

TEST_CASE("contact tilt: resists as much as the distance to the core bends, times the force") {
  // Oracle: the second difference of the distance from the core to a tilted triangle or edge, less
  // (its first derivative's) square: distance = d − w·u − ½ d |∇u|². Acute triangles. 1 %: tilts
  // are of 1e-2.
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const Vec3& weights : {Vec3(0.2, 0.3, 0.5), Vec3(0, 0.4, 0.6), Vec3(0.7, 0, 0.3)}) {
    const TiltedContact touched(Vec3(0, 0, 0), Vec3(2e-3, 0, 0.3e-3), Vec3(0.8e-3, 1.9e-3, 0),
                                weights);
    for (int k = 0; k < 10; ++k) {
      const Vec3 heights = 1e-5 * Vec3(uniform(random), uniform(random), uniform(random));
      const double bend = touched.distance(heights) - 2 * touched.distance(Vec3::Zero()) +
                          touched.distance(-heights);
      CHECK(touched.stiffness(heights) == Approx(-kForce * bend).epsilon(0.01));
    }
  }
}

TEST_CASE("contact tilt: on an obtuse triangle it is no smaller, and no lift is resisted") {
  // Oracle: as above; what does not tilt costs nothing.
  const TiltedContact touched(Vec3(0, 0, 0), Vec3(2e-3, 0, 0), Vec3(2.6e-3, 0.9e-3, 0),
                              Vec3(0.3, 0.4, 0.3));
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int k = 0; k < 10; ++k) {
    const Vec3 heights = 1e-5 * Vec3(uniform(random), uniform(random), uniform(random));
    const double bend =
        touched.distance(heights) - 2 * touched.distance(Vec3::Zero()) + touched.distance(-heights);
    CHECK(touched.stiffness(heights) >= -0.99 * kForce * bend);
  }
  CHECK(touched.stiffness(Vec3::Constant(1e-4)) < 1e-12 * kForce);
}

TEST_CASE("contact tilt: a flat probe, a row that does not press and a corner resist no tilt") {
  // Oracle: definition.
  const Vec3 a(0, 0, 0), b(2e-3, 0, 0), c(0, 2e-3, 0);
  std::vector<ContactCoupling> couplings;
  const auto count = [&](const TiltedContact& touched) {
    couplings.clear();
    append_tilt_couplings({&touched.row, 1}, touched.positions, kStep, couplings);
    return couplings.size();
  };
  TiltedContact touched(a, b, c, Vec3(0.2, 0.3, 0.5));
  CHECK(count(touched) > 0);
  touched.row.radius = 0;
  CHECK(count(touched) == 0);
  touched.row.radius = kRadius;
  touched.row.normal_impulse = 0;
  CHECK(count(touched) == 0);
  CHECK(count(TiltedContact(a, b, c, Vec3(0, 1, 0))) == 0);
}

}  // namespace
}  // namespace palpate::deformation
