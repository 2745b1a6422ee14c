// All organs of a scene, advanced together. What the deformation process, the in-process pipeline
// and the benchmarks drive; knows no DDS, file, clock or thread.
#pragma once

#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "deformation/models.h"
#include "deformation/simulated_organ.h"
#include "modules/core/state_archive.h"
#include "modules/core/touch.h"
#include "modules/geometry/organ_shape.h"
#include "modules/scene/scene.h"

namespace palpate::deformation {

/// What an organ is at the moment. The span holds until the next advance() or reset().
struct OrganReading {
  std::span<const Vec3> positions;  ///< surface nodes, then the others, in W [m]
  double volume = 0;                ///< enclosed [m³]
  double target_volume = 0;         ///< V* [m³]
  double pressure = 0;              ///< of the contents over the outside, p = −λ [Pa]
  double kinetic_energy = 0;        ///< [J]
  std::size_t organ_contacts = 0;   ///< places where it presses on another organ or on itself
};

struct OrganMesh;
struct TouchedPlace;

class DeformationWorld {
 public:
  /// @param rest_shapes  one per organ of the scene, closed, outward, in W [m]
  /// @throws InputError naming the organ if it cannot be simulated (all nodes fixed, stable step
  ///         below 1 µs, …)
  /// @param runner  outlives the world; none: the calling thread alone. The bits are the same
  /// @param probe_meshes  one per probe, in its frame, empty but for a MeshShape [m]; or none
  DeformationWorld(const scene::Scene& scene, std::vector<geometry::OrganShape> rest_shapes,
                   ChunkRunner* runner = nullptr, Guarding guarding = Guarding::kOn,
                   const std::vector<geometry::TriangleSurface>& probe_meshes = {});
  ~DeformationWorld();
  DeformationWorld(DeformationWorld&&) noexcept;

  std::size_t organ_count() const;
  std::size_t probe_count() const;
  const std::string& name(std::size_t organ) const;  ///< as the scene calls it
  const OrganModel& model(std::size_t organ) const;
  /// Of its mesh; counts up from 1 with each reset, and where an organ follows with each change.
  std::uint32_t generation(std::size_t organ) const;
  /// What the organ will go on with in the next advance, to be told before; nullptr: as it is.
  const OrganMesh* next_mesh(std::size_t organ) const;
  /// What its next mesh, or else its present one, was made for; none: it keeps its mesh, or nothing
  /// is near.
  std::span<const TouchedPlace> touched_places(std::size_t organ) const;

  /// Newest pose X_WP of a probe. Contacts are carried along rigidly with it until the next ones.
  /// A probe the scene does not have is ignored.
  /// @param kept_within  its contacts are dropped if it went further than that [m]
  void set_probe(std::size_t probe, const Pose& pose,
                 double kept_within = std::numeric_limits<double>::infinity());
  /// Newest contacts of the probe they name; replaces those it had. Entries naming no organ or
  /// triangle of this world are ignored; those metres away from their tissue or probe are refused,
  /// too, and the next advance says so.
  /// @param generations  of each organ's mesh that they were found on; empty: of the present ones
  void set_contacts(const ContactSet& contacts, std::span<const std::uint32_t> generations = {});

  /// V*/V₀ of an organ from now on, until reset(), in place of the scene's filling; followed no
  /// faster than that.
  void ask_for_volume(std::size_t organ, double ratio);

  /// Whether a probe holds tissue without new contacts: a round one does wherever it goes, for each
  /// step looks around its core; others while no contact went further than `within` [m] from where
  /// it was found.
  bool holds_on(std::size_t probe, double within) const;
  /// Nobody knows where this probe touches any more: it touches nothing until set_contacts().
  void forget_contacts(std::size_t probe);

  /// Goes on with next_mesh() now, without an advance: who joins while the world stands is told
  /// that.
  void take_next_meshes();

  /// Advances every organ by `period` [s] in its stable sub-steps. Contacts hold unilaterally,
  /// with friction, inside the volume solve.
  AdvanceReport advance(double period);

  /// Back to rest at time 0; generations count up.
  void reset();

  double time() const;                          ///< simulated [s]
  double stable_step(std::size_t organ) const;  ///< largest sub-step the organ is given [s]
  int substeps(std::size_t organ, double period) const;
  const IntegratorChoice& integrator(std::size_t organ) const;

  /// After the last advance().
  OrganReading read(std::size_t organ) const;
  double elastic_energy(std::size_t organ) const;  ///< costs as much as a part of a step [J]
  /// OrganReading::positions alone, without what the rest costs to compute.
  std::span<const Vec3> positions(std::size_t organ) const;
  /// Mean force on a probe over the last advance() [N].
  const Vec3& force(std::size_t probe) const;
  /// How much too large that force is because of the solids' meshes, estimated (force_error.h):
  /// 0 … 1; 0: it presses on none whose model tells it. Takes some tenths of a millisecond.
  double estimated_force_error(std::size_t probe) const;
  /// That force row by row and how it varies with the probe's pose. Costs a small factorisation.
  /// @param bounded  out: its stiffness was bounded, or could not be found (contact_law.h)
  LocalLaw local_law(std::size_t probe, bool* bounded = nullptr) const;

  /// All that what follows depends on, between two advances; of a world of the same scene.
  void exchange(StateArchive& archive);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::deformation
