#include "deformation/pressed_copy.h"

namespace palpate::deformation {

std::optional<double> PressedCopy::kept(std::size_t probe) const {
  if (probe >= kept_.size() || !kept_[probe] || advances_ - kept_[probe]->at >= every_) return {};
  return kept_[probe]->scale;
}

void PressedCopy::keep(std::size_t probe, double scale) {
  if (probe >= kept_.size()) kept_.resize(probe + 1);
  kept_[probe] = {scale, advances_};
}

double PressedCopy::stiffness(const SimulatedOrgan& simulated, SurfaceWalk& surface,
                              std::uint32_t organ, std::span<const ProbeContacts> probes,
                              std::size_t pressed, const Vec3& into, double period) {
  if (simulated.contacts_suspended()) return 0;
  const auto force = [&](double off) {
    return force_after(simulated, surface, organ, probes, pressed, off * into, period);
  };
  return (force(-kOff) - force(kOff)).dot(into) / (2 * kOff);
}

Vec3 PressedCopy::force_after(const SimulatedOrgan& simulated, SurfaceWalk& surface,
                              std::uint32_t organ, std::span<const ProbeContacts> probes,
                              std::size_t pressed, const Vec3& further, double period) {
  state_ = simulated.state();
  probes_.assign(probes.begin(), probes.end());
  for (std::size_t i = 0; i < probes_.size(); ++i) {
    Pose pose = probes_[i].pose();
    pose.position += probes_[i].went();
    if (i == pressed) pose.position += further;
    probes_[i].set_pose(pose);
    probes_[i].begin(period);
  }
  const int steps = simulated.substeps(period);
  const double h = period / steps;
  for (int step = 1; step <= steps; ++step) {
    rows_.clear();
    for (auto& probe : probes_) {
      probe.append_rows(organ, surface, state_, h, static_cast<double>(step) / steps, rows_);
    }
    simulated.dynamics().step(h, rows_, state_);
    for (auto& probe : probes_) probe.take_rows(organ, h, rows_);
  }
  return probes_[pressed].impulse() / period;
}

}  // namespace palpate::deformation
