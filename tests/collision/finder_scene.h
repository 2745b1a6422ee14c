// A finder with its organs and probes, and what every contact list must satisfy.
#pragma once

#include <algorithm>
#include <catch2/catch.hpp>

#include "collision/contact_finder.h"
#include "modules/scene/probe_shape.h"
#include "tests/collision/random_shapes.h"

namespace palpate::collision {

/// More than these are reduced to the deepest.
inline constexpr ContactLimits kMost{1024, 1024, 200'000};

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
  /// Faces spelled out node by node.
  ContactSet find(const ProbeMotion& motion, double margin, std::size_t probe = 0) {
    ContactSet result;
    report = finder.find(probe, motion, margin, kMost, result);
    CHECK(result.contacts.size() <= kMost.contacts);
    spell_out(result);
    check(result, margin);
    return result;
  }

  void spell_out(ContactSet& result) const {
    std::size_t first = 0;
    for (const FaceContacts& face : result.faces) {
      for (std::size_t i = first; i < first + face.node_count; ++i) {
        const std::uint32_t node = result.face_nodes[i];
        const geometry::TriangleSurface& organ = organs[face.organ];
        Contact c = contact_on_face(face, result.probe_pose.to_body(organ.nodes[node]));
        const auto has_node = [&](const geometry::Triangle& t) {
          return std::find(t.begin(), t.end(), node) != t.end();
        };
        const auto t = std::find_if(organ.triangles.begin(), organ.triangles.end(), has_node);
        c.triangle = static_cast<std::uint32_t>(t - organ.triangles.begin());
        c.barycentric = Vec3::Unit(std::find(t->begin(), t->end(), node) - t->begin());
        result.contacts.push_back(c);
      }
      first += face.node_count;
    }
    std::stable_sort(result.contacts.begin(), result.contacts.end(),
                     [](const Contact& a, const Contact& b) {
                       return std::pair(a.organ, a.triangle) < std::pair(b.organ, b.triangle);
                     });
    result.faces.clear();
    result.face_nodes.clear();
  }

  Vec3 tissue_point(const Contact& c) const {
    const auto& t = organs[c.organ].triangles[c.triangle];
    Vec3 point = Vec3::Zero();
    for (int k = 0; k < 3; ++k) point += c.barycentric[k] * organs[c.organ].nodes[t[k]];
    return point;
  }

  /// Invariants of every list.
  void check(const ContactSet& result, double margin) const {
    for (std::size_t i = 0; i < result.contacts.size(); ++i) {
      const Contact& c = result.contacts[i];
      const double gap = normal_W(result, c).dot(point_W(result, c) - tissue_point(c));
      const bool is_sound = c.barycentric.minCoeff() >= 0 &&
                            std::abs(c.barycentric.sum() - 1) < 1e-12 &&
                            std::abs(c.normal_P.norm() - 1) < 1e-12 && c.point_P.allFinite() &&
                            std::abs(gap - c.gap) < 1e-12 && c.gap <= margin + 1e-12;
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
