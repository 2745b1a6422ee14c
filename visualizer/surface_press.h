// A press on an organ by the mouse: a probe goes to the place under the pointer by a way round the
// organs, and into it as deep as the drag says; let go, it stands off again.
#pragma once

#include <vector>

#include "visualizer/surface_pick.h"

namespace palpate::visualizer {

/// What a press has to know of a probe's body.
struct ProbeBody {
  double reach = 0;         ///< of its surface from its origin, at most [m]
  std::vector<Vec3> nodes;  ///< of its surface, in P [m]; none: a ball of `reach`
  bool plane = false;       ///< solid below its own z = 0: turned to face the organ

  ProbeBody(double ball = 0) : reach(ball) {}  // NOLINT: a ball is said by its radius
  /// Furthest that it reaches along `direction` (in W, unit) when turned by `rotation` [m].
  double support(const Quat& rotation, const Vec3& direction) const;
};

class SurfacePress {
 public:
  static constexpr double kFirstDepth = 1e-3;  ///< of the tip at once [m]
  static constexpr double kStandOff = 8e-3;    ///< before and after [m]
  static constexpr double kPerDrag = 0.5;      ///< depth by way of the pointer on the organ
  static constexpr double kDeepest = 0.4;      ///< of the organs' radius

  SurfacePress(std::size_t probe, const ProbeBody& body, const Pose& from, const SurfacePoint& at,
               const SceneView& view, const Camera& camera);

  std::size_t probe() const { return probe_; }
  const SurfacePoint& place() const { return place_; }
  double depth() const { return depth_; }           ///< wanted, of the tip below the place [m]
  bool deepest() const { return depth_ >= most_; }  ///< it goes no deeper
  /// The pointer is so far from where it pressed, on the organ [m].
  void drag(double way);
  void deepen(double by);  ///< [m]
  void slide_to(const SurfacePoint& place) { place_ = place; }

  /// Where the probe is wanted now, it being at `position` [m].
  Pose wanted(const Vec3& position);
  /// Off the organ again.
  Pose stood_off() const { return pose_at(-kStandOff); }

 private:
  Pose pose_at(double depth) const;
  void find_way(const Pose& from, const SceneView& view, const Camera& camera);

  std::size_t probe_;
  ProbeBody body_;
  Quat rotation_;
  SurfacePoint place_;
  double most_;
  double dragged_ = 0, deepened_ = 0, depth_ = kFirstDepth;
  std::vector<Vec3> way_;  ///< points to pass before the press
  std::size_t passed_ = 0;
};

}  // namespace palpate::visualizer
