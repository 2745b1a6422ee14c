// One organ and its probes, driven from outside: contacts searched and the organ advanced in turn,
// as the processes do, and the processor time of the advances taken.
#pragma once

#include <span>
#include <vector>

#include "collision/contact_finder.h"
#include "deformation/organ_messages.h"
#include "deformation/world.h"

namespace palpate::chart {

/// Of this thread [s]: other jobs on the machine do not count.
double processor_time();

class Stage {
 public:
  /// @param scene  one organ; the probes' devices are not looked at
  /// @param poses  of the probes at the start
  /// @throws InputError as DeformationWorld, or if a probe's mesh cannot be loaded
  Stage(const scene::Scene& scene, const geometry::OrganShape& shape, std::vector<Pose> poses);

  /// One period of deformation, in which the probes move to `poses`.
  void advance(const std::vector<Pose>& poses);

  /// The probes stay until, over 0.1 s, no force changed by more than 2e-4 of it and the kinetic
  /// energy is below 1e-6 of the elastic energy; at most `longest` [s].
  void settle(double longest);

  double period() const { return period_; }
  Vec3 force(std::uint32_t probe) const;  ///< on the probe in the last period [N]
  const NodePositions& nodes() const { return nodes_; }
  Vec3 position(std::size_t node) const;       ///< now [m]
  Vec3 rest_position(std::size_t node) const;  ///< [m]
  std::size_t node_count() const { return nodes_.positions.size() / 3; }
  const deformation::OrganModel& model() const { return world_.model(0); }
  double step() const { return period_ / world_.substeps(0, period_); }  ///< h [s]

  double volume_error() const { return volume_error_; }  ///< largest |V − V*|/V* so far
  bool diverged() const { return diverged_; }            ///< the world had to put the organ back
  double busy() const { return busy_; }            ///< processor time in deformation so far [s]
  double searching() const { return searching_; }  ///< the same in the search for contacts [s]
  double time() const { return world_.time(); }    ///< simulated so far [s]

 private:
  void search(std::uint32_t probe, double speed);

  scene::Rates rates_;
  double period_;
  collision::ContactFinder finder_;
  deformation::DeformationWorld world_;
  std::vector<Pose> poses_;
  NodePositions nodes_;
  std::vector<Vec3> positions_;
  Contacts contacts_;
  double volume_error_ = 0, busy_ = 0, searching_ = 0;
  bool diverged_ = false;
};

}  // namespace palpate::chart
