// A ball at rest and contacts made by hand, for tests of what a probe does with them.
#pragma once

#include <algorithm>

#include "deformation/contact/probe_contacts.h"
#include "modules/core/rotation_vector.h"
#include "tests/deformation/organs.h"

namespace palpate::deformation::testing {

inline Pose pose_at(const Vec3& position, double turn_about_z = 0) {
  return {position, Quat(Eigen::AngleAxisd(turn_about_z, Vec3::UnitZ()))};
}

/// One contact per named triangle, all at p with normal n, in P.
inline std::vector<Contact> contacts_on(std::vector<std::uint32_t> triangles, const Vec3& p,
                                        const Vec3& n) {
  std::vector<Contact> contacts;
  for (const auto triangle : triangles) {
    Contact contact;
    contact.triangle = triangle;
    contact.barycentric = Vec3(0.2, 0.3, 0.5);
    contact.point_P = p;
    contact.normal_P = n;
    contacts.push_back(contact);
  }
  return contacts;
}

inline scene::Probe plate(double friction) {
  return {"plate", scene::PlaneShape{}, friction, scene::ScriptedDevice{}};
}

struct TouchedBall {
  OrganModel model = ball_model(1);
  OrganState state = rest_state(model);
  SurfaceWalk surface{model};
};

/// A ball of 2 mm over the organ's highest node, given the contacts of some triangles about it.
struct Tip {
  static constexpr double kRadius = 2e-3;
  TouchedBall organ;
  ProbeContacts probe{{"tip", scene::SphereShape{kRadius}, 0, scene::ScriptedDevice{}}};
  std::uint32_t top = 0, one = 0;  ///< node, and a triangle around it
  std::vector<ContactRow> rows;

  Tip() {
    const auto& x = organ.state.positions;
    for (std::uint32_t i = 0; i < organ.model.surface_node_count; ++i) {
      if (x[i].z() > x[top].z()) top = i;
    }
    while (std::ranges::count(organ.model.triangles[one], top) == 0) ++one;
  }
  Vec3 above(double height) const { return organ.state.positions[top] + height * Vec3::UnitZ(); }
  /// From `from` to `to` over the top within a period, as it begins.
  void go(double from, double to) {
    probe.set_pose(pose_at(above(from)));
    probe.begin(kPeriod);
    probe.end();
    probe.set_contacts(contacts_on({one}, Vec3(0, 0, -kRadius), Vec3::UnitZ()));
    probe.set_pose(pose_at(above(to)));
    probe.begin(kPeriod);
    rows.clear();
    probe.append_rows(0, organ.surface, organ.state, kPeriod, 1.0, rows);
  }
  /// A rod of this length in its place, a ball if 0, lies across the top, as a period begins in
  /// which it rests. @returns where
  Pose lay_across(double length) {
    if (length > 0) {
      const scene::CapsuleShape rod{kRadius, length};
      probe = ProbeContacts({"rod", rod, 0, scene::ScriptedDevice{}});
    }
    const Pose pose{above(1e-3), rotation_between(Vec3::UnitZ(), Vec3(1, 0.3, 0))};
    probe.set_pose(pose);
    probe.begin(kPeriod);
    probe.end();
    probe.set_contacts(contacts_on({one}, Vec3(kRadius, 0, 0), -Vec3::UnitX()));
    probe.begin(kPeriod);
    probe.append_rows(0, organ.surface, organ.state, kPeriod, 1.0, rows);
    return pose;
  }
  bool held(const std::vector<Vec3>& end) {
    return probe.hold_crossed(0, organ.surface, organ.state.positions, end, kPeriod, 1.0, rows);
  }
};

}  // namespace palpate::deformation::testing
