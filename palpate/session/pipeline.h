// The whole simulation in one process, as plain function calls: no DDS, clock or thread. The same
// libraries as the processes, in a fixed order; same scene, same bits. Tests and benchmarks run it.
#pragma once

#include <memory>
#include <vector>

#include "collision/contact_finder.h"
#include "deformation/world.h"
#include "haptics/device.h"
#include "haptics/haptic_renderer.h"
#include "modules/messages/messages.h"
#include "modules/scene/scene.h"

namespace palpate::pipeline {

class Pipeline {
 public:
  /// @param organ_shapes  one per organ of the scene, in W [m]
  /// @param probe_meshes    one per probe, empty but for MeshShape [m]
  /// @throws InputError as the libraries do
  Pipeline(const scene::Scene& scene, std::vector<geometry::OrganShape> organ_shapes,
           std::vector<geometry::TriangleSurface> probe_meshes);
  ~Pipeline();
  Pipeline(Pipeline&&) noexcept;

  /// One haptic tick at time(); then collision and deformation, where a period of theirs begins.
  void tick();
  /// Ticks until time() ≥ `until` [s].
  void run_until(double until);

  double time() const;  ///< of the next tick [s]
  const deformation::DeformationWorld& world() const;
  const ProbeState& probe(std::size_t probe) const;
  const Contacts& contacts(std::size_t probe) const;
  const ContactModel& contact_model(std::size_t probe) const;
  const HapticForce& haptic_force(std::size_t probe) const;
  const NodePositions& node_positions(std::size_t organ) const;
  /// The device of a probe, for tests that drive a TopicDevice.
  haptics::Device& device(std::size_t probe);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Loads the meshes the scene names and builds the pipeline. @throws InputError
Pipeline load_pipeline(const scene::Scene& scene);

}  // namespace palpate::pipeline
