#include "studies/fuzz/organ_watch.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "deformation/guard/divergence_detector.h"
#include "modules/core/tolerances.h"
#include "studies/fuzz/outcome.h"

namespace palpate::fuzz {
namespace {

/// Root mean square of the nodes' speeds beside their mean's: what moves them is no faster. Of the
/// surface from advance to advance, or of all nodes in the last step: what turns round in each is
/// not seen otherwise.
constexpr double kShaking = kMaxProbeSpeed;  // [m/s]

void take_positions(const std::vector<float>& xyz, std::vector<Vec3>& out) {
  out.resize(xyz.size() / 3);
  for (std::size_t n = 0; n < out.size(); ++n) {
    out[n] = Eigen::Map<const Eigen::Vector3f>(&xyz[3 * n]).cast<double>();
  }
}

double largest_distance(const std::vector<Vec3>& nodes) {
  double squared = 0;
  for (const Vec3& p : nodes) squared = std::max(squared, (p - nodes[0]).squaredNorm());
  return std::sqrt(squared);
}

}  // namespace

OrganWatch::OrganWatch(const SurfaceTopology& surface, double size, double mass, double period)
    : size_(size), mass_(mass), period_(period), triangles_(surface.triangles) {
  take_positions(surface.rest_positions, rest_);
  seen_ = rest_;
}

void OrganWatch::look(const NodePositions& nodes, bool replaced) {
  before_ = seen_;
  take_positions(nodes.positions, seen_);
  volume_ = nodes.volume;
  kinetic_energy_ = nodes.kinetic_energy;
  double fastest = 0, farthest = 0, away = 0;
  for (std::size_t n = 0; n < seen_.size(); ++n) {
    farthest = std::max(farthest, seen_[n].norm());
    away = std::max(away, (seen_[n] - rest_[n]).norm());
    if (!before_.empty()) fastest = std::max(fastest, (seen_[n] - before_[n]).norm());
  }
  const double way = deformation::kMaxNodeSpeed * period_ + 0.1 * size_;
  if (farthest > kWorldReach) throw Failure{fmt::format("node far away: {} m", farthest)};
  if (!replaced && fastest > way) {
    throw Failure{fmt::format("node too fast: {} m in a period of {} s", fastest, period_)};
  }
  if (!replaced && away == 0 && away_ > 0.01 * size_) throw Failure{"silent reset: organ"};
  away_ = away;
}

void OrganWatch::look_last() const {
  Vec3 mean = Vec3::Zero();
  double squares = 0;
  const auto count = static_cast<double>(seen_.size());
  for (std::size_t n = 0; n < seen_.size(); ++n) {
    const Vec3 velocity = before_.empty() ? Vec3::Zero() : Vec3((seen_[n] - before_[n]) / period_);
    mean += velocity / count;
    squares += velocity.squaredNorm() / count;
  }
  squares = std::max(squares, 2 * kinetic_energy_ / mass_);
  const double shaking = std::sqrt(std::max(0.0, squares - mean.squaredNorm()));
  if (shaking > kShaking) throw Failure{fmt::format("shaking: {} m/s", shaking)};
  if (largest_distance(seen_) > deformation::kMaxGrowth * largest_distance(rest_)) {
    throw Failure{"grown: organ"};
  }
  if (volume_ < -deformation::kTurnedVolume * geometry::enclosed_volume(rest_, triangles_)) {
    throw Failure{"turned inside out: organ"};
  }
}

}  // namespace palpate::fuzz
