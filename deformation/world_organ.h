// One organ of a world: its simulation, the rows on it, and what a period's force on those rows
// does.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "deformation/contact/outer_seat.h"
#include "deformation/contact/patch_compliance.h"
#include "deformation/contact/surface_walk.h"
#include "deformation/following_organ.h"
#include "deformation/models.h"
#include "deformation/pressed_copy.h"
#include "deformation/simulated_organ.h"
#include "deformation/springs/patch_springs.h"
#include "modules/geometry/organ_shape.h"
#include "modules/scene/scene.h"

namespace palpate::deformation {

/// What a world keeps of an organ.
struct WorldOrgan {
  std::string name;
  SimulatedOrgan simulated;
  IntegratorChoice integrator;
  ChunkRunner* runner = nullptr;  ///< none: the calling thread alone
  std::uint32_t generation = 1;
  std::vector<ContactRow> rows = {};
  SimulatedOrgan::Mark start = {};  ///< of a step with other organs that may be taken back
  double mean_edge = 0;             ///< of the surface at rest [m]
  bool keeps_volume = false;        ///< by springs' contents: at once, wherever it is touched
  bool tells_mesh_error = false;    ///< as ModelRow
  bool replaced = false;            ///< its state, at the end of the last advance
  std::unique_ptr<PatchCompliance> compliance = nullptr;
  std::unique_ptr<PatchSprings> springs = nullptr;  ///< none: a solid
  std::unique_ptr<SurfaceWalk> surface = nullptr;
  std::unique_ptr<PressedCopy> copy = nullptr;  ///< none: its matrix tells what it resists
  // Buffers of contact_compliance():
  VolumeGradient volume = {};
  std::vector<Vec3> positions_ahead = {};
  std::unique_ptr<FollowingOrgan> following = nullptr;  ///< none: it keeps its mesh
  /// Of its mesh, where it follows: the middles' ends.
  std::vector<geometry::HalvedMesh::Parents> parents = {};
  std::vector<std::uint8_t> halvings = {};  ///< of its tetrahedra, where it follows
  bool is_coarser = false;                  ///< its mesh, than it should be under a probe

  /// C A⁻¹ Cᵀ of rows on this organ over a period [m/N], symmetric, one row and column each.
  /// @param period  [s], above 0
  Eigen::MatrixXd contact_compliance(std::span<const ComplianceRow> touched, double period);

  /// Of one that follows: goes on with the mesh that was made for it.
  /// @param outside  cores of probes that it must not put its wall around
  void change_mesh(std::span<const CoreLine> outside);
  /// Between two advances; one that follows takes its mesh when it reads.
  void exchange(StateArchive& archive);
  /// At rest, at time 0, with the next generation; one that follows with its coarse mesh.
  void reset();

 private:
  friend WorldOrgan make_organ(const scene::Scene&, std::size_t, const geometry::OrganShape&,
                               ChunkRunner*, Guarding);
  bool is_stale(const StepMatrix& last, std::span<const ComplianceRow> touched) const;
  bool look_ahead(double time);
  void take_volume_ahead();
  void take(OrganMesh mesh, std::span<const CoreLine> outside);
  void know_model();
};

/// Organ `index` of a scene at rest. In a scene whose organs may touch, springs whose integrator is
/// left open take symplectic Euler, the one that contacts with organs know.
/// @param shape  closed, outward, in W [m]
/// @param runner  outlives the organ; none: the calling thread alone
/// @throws InputError naming the organ if it cannot be simulated (all nodes fixed, stable step
///         below 1 µs, …)
WorldOrgan make_organ(const scene::Scene& scene, std::size_t index,
                      const geometry::OrganShape& shape, ChunkRunner* runner, Guarding guarding);

}  // namespace palpate::deformation
