// The organs of one deformation process among those of its scene.
#pragma once

#include <cstdint>
#include <vector>

#include "modules/core/touch.h"
#include "modules/scene/scene.h"

namespace palpate::deformation {

class OwnOrgans {
 public:
  /// @param process  from 1
  OwnOrgans(const scene::Scene& scene, std::size_t process);

  std::size_t count() const { return in_scene_.size(); }
  /// The scene's index of a process's own organ.
  std::uint32_t in_scene(std::size_t organ) const { return in_scene_.at(organ); }

  /// Leaves out what is of others, and counts organs as the process does.
  /// @param generations  by organ; none: as they are
  void keep_own(ContactSet& contacts, std::vector<std::uint32_t>& generations) const;

 private:
  static constexpr std::uint32_t kNotOwn = ~std::uint32_t{0};
  std::uint32_t own(std::uint32_t in_scene) const {
    return in_scene < own_.size() ? own_[in_scene] : kNotOwn;
  }
  void keep_own_faces(ContactSet& contacts) const;

  std::vector<std::uint32_t> in_scene_;  ///< by own organ
  std::vector<std::uint32_t> own_;       ///< by organ of the scene
};

}  // namespace palpate::deformation
