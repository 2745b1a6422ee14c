// What is seen of a world while something is done to it.
#pragma once

#include "deformation/organ_messages.h"
#include "tests/robustness/organs_under_test.h"

namespace palpate::deformation::testing {

/// All that was seen of a world while something was done to it.
struct Witness {
  Story story;
  double largest_force = 0, largest_pressure = 0, least_volume = 1;
  bool finite = true;
  bool contacts_suspended = false, probe_jumped = false;
  NodePositions nodes;
  ContactModel model;

  void advance(DeformationWorld& world) {
    const AdvanceReport report = world.advance(kPeriod);
    note(report, {}, story);
    contacts_suspended |= report.contacts_suspended;
    probe_jumped |= report.probe_jumped;
    deformation::write_node_positions(world, 0, nodes);
    for (const float x : nodes.positions) finite &= std::isfinite(x);
    finite &= std::isfinite(nodes.pressure) && std::isfinite(nodes.volume) &&
              std::isfinite(nodes.kinetic_energy) && std::isfinite(nodes.elastic_energy) &&
              nodes.target_volume >= 0;
    for (std::size_t probe = 0; probe < world.probe_count(); ++probe) {
      model = deformation::contact_model_message(world, probe);
      finite &= model.force().allFinite() && model.torque().allFinite() &&
                model.stiffness.allFinite() && model.anchor.position.allFinite() &&
                std::isfinite(model.growth) && std::isfinite(model.validity_radius);
      largest_force = std::max(largest_force, model.force().norm());
    }
    largest_pressure = std::max(largest_pressure, std::abs(nodes.pressure));
    least_volume = std::min(least_volume, nodes.volume);
  }

  double shape_error(const OrganModel& organ) const {
    std::vector<Vec3> positions(nodes.positions.size() / 3);
    for (std::size_t i = 0; i < positions.size(); ++i) {
      positions[i] = Eigen::Map<const Eigen::Vector3f>(&nodes.positions[3 * i]).cast<double>();
    }
    return testing::shape_error(organ, positions);
  }
};

/// Two plates close to `squeeze` of the diameter in 2 s, hold for 1 s, open in 0.5 s; 3 s pass.
inline Witness squeeze_and_release(DeformationWorld& world, double squeeze) {
  Witness witness;
  for (double time = 0; time < 6.5; time += kPeriod) {
    const double closed = time < 3 ? squeeze * std::min(time / 2, 1.0)
                                   : squeeze - (squeeze + 0.2) * std::min(2 * (time - 3), 1.0);
    for (std::uint32_t probe = 0; probe < 2; ++probe) {
      const int side = probe == 0 ? 1 : -1;
      const double height = side * kBallRadius * (1 - closed);
      world.set_contacts(plate_contacts(world, probe, height, side, 2e-3));
      world.set_probe(probe, Pose{Vec3(0, 0, height), Quat::Identity()});
    }
    witness.advance(world);
  }
  return witness;
}

}  // namespace palpate::deformation::testing
