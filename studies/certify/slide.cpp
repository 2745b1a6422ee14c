#include "studies/certify/slide.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "haptics/devices/trajectory.h"
#include "modules/geometry/probe_form.h"
#include "modules/scene/probe_shape.h"
#include "studies/certify/press.h"

namespace palpate::certify {
namespace {

constexpr double kApart = 0.02;     // of rows [m]
constexpr double kStep = 2e-3;      // along a row [m]
constexpr double kLift = 0.01;      // above the skin between rows [m]
constexpr double kSteepest = 1.19;  // tan 50°
constexpr double kFromHeld = 0.01;  // and the tip's radius [m]
constexpr double kShortest = 0.02;  // of a row [m]
constexpr double kTravel = 0.15;    // between rows [m/s]
constexpr double kNone = std::numeric_limits<double>::infinity();

bool is_inside(const scene::Region& region, const Vec3& p, double margin) {
  if (const auto* sphere = std::get_if<scene::SphereRegion>(&region)) {
    return (p - sphere->center).norm() < sphere->radius + margin;
  }
  const auto& box = std::get<scene::BoxRegion>(region);
  return ((p - box.min).array() > -margin).all() && ((box.max - p).array() > -margin).all();
}

/// How far a ball may go along `into` before it touches the surface at rest.
class Relief {
 public:
  Relief(const Subject& subject, double radius)
      : into_(subject.place.into),
        radius_(radius),
        right_(into_.unitOrthogonal()),
        up_(into_.cross(right_)),
        origin_(subject.place.pose.position),
        centre_(subject.place.tip - radius * into_) {
    const auto& surface = subject.assets.organs[subject.place.organ].surface;
    for (const auto& [a, b, c] : surface.triangles) {
      add(surface.nodes[a], surface.nodes[b], surface.nodes[c]);
    }
  }

  Vec3 place(double u, double v, double depth) const {
    return origin_ + u * right_ + v * up_ + depth * into_;
  }
  /// Depth of the ball's place under the origin's as it touches; kNone beside the surface.
  double touch(double u, double v) const {
    double least = kNone;
    for (const Vec3& p : points_) {
      const double aside = (u - p.x()) * (u - p.x()) + (v - p.y()) * (v - p.y());
      if (aside >= radius_ * radius_) continue;
      least = std::min(least, p.z() - std::sqrt(radius_ * radius_ - aside));
    }
    return least == kNone ? kNone : least - here_;
  }
  /// Depths count from the place of touch. @param margin  around the surface, in u and v
  void begin_here(double margin) {
    here_ = touch(0, 0);
    for (const Vec3& p : points_) {
      low_ = low_.cwiseMin(p.head<2>());
      high_ = high_.cwiseMax(p.head<2>());
    }
    low_.array() -= margin;
    high_.array() += margin;
  }
  const Eigen::Vector2d& low() const { return low_; }
  const Eigen::Vector2d& high() const { return high_; }

 private:
  /// Points of a triangle, dense against the ball.
  void add(const Vec3& a, const Vec3& b, const Vec3& c) {
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    const int parts = std::max(1, static_cast<int>(std::ceil(4 * longest / radius_)));
    for (int i = 0; i <= parts; ++i) {
      for (int j = 0; i + j <= parts; ++j) {
        const Vec3 off = a + double(i) / parts * (b - a) + double(j) / parts * (c - a) - centre_;
        points_.emplace_back(off.dot(right_), off.dot(up_), off.dot(into_));
      }
    }
  }

