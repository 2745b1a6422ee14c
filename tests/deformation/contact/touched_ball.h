// A ball at rest and contacts made by hand, for tests of what a probe does with them.
#pragma once

#include "deformation/contact/probe_contacts.h"
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

}  // namespace palpate::deformation::testing
