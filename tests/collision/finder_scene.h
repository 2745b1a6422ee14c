// A finder with its organs and probes, and what every contact list must satisfy.
#pragma once

#include <catch2/catch.hpp>

#include "collision/contact_finder.h"
#include "modules/scene/probe_shape.h"
#include "tests/collision/random_shapes.h"

namespace palpate::collision {

/// More than these are reduced to the deepest.
inline constexpr std::size_t kMostContacts = 1024;

inline Pose at(const Vec3& position, const Quat& rotation = Quat::Identity()) {
  return {position, rotation};
}
inline ProbeMotion resting(const Vec3& position, const Quat& rotation = Quat::Identity()) {
  return {at(position, rotation), at(position, rotation)};
}
inline geometry::ProbeForm probe_of(const scene::ProbeShape& shape) {
  return scene::form_of(shape);
}

inline Vec3 point_W(const ContactSet& found, const Contact& c) {
  return found.probe_pose.to_world(c.point_P);
}
inline Vec3 normal_W(const ContactSet& found, const Contact& c) {
  return found.probe_pose.rotation * c.normal_P;
}

struct FinderScene {
  std::vector<geometry::TriangleSurface> organs;
  ContactFinder finder;
  SearchReport report;  ///< of the last search

  FinderScene(std::vector<geometry::TriangleSurface> surfaces,
              std::vector<geometry::ProbeForm> probes)
      : organs(std::move(surfaces)), finder(triangles_of(organs), std::move(probes)) {
    update();
  }
  FinderScene(geometry::TriangleSurface surface, const scene::ProbeShape& shape)
      : FinderScene(std::vector{std::move(surface)}, {probe_of(shape)}) {}

  void update() {
    for (std::size_t i = 0; i < organs.size(); ++i) finder.update_organ(i, organs[i].nodes);
  }
  ContactSet find(const ProbeMotion& motion, double margin, std::size_t probe = 0) {
    ContactSet result;
    report = finder.find(probe, motion, margin, kMostContacts, result);
    check(result, margin);
    return result;
  }

  Vec3 tissue_point(const Contact& c) const {
    const auto& t = organs[c.organ].triangles[c.triangle];
    Vec3 point = Vec3::Zero();
    for (int k = 0; k < 3; ++k) point += c.barycentric[k] * organs[c.organ].nodes[t[k]];
    return point;
  }

  /// Invariants of every list.
  void check(const ContactSet& result, double margin) const {
    CHECK(result.contacts.size() <= kMostContacts);
    for (std::size_t i = 0; i < result.contacts.size(); ++i) {
      const Contact& c = result.contacts[i];
      const double gap = normal_W(result, c).dot(point_W(result, c) - tissue_point(c));
      const bool is_sound = c.barycentric.minCoeff() >= 0 &&
                            std::abs(c.barycentric.sum() - 1) < 1e-12 &&
                            std::abs(c.normal_P.norm() - 1) < 1e-12 && c.point_P.allFinite() &&
                            std::abs(gap - c.gap) < 1e-12 && c.gap <= margin + 1e-12 &&
                            c.time_of_impact >= 0 && c.time_of_impact <= 1;
      if (!is_sound)
        FAIL_CHECK("contact " << i << " of " << result.contacts.size() << " gap " << c.gap
                              << " recomputed " << gap << " weights " << c.barycentric.transpose());
      if (i == 0) continue;
      const Contact& before = result.contacts[i - 1];
      CHECK(std::pair(before.organ, before.triangle) <= std::pair(c.organ, c.triangle));
    }
  }

  static std::vector<std::vector<geometry::Triangle>> triangles_of(
      const std::vector<geometry::TriangleSurface>& surfaces) {
    std::vector<std::vector<geometry::Triangle>> result;
    for (const auto& surface : surfaces) result.push_back(surface.triangles);
    return result;
  }
};

inline double deepest_gap(const ContactSet& contacts) {
  double gap = 1e300;
  for (const Contact& c : contacts.contacts) gap = std::min(gap, c.gap);
  return gap;
}

}  // namespace palpate::collision
