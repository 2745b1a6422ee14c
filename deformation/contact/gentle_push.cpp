#include "deformation/contact/gentle_push.h"

#include <algorithm>

namespace palpate::deformation {
namespace {

/// Of the tissue towards the probe [m/s], along the row: as it moves, or as it moves beside a probe
/// that goes inwards.
double approach_of(const ContactRow& row, const OrganState& state) {
  const Vec3 velocity = at_tissue(row, state.velocities);
  const double tissue = row.normal.dot(velocity), probe = row.normal.dot(row.probe_velocity);
  return std::min(tissue, tissue - probe);
}

}  // namespace

double deepest_of(std::span<const ContactRow> rows) {
  double deepest = 0;
  for (const ContactRow& row : rows) deepest = std::max(deepest, -row.gap);
  return deepest;
}

bool GentlePush::soften(const OrganState& state, double h, bool inside,
                        std::span<ContactRow> rows) {
  const double deepest = deepest_of(rows);
  time_ += h;
  core_was_inside_ |= inside;
  if (deepest < kDepth || time_ > kTime) return false;
  if (time_ < kEnd) {
    for (const ContactRow& row : rows) approach_ = std::max(approach_, approach_of(row, state));
  } else {
    approach_ *= std::max(0.0, 1 - h / kEnd);
  }
  Vec3 outward = Vec3::Zero();
  for (const ContactRow& row : rows) outward += std::max(-row.gap, 0.0) * row.normal;
  const Vec3 push = std::min(kGentleSpeed, deepest / kEnd) * outward.normalized();
  const double change = std::min(1.0, h / kRise);
  for (ContactRow& row : rows) {
    const double speed = std::max(0.0, row.normal.dot(push));
    const double approach = std::max(std::min(approach_of(row, state), approach_), -speed);
    row.gap = std::max(row.gap, h * (approach - change * (approach + speed)));
  }
  return true;
}

}  // namespace palpate::deformation
