// All organs of a scene, advanced together. What the deformation process, the in-process pipeline
// and the benchmarks drive; knows no DDS, file, clock or thread.
#pragma once

#include <memory>
#include <vector>

#include "deformation/simulated_organ.h"
#include "deformation/steppers/organ_dynamics.h"
#include "modules/geometry/organ_shape.h"
#include "modules/messages/messages.h"
#include "modules/scene/scene.h"

namespace palpate::deformation {

class DeformationWorld {
 public:
  /// @param rest_shapes  one per organ of the scene, closed, outward, in W [m]
  /// @throws InputError naming the organ if it cannot be simulated (all nodes fixed, stable step
  ///         below 1 µs, …)
  /// @param runner  outlives the world; none: the calling thread alone. The bits are the same
  DeformationWorld(const scene::Scene& scene, std::vector<geometry::OrganShape> rest_shapes,
                   ChunkRunner* runner = nullptr, Guarding guarding = Guarding::kOn);
  ~DeformationWorld();
  DeformationWorld(DeformationWorld&&) noexcept;

  std::size_t organ_count() const;
  std::size_t probe_count() const;
  const SurfaceTopology& topology(std::size_t organ) const;  ///< header is the caller's to fill

  /// Newest pose of a probe. Contacts are carried along rigidly with it until the next contacts.
  void set_probe(const ProbeState& probe);
  /// Newest contacts of a probe; replaces those it had. Entries naming no organ or triangle of
  /// this world are ignored; those metres away from their tissue or probe are refused, too, and the
  /// next advance says so.
  void set_contacts(const Contacts& contacts);

  /// Advances every organ by `period` [s] in its stable sub-steps. Contacts hold unilaterally,
  /// with friction, inside the volume solve.
  AdvanceReport advance(double period);

  /// Back to rest at time 0; generations count up.
  void reset();

  double time() const;                          ///< simulated [s]
  double stable_step(std::size_t organ) const;  ///< largest sub-step the organ is given [s]
  int substeps(std::size_t organ, double period) const;
  const IntegratorChoice& integrator(std::size_t organ) const;

  /// Positions, volume, pressure and energies after the last advance(). Headers are the caller's.
  void write_node_positions(std::size_t organ, NodePositions& out) const;
  /// Mean force over the last advance() and how it varies with the probe's position.
  void write_contact_model(std::size_t probe, ContactModel& out) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::deformation
