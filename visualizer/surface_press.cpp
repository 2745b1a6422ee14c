#include "visualizer/surface_press.h"

#include <algorithm>

#include "modules/core/rotation_vector.h"

namespace palpate::visualizer {
namespace {

constexpr double kNear = 3e-3;  // a point of the way is passed as near as this [m]

Vec3 unit_or(const Vec3& v, const Vec3& other) { return v.norm() > 1e-9 ? v.normalized() : other; }

}  // namespace

double ProbeBody::support(const Quat& rotation, const Vec3& direction) const {
  if (plane) return 0;
  if (nodes.empty()) return reach;
  const Vec3 in_P = rotation.conjugate() * direction;
  double furthest = 0;
  for (const Vec3& node : nodes) furthest = std::max(furthest, node.dot(in_P));
  return furthest;
}

SurfacePress::SurfacePress(std::size_t probe, const ProbeBody& body, const Pose& from,
                           const SurfacePoint& at, const SceneView& view, const Camera& camera)
    : probe_(probe),
      body_(body),
      rotation_(from.rotation),
      place_(at),
      most_(kDeepest * view.radius()) {
  if (body.plane) {
    const Vec3 faces = from.rotation * Vec3::UnitZ();
    rotation_ = (rotation_between(faces, -at.normal) * from.rotation).normalized();
  }
  find_way(from, view, camera);
}

/// Straight to above the place where that is free; else towards the eye until it is before all
/// organs, first out to the side if it is behind one.
void SurfacePress::find_way(const Pose& from, const SceneView& view, const Camera& camera) {
  const Vec3 above = stood_off().position;
  const Vec3 eye = -camera.view_direction();
  const double clear = view.radius() + body_.reach + kStandOff;
  Vec3 at = from.position;
  const auto before_all = [&](const Vec3& p) {
    return Vec3(p + std::max(0.0, clear - (p - view.center()).dot(eye)) * eye);
  };
  if (first_on_way(view, at, above)) {
    if (first_on_way(view, at, before_all(at))) {
      const Vec3 from_center = at - view.center();
      const Vec3 aside = unit_or(from_center - from_center.dot(eye) * eye, camera.right());
      at += std::max(0.0, clear - from_center.dot(aside)) * aside;
      way_.push_back(at);
    }
    way_.push_back(before_all(at));
    way_.push_back(before_all(above));
  }
  way_.push_back(above);
}

Pose SurfacePress::pose_at(double depth) const {
  const double support = body_.support(rotation_, -place_.normal);
  return {place_.point + (support - depth) * place_.normal, rotation_};
}

void SurfacePress::drag(double way) {
  dragged_ = kPerDrag * way;
  depth_ = std::clamp(kFirstDepth + dragged_ + deepened_, -kStandOff, most_);
}

void SurfacePress::deepen(double by) {
  deepened_ = std::clamp(deepened_ + by, -most_ - kStandOff, most_);
  depth_ = std::clamp(kFirstDepth + dragged_ + deepened_, -kStandOff, most_);
}

Pose SurfacePress::wanted(const Vec3& position) {
  while (passed_ < way_.size() && (position - way_[passed_]).norm() < kNear) ++passed_;
  if (passed_ < way_.size()) return {way_[passed_], rotation_};
  return pose_at(depth_);
}

}  // namespace palpate::visualizer
