// What an organ publishes, looked at as anybody may who knows nothing of its guards.
#pragma once

#include "deformation/world.h"
#include "modules/messages/messages.h"

namespace palpate::fuzz {

class OrganWatch {
 public:
  /// @param world   outlives this
  /// @param size    of the organ [m]
  /// @param period  of an advance [s]
  OrganWatch(const deformation::DeformationWorld& world, std::size_t organ, double size,
             double period);

  /// After an advance.
  /// @param replaced  a guard has said that it put an organ's state back
  /// @throws Failure if the message is not sound, a node is far away or moved too fast, or the
  ///         organ is back at rest without a word
  void look(bool replaced);

  /// After the last advance. @throws Failure if the organ is shaking, grown or turned inside out:
  /// what the guards would have replaced long before
  void look_last() const;

  const std::vector<Vec3>& seen() const { return seen_; }  ///< node positions [m]

 private:
  void look_at_nodes(bool replaced);

  const deformation::DeformationWorld& world_;
  std::size_t organ_;
  double size_, period_;
  NodePositions nodes_;
  std::vector<Vec3> rest_, seen_, before_;  ///< [m]
  double away_ = 0;                         ///< largest way from rest when last looked at [m]
};

}  // namespace palpate::fuzz
