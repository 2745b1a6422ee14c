// The contacts that deformation believes of those it is told, carried to its organs' present
// meshes.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "deformation/world_organ.h"
#include "modules/core/state_archive.h"
#include "modules/core/touch.h"

namespace palpate::deformation {

class ContactIntake {
 public:
  /// The contacts of a message that can be believed, faces as one contact a node, sorted by (organ,
  /// triangle). Those that name no organ or triangle are ignored; those metres away from their
  /// tissue or probe are refused.
  /// @param generations  of each organ's mesh that they were found on; empty: of the present ones
  /// @returns valid until the next take()
  std::span<const Contact> take(std::span<const WorldOrgan> organs, const ContactSet& contacts,
                                std::span<const std::uint32_t> generations);

  /// Whether one was refused since this was asked last.
  bool take_refused() { return std::exchange(refused_, false); }

  void exchange(StateArchive& archive) { archive(refused_); }

 private:
  void take_if_plausible(std::span<const WorldOrgan> organs, const Contact& contact,
                         const Pose& probe);
  void append_face(std::span<const WorldOrgan> organs, const FaceContacts& face,
                   std::span<const std::uint32_t> nodes, const Pose& probe,
                   std::span<const std::uint32_t> generations);

  std::vector<Contact> taken_;
  bool refused_ = false;
};

}  // namespace palpate::deformation
