#include "studies/fuzz/organ_watch.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "deformation/contact/probe_contacts.h"
#include "deformation/organ_messages.h"
#include "studies/fuzz/faults.h"
#include "studies/fuzz/outcome.h"

namespace palpate::fuzz {
namespace {

constexpr double kFarthest = 1000;  // [m]
/// Root mean square of the nodes' speeds beside their mean's: what moves them is no faster.
constexpr double kShaking = deformation::kMaxProbeSpeed;  // [m/s]

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

OrganWatch::OrganWatch(const deformation::DeformationWorld& world, std::size_t organ, double size,
                       double period)
    : world_(world), organ_(organ), size_(size), period_(period) {
  take_positions(deformation::surface_message(world, organ).rest_positions, rest_);
  look(false);
}

void OrganWatch::look(bool replaced) {
  before_ = seen_;
  deformation::write_node_positions(world_, organ_, nodes_);
  if (const char* field = refusal(nodes_)) {
    throw Failure{fmt::format("node positions not sound ({}): of organ {}, energies {} J and {} J",
                              field, organ_, nodes_.kinetic_energy, nodes_.elastic_energy)};
  }
  take_positions(nodes_.positions, seen_);
  look_at_nodes(replaced);
}

void OrganWatch::look_at_nodes(bool replaced) {
  double fastest = 0, farthest = 0, away = 0;
  for (std::size_t n = 0; n < seen_.size(); ++n) {
    farthest = std::max(farthest, seen_[n].norm());
    away = std::max(away, (seen_[n] - rest_[n]).norm());
    if (!before_.empty()) fastest = std::max(fastest, (seen_[n] - before_[n]).norm());
  }
  const double way = deformation::kMaxNodeSpeed * period_ + 0.1 * size_;
  if (farthest > kFarthest) throw Failure{fmt::format("node far away: {} m", farthest)};
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
  const double shaking = std::sqrt(std::max(0.0, squares - mean.squaredNorm()));
  if (shaking > kShaking) throw Failure{fmt::format("shaking: {} m/s", shaking)};
  if (largest_distance(seen_) > deformation::kMaxGrowth * largest_distance(rest_)) {
    throw Failure{"grown: organ"};
  }
  const auto& triangles = world_.model(organ_).triangles;
  if (nodes_.volume < -deformation::kTurnedVolume * geometry::enclosed_volume(rest_, triangles)) {
    throw Failure{"turned inside out: organ"};
  }
}

}  // namespace palpate::fuzz
