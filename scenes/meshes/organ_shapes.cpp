#include "scenes/meshes/organ_shapes.h"

#include <algorithm>
#include <cmath>

#include "modules/geometry/mesh_prepare.h"
#include "modules/geometry/primitives.h"
#include "scenes/meshes/level_set.h"

namespace palpate::meshes {
namespace {

using geometry::TriangleSurface;

struct Section {
  Vec3 centre;
  double radius;
};

/// Union with a fillet about `width` [m] wide (quadratic smooth minimum).
double join(double a, double b, double width) {
  const double overlap = std::max(0.0, width - std::abs(a - b)) / width;
  return std::min(a, b) - overlap * overlap * width / 4;
}

/// `a` without the inside of `b`, the edge rounded over about `width` [m].
double carve(double a, double b, double width) { return -join(-a, b, width); }

/// Distance to a cone with round ends between two sections (the axis' nearest point taken).
double segment_distance(const Vec3& p, const Section& from, const Section& to) {
  const Vec3 axis = to.centre - from.centre;
  const double along = std::clamp((p - from.centre).dot(axis) / axis.squaredNorm(), 0.0, 1.0);
  return (p - from.centre - along * axis).norm() - from.radius - along * (to.radius - from.radius);
}

double ellipsoid_distance(const Vec3& p, const Vec3& centre, const Vec3& half_axes) {
  const Vec3 scaled = (p - centre).cwiseQuotient(half_axes);
  const Vec3 slope = scaled.cwiseQuotient(half_axes);
  const double length = scaled.norm();
  return slope.norm() == 0 ? -half_axes.minCoeff() : length * (length - 1) / slope.norm();
}

/// Catmull–Rom interpolation with `steps` pieces per interval.
std::vector<Section> smooth_curve(const std::vector<Section>& sections, int steps) {
  std::vector<Section> curve;
  const auto last = static_cast<int>(sections.size()) - 1;
  const auto at = [&](int i) { return sections[std::clamp(i, 0, last)]; };
  const auto blend = [](const auto& p0, const auto& p1, const auto& p2, const auto& p3, double t) {
    return ((2 * p1) + (p2 - p0) * t + (2 * p0 - 5 * p1 + 4 * p2 - p3) * (t * t) +
            (3 * p1 - p0 - 3 * p2 + p3) * (t * t * t)) /
           2;
  };
  for (int i = 0; i < last; ++i) {
    const Section s0 = at(i - 1), s1 = at(i), s2 = at(i + 1), s3 = at(i + 2);
    for (int step = 0; step < steps; ++step) {
      const double t = static_cast<double>(step) / steps;
      curve.push_back({Vec3(blend(s0.centre, s1.centre, s2.centre, s3.centre, t)),
                       blend(s0.radius, s1.radius, s2.radius, s3.radius, t)});
    }
  }
  curve.push_back(sections.back());
  return curve;
}

double tube_distance(const Vec3& p, const std::vector<Section>& curve) {
  double nearest = segment_distance(p, curve[0], curve[1]);
  for (std::size_t i = 1; i + 1 < curve.size(); ++i) {
    nearest = std::min(nearest, segment_distance(p, curve[i], curve[i + 1]));
  }
  return nearest;
}

TriangleSurface stomach_level_set() {
  return level_set_surface(stomach_shape, {Vec3(-0.11, -0.06, -0.10), Vec3(0.09, 0.06, 0.11)},
                           0.002);
}

}  // namespace

double stomach_shape(const Vec3& p) {
  static const std::vector<Section> kBody = smooth_curve({{{0.0337, 0.0150, 0.0636}, 0.0187},
                                                          {{0.0355, 0.0122, 0.0505}, 0.0262},
                                                          {{0.0355, 0.0075, 0.0281}, 0.0285},
                                                          {{0.0318, 0.0019, 0.0019}, 0.0271},
                                                          {{0.0234, -0.0037, -0.0262}, 0.0248},
                                                          {{0.0056, -0.0084, -0.0486}, 0.0224},
                                                          {{-0.0196, -0.0094, -0.0561}, 0.0196},
                                                          {{-0.0411, -0.0056, -0.0486}, 0.0154},
                                                          {{-0.0552, 0.0000, -0.0365}, 0.0108},
                                                          {{-0.0626, 0.0056, -0.0252}, 0.0098},
                                                          {{-0.0673, 0.0112, -0.0131}, 0.0122}},
                                                         5);
  static const std::vector<Section> kOesophagus =
      smooth_curve({{{0.0168, 0.0075, 0.0337}, 0.0122},
                    {{0.0037, 0.0075, 0.0468}, 0.0094},
                    {{-0.0047, 0.0075, 0.0617}, 0.0086},
                    {{-0.0075, 0.0075, 0.0785}, 0.0086}},
                   4);
  // A little flatter from front to back than it is wide.
  const Vec3 q(p.x(), p.y() / 0.92, p.z());
  return join(tube_distance(q, kBody), tube_distance(q, kOesophagus), 0.0112);
}

double liver_shape(const Vec3& p) {
  const double right = ellipsoid_distance(p, {-0.0359, 0.0000, -0.0057}, {0.0728, 0.0643, 0.0794});
  const double left = ellipsoid_distance(p, {0.0454, -0.0170, 0.0321}, {0.0737, 0.0435, 0.0321});
  double liver = join(right, left, 0.0473);
  // The hollow underside looks down, back and to the left: what it leaves is a wedge, thick at
  // the upper right and thin along the lower front margin and in the left lobe.
  const Vec3 underside = Vec3(0.48, 0.46, -0.75).normalized();
  const double hollow_radius = 0.2079;
  const Vec3 hollow_centre = Vec3(0.0000, 0.0000, -0.0095) + hollow_radius * underside;
  liver = carve(liver, (p - hollow_centre).norm() - hollow_radius, 0.0208);
  const double spine = Vec3(p.x() - 0.0189, p.y() - 0.0756, 0).norm() - 0.0359;
  liver = carve(liver, spine, 0.0283);
  const double gallbladder_bed = segment_distance(p, {{-0.0113, -0.0803, -0.0775}, 0.0151},
                                                  {{0.0038, -0.0142, -0.0208}, 0.0076});
  return carve(liver, gallbladder_bed, 0.0170);
}

TriangleSurface make_ball_mesh() { return geometry::make_ball(0.05, 3); }

TriangleSurface make_stomach_mesh() { return geometry::resample_surface(stomach_level_set(), 550); }

TriangleSurface make_stomach_refined_mesh() {
  return geometry::resample_surface(stomach_level_set(), 19'362);
}

TriangleSurface make_liver_mesh() {
  const Eigen::AlignedBox3d box(Vec3(-0.15, -0.11, -0.13), Vec3(0.17, 0.11, 0.13));
  return geometry::resample_surface(level_set_surface(liver_shape, box, 0.004), 544);
}

}  // namespace palpate::meshes
