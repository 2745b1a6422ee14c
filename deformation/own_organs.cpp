#include "deformation/own_organs.h"

#include <algorithm>

#include "modules/scene/processes.h"

namespace palpate::deformation {

OwnOrgans::OwnOrgans(const scene::Scene& scene, std::size_t process)
    : own_(scene.organs.size(), kNotOwn) {
  for (const std::size_t organ : scene::organs_of(scene, process)) {
    own_[organ] = static_cast<std::uint32_t>(in_scene_.size());
    in_scene_.push_back(static_cast<std::uint32_t>(organ));
  }
}

void OwnOrgans::keep_own(ContactSet& contacts, std::vector<std::uint32_t>& generations) const {
  if (in_scene_.size() == own_.size()) return;
  keep_own_faces(contacts);
  for (Contact& contact : contacts.contacts) contact.organ = own(contact.organ);
  std::erase_if(contacts.contacts, [](const Contact& c) { return c.organ == kNotOwn; });
  if (generations.size() < own_.size()) return generations.clear();
  for (std::size_t i = 0; i < in_scene_.size(); ++i) generations[i] = generations[in_scene_[i]];
  generations.resize(in_scene_.size());
}

/// With their nodes, which lie face by face.
void OwnOrgans::keep_own_faces(ContactSet& contacts) const {
  auto from = contacts.face_nodes.begin(), to = from;
  for (FaceContacts& face : contacts.faces) {
    const auto count = std::min<std::ptrdiff_t>(face.node_count, contacts.face_nodes.end() - from);
    face.organ = own(face.organ);
    if (face.organ != kNotOwn) to = std::copy_n(from, count, to);
    from += count;
  }
  contacts.face_nodes.erase(to, contacts.face_nodes.end());
  std::erase_if(contacts.faces, [](const FaceContacts& f) { return f.organ == kNotOwn; });
}

}  // namespace palpate::deformation