  Vec3 into_;
  double radius_;
  Vec3 right_, up_, origin_, centre_;
  std::vector<Vec3> points_;  ///< along right, up, into
  double here_ = 0;
  Eigen::Vector2d low_ = Eigen::Vector2d::Constant(kNone);
  Eigen::Vector2d high_ = Eigen::Vector2d::Constant(-kNone);
};

/// The longest stretch of a row that can be slid over, as places of the probe at touch.
std::vector<Vec3> stretch_of(const Relief& relief, const Subject& subject, double v,
                             double margin) {
  std::vector<Vec3> longest, stretch;
  const auto& fixed = subject.scene.organs[subject.place.organ].fixed;
  double before = kNone;
  for (double u = relief.low().x(); u <= relief.high().x(); u += kStep) {
    const double depth = relief.touch(u, v), across = relief.touch(u, v + kStep);
    const Vec3 place = relief.place(u, v, depth == kNone ? 0 : depth);
    const double lean = std::hypot((depth - before) / kStep, (across - depth) / kStep);
    const bool held = std::any_of(fixed.begin(), fixed.end(), [&](const scene::Region& region) {
      return is_inside(region, place, margin);
    });
    before = depth;
    if (!(lean < kSteepest) || held) {
      stretch.clear();
      continue;
    }
    stretch.push_back(place);
    if (stretch.size() > longest.size()) longest = stretch;
  }
  return longest;
}

}  // namespace

std::vector<haptics::TimedPose> slide_path(const Subject& subject, int rows) {
  const double radius = geometry::tip_radius(scene::form_of(subject.scene.probes[0].shape));
  std::vector<haptics::TimedPose> path;
  if (radius <= 0) return path;
  Relief relief(subject, radius);
  relief.begin_here(radius);
  double time = 0;
  const auto go_to = [&](const Vec3& place, double speed) {
    if (!path.empty()) {
      time += std::max(1e-3, (place - path.back().pose.position).norm() / speed);
    }
    path.push_back({time, {place, subject.place.pose.rotation}});
  };
  std::vector<double> lines{0};
  for (int i = 1; rows == 0 || i < rows; ++i) {
    const double v = (i % 2 == 1 ? 1 : -1) * ((i + 1) / 2) * kApart;
    if (v > relief.high().y() && -v < relief.low().y()) break;
    if (v < relief.low().y() && -v > relief.high().y()) break;
    lines.push_back(v);
  }
  for (std::size_t i = 0; i < lines.size(); ++i) {
    auto stretch = stretch_of(relief, subject, lines[i], radius + kFromHeld);
    if (static_cast<double>(stretch.size()) * kStep < kShortest) continue;
    if (i % 2 == 1) std::reverse(stretch.begin(), stretch.end());
    const Vec3 lift = -kLift * subject.place.into, press = subject.depth / 2 * subject.place.into;
    go_to(stretch.front() + lift, kTravel);
    for (const Vec3& place : stretch) go_to(place + press, subject.speed);
    go_to(stretch.back() + lift, subject.speed);
  }
  return path;
}

namespace {

/// Along a path that it was given.
class PathDevice final : public haptics::Device {
 public:
  explicit PathDevice(const std::vector<haptics::TimedPose>& path) : path_(path, false) {}
  haptics::DeviceSample read(double time) override { return path_.at(time); }
  double duration() const { return path_.duration(); }

 private:
  haptics::Trajectory path_;
};

}  // namespace

double SlideTick::over() const { return step / std::max(kFeltStep, kFeltShare * force); }

std::vector<SlideTick> slide(const Loop& loop, const std::vector<haptics::TimedPose>& path,
                             const KeepGoing& keep_going) {
  scene::Scene scene = loop.scene;
  scene.probes.at(0).device =
      scene::ScriptedDevice{path.front().pose.position, path.front().pose.rotation, {}};
  session::InProcess session(scene, loop.assets, loop.options);
  auto device = std::make_unique<PathDevice>(path);
  const double end = device->duration() + 0.3;
  session.haptics().set_device(0, std::move(device));
  std::vector<SlideTick> ticks;
  Vec3 before = Vec3::Zero();
  while (session.time() < end) {
    keep_going();
    const double time = session.time();
    session.tick();
    const Vec3 force = session.haptic_force(0).force;
    ticks.push_back({time, session.probe(0).pose.position, force.norm(), (force - before).norm()});
    before = force;
  }
  return ticks;
}

Line slide_line(const std::vector<SlideTick>& ticks) {
  const std::string group = "sliding", name = "largest step between ticks, whole organ";
  if (ticks.empty()) return not_measured(group, name, "the probe has no round tip");
  const auto worst = std::max_element(
      ticks.begin(), ticks.end(), [](const auto& a, const auto& b) { return a.over() < b.over(); });
  const auto over = std::count_if(ticks.begin(), ticks.end(),
                                  [](const SlideTick& tick) { return tick.over() > 1; });
  const Vec3& at = worst->position;
  return at_most(
      group, {name, worst->step, std::max(kFeltStep, kFeltShare * worst->force), "N",
              "5 % of the force or 0.05 N, docs/certify.md",
              fmt::format("{} of {} ticks over it; the worst at {:.3f} s, "
                          "({:.3f}, {:.3f}, {:.3f}) m, of {:.3f} N",
                          over, ticks.size(), worst->time, at.x(), at.y(), at.z(), worst->force)});
}

}  // namespace palpate::certify
