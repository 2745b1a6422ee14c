#include "deformation/contact_intake.h"

#include <algorithm>

namespace palpate::deformation {
namespace {

/// A contact further from its tissue or its probe's origin is none [m]. Searches reach a metre.
constexpr double kFarthestContact = 10;

bool is_within_reach(const Vec3& way) {  // not of one that is no number
  return way.squaredNorm() <= kFarthestContact * kFarthestContact;
}

bool names_a_triangle(std::span<const WorldOrgan> organs, const Contact& contact) {
  return contact.organ < organs.size() &&
         contact.triangle < organs[contact.organ].simulated.model().triangles.size();
}

bool is_near(const SimulatedOrgan& organ, const Contact& contact, const Pose& probe) {
  const auto& nodes = organ.model().triangles[contact.triangle];
  Vec3 tissue = Vec3::Zero();
  for (int k = 0; k < 3; ++k) {
    tissue += contact.barycentric[k] * organ.state().positions[nodes[k]];
  }
  return is_within_reach(contact.point_P) &&
         is_within_reach(probe.to_world(contact.point_P) - tissue);
}

/// Puts what was found on an earlier mesh, a contact or a node, on that of now.
/// @returns false if it is not there any more
template <class Found>
bool carry(std::span<const WorldOrgan> organs, std::uint32_t organ,
           std::span<const std::uint32_t> generations, Found& found) {
  if (organ >= std::min(organs.size(), generations.size())) return true;
  const WorldOrgan& on = organs[organ];
  return generations[organ] == on.generation || !on.following ||
         on.following->carry(generations[organ], found);
}

}  // namespace

std::span<const Contact> ContactIntake::take(std::span<const WorldOrgan> organs,
                                             const ContactSet& contacts,
                                             std::span<const std::uint32_t> generations) {
  taken_.clear();
  std::span<const std::uint32_t> nodes = contacts.face_nodes;
  for (const FaceContacts& face : contacts.faces) {
    const std::size_t count = std::min<std::size_t>(face.node_count, nodes.size());
    append_face(organs, face, nodes.first(count), contacts.probe_pose, generations);
    nodes = nodes.subspan(count);
  }
  for (Contact contact : contacts.contacts) {
    if (!carry(organs, contact.organ, generations, contact)) continue;
    take_if_plausible(organs, contact, contacts.probe_pose);
  }
  const auto place = [](const Contact& c) { return std::pair(c.organ, c.triangle); };
  if (!std::ranges::is_sorted(taken_, {}, place)) std::ranges::stable_sort(taken_, {}, place);
  return taken_;
}

void ContactIntake::take_if_plausible(std::span<const WorldOrgan> organs, const Contact& contact,
                                      const Pose& probe) {
  if (!names_a_triangle(organs, contact)) return;
  const bool near = is_near(organs[contact.organ].simulated, contact, probe);
  refused_ |= !near;
  if (near) taken_.push_back(contact);
}

/// The contacts of a face's nodes where the nodes are now.
void ContactIntake::append_face(std::span<const WorldOrgan> organs, const FaceContacts& face,
                                std::span<const std::uint32_t> nodes, const Pose& probe,
                                std::span<const std::uint32_t> generations) {
  if (face.organ >= organs.size()) return;
  const WorldOrgan& organ = organs[face.organ];
  const OrganModel& model = organ.simulated.model();
  for (std::uint32_t node : nodes) {
    if (!carry(organs, face.organ, generations, node)) continue;
    if (node >= model.surface_node_count || organ.surface->around(node).empty()) continue;
    Contact contact = contact_on_face(face, probe.to_body(organ.simulated.state().positions[node]));
    contact.triangle = organ.surface->around(node).front();
    const geometry::Triangle& corners = model.triangles[contact.triangle];
    contact.barycentric = Vec3::Unit(std::ranges::find(corners, node) - corners.begin());
    take_if_plausible(organs, contact, probe);
  }
}

}  // namespace palpate::deformation
