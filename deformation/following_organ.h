// A solid of a world whose mesh follows the probes: what it will be, and what it was.
//
// A change takes two advances. At the end of one a mesh is made for where the probes will soon
// touch, so that its surface can be told to others; at the beginning of the next the organ goes on
// with it. What others found on the meshes before is carried over for a while.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "deformation/contact/patch_compliance.h"
#include "deformation/contact/touch_follower.h"
#include "deformation/model/following_mesh.h"
#include "deformation/model/organ_model.h"
#include "deformation/steppers/organ_dynamics.h"
#include "modules/core/state_archive.h"
#include "modules/core/touch.h"
#include "modules/geometry/surface_transfer.h"

namespace palpate::deformation {

/// A mesh that an organ does not have yet, or has no more.
struct OrganMesh {
  std::uint32_t generation = 0;
  RefinedShape refined;
  std::unique_ptr<const OrganModel> model;
  std::unique_ptr<PatchCompliance> compliance;  ///< of the model
  std::unique_ptr<OrganDynamics> dynamics;      ///< of the model; none until the organ has the mesh
};

class FollowingOrgan {
 public:
  /// @param organ   as it is stepped; its solid.refine.follow
  /// @param coarse  in W [m]
  /// @param runner  outlives this; none: the calling thread alone
  FollowingOrgan(const scene::Scene& scene, scene::Organ organ, const geometry::OrganShape& coarse,
                 ChunkRunner* runner);

  /// Nothing was touched yet. @returns the coarse mesh
  OrganMesh begin(std::uint32_t generation);

  /// At the end of an advance: makes the next mesh if the probes will touch elsewhere.
  /// @param poses       of the probes, where they soon will be
  /// @param generation  of the next mesh
  void look(std::span<const Pose> poses, const OrganModel& model, std::span<const Vec3> positions,
            std::uint32_t generation);
  /// nullptr: the organ keeps the mesh it has.
  const OrganMesh* next() const { return next_ ? &*next_ : nullptr; }
  /// Of the newest mesh.
  std::span<const TouchedPlace> places() const { return places_; }
  /// The organ goes on with next(). @param model  that it had
  /// @param generation  of that
  OrganMesh take_next(std::uint32_t generation, const OrganModel& model);

  /// The surface before the last change on that after it.
  const geometry::SurfaceTransfer& last_transfer() const { return earlier_.back().transfer; }

  /// Contacts that were found on an earlier mesh are carried to that of now.
  /// @returns false if it is not remembered
  bool carry(std::uint32_t generation, Contact& contact) const;
  bool carry(std::uint32_t generation, std::uint32_t& node) const;

  /// Which meshes there are and were; when it reads, those that are to be are made anew.
  void exchange(StateArchive& archive, std::uint32_t generation);
  /// The mesh that the organ has, after exchange() has read.
  OrganMesh present(std::uint32_t generation);

 private:
  struct Earlier {
    std::uint32_t generation = 0;
    geometry::SurfaceTransfer transfer;  ///< to the one after it
    void exchange(StateArchive& archive) { archive(generation, transfer); }
  };
  OrganMesh made(std::uint32_t generation);
  /// Made no earlier, so that none of a change's advances does most of it.
  OrganMesh with_dynamics(OrganMesh mesh) const;
  std::size_t first_of(std::uint32_t generation) const;

  const scene::Organ organ_;
  const Vec3 gravity_;
  const double period_;  ///< of an advance [s]
  ChunkRunner* runner_;
  FollowingMesh mesh_;
  std::vector<TouchFollower> touches_;         ///< by probe
  std::vector<TouchedPlace> places_, newest_;  ///< that the newest mesh is made for
  std::vector<TouchedPlace> present_;          ///< that the organ's mesh is made for
  std::optional<OrganMesh> next_;
  std::deque<Earlier> earlier_;  ///< the newest last
};

}  // namespace palpate::deformation
