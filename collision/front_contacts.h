// Contacts of a ball with very many triangles that it is in front of, or grazes: what it would get
// from CoreContacts, but of each triangle only its nearest point is looked at.
#pragma once

#include <vector>

#include "collision/contact_reduction.h"
#include "collision/core_sweep.h"
#include "collision/index_marks.h"
#include "collision/near_surface.h"

namespace palpate::collision {

class FrontContacts {
 public:
  /// Contacts of a ball that is behind no wall with NearSurface::candidates(), thinned
  /// (thinning.h).
  /// @returns false, and nothing is found, where its centre came so near to a triangle that it may
  ///          be behind it now
  bool find(const OrganStep& step, const Core& ball, const NearSurface& near,
            std::vector<FoundContact>& found);

 private:
  static constexpr std::uint32_t kNoGraze = 0xffffffff;
  /// The place of a triangle that is nearest to the centre, or was when the triangle was grazed.
  struct Nearest {
    double distance = 0;      ///< [m]
    Eigen::Vector3f place;    ///< in P [m]
    std::uint32_t triangle;   ///< of the organ
    std::uint32_t candidate;  ///< of NearSurface
    std::uint32_t graze;      ///< in grazes_, or kNoGraze
  };

  void add(const Nearest& nearest, const Vec3& weights, const geometry::Triangle& nodes);
  void append(const OrganStep& step, const Core& ball, const NearSurface& near,
              std::vector<FoundContact>& found);
  void add_grazes(const OrganStep& step, const Core& ball);

  // Kept between calls for their memory only.
  std::vector<Nearest> nearest_;
  std::vector<std::uint32_t> maybe_grazed_;  ///< triangles
  std::vector<FoundContact> grazes_;
  IndexMarks places_;
};

}  // namespace palpate::collision
