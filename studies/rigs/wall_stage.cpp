#include "studies/rigs/wall_stage.h"

#include <algorithm>

namespace palpate::rigs {
namespace {

constexpr double kSoftest = 1e6;  // of a bare force, which does not vary [m/N]

}  // namespace

WallStage::WallStage(bus::Bus& bus, double stiffness, bool local_model)
    : states_(bus.reader(bus::kProbeState)),
      models_(bus.writer(bus::kContactModel)),
      stiffness_(stiffness) {
  model_.validity_radius = 0.05;
  model_.rows.resize(1);
  model_.compliance = {local_model ? 1 / stiffness : kSoftest};
  model_.stiffness(2, 2) = 1 / model_.compliance[0];
}

runtime::Health WallStage::cycle(const runtime::Cycle& now) {
  while (states_.take(state_)) {
    const double z = state_.pose.position.z();
    model_.anchor = state_.pose;
    model_.rows[0].gap = std::max(0.0, z);
    model_.rows[0].force.z() = std::max(0.0, -stiffness_ * z);
  }
  model_.period = now.advance;
  model_.header = now.header();
  models_.write(model_);
  return {};
}

}  // namespace palpate::rigs
