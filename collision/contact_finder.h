// Contacts between probes and deforming surfaces over a swept step.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "modules/core/state_archive.h"
#include "modules/core/touch.h"
#include "modules/geometry/probe_form.h"
#include "modules/geometry/surface_blocks.h"

namespace palpate::collision {

/// Motion of a probe over the step: linear in position, constant rotation rate.
struct ProbeMotion {
  Pose pose_t0, pose_t1;
  Vec3 ahead_W = Vec3::Zero();  ///< its way on to the next search's contacts, as it moves now [m]
};

/// How many are handed out at most.
struct ContactLimits {
  std::size_t contacts = 0;  ///< beside faces
  std::size_t faces = 0, face_nodes = 0;
  std::size_t needed = 0;  ///< more than `contacts`, of those that the answer needs
};

/// What a search found out beside contacts.
struct SearchReport {
  bool begun_inside = false;  ///< first heard of inside an organ: the nearest wall pushes it out
  bool was_lost = false;      ///< inside an organ and touching nothing: likewise
  bool wall_was_cut = false;  ///< of a wall it is behind only the nearest part was looked at
  bool looked_less_ahead = false;  ///< of very much that it may come to, what is straight on
  bool was_cut = false;  ///< there was too much that it went past to look at all: truncated
};

/// Finds, for each probe, the places where it touches or may touch an organ before the next
/// search. Keeps, between calls, which side of a surface the probe came from, so that a probe
/// that was driven through a wall is pushed out the way it came in.
///
/// Deterministic: same calls, same contacts, sorted by (organ, triangle).
class ContactFinder {
 public:
  /// @param organ_triangles  of each organ; node indices refer to the positions of update_organ()
  /// @param blocks  of each organ the block of each triangle (geometry::SurfaceBlocks); none: they
  ///                are made of the first positions
  ContactFinder(std::vector<std::vector<geometry::Triangle>> organ_triangles,
                std::vector<geometry::ProbeForm> probes,
                const std::vector<std::vector<std::uint32_t>>& blocks = {});
  ~ContactFinder();

  /// New node positions of an organ [m]; at least as many as its triangles name.
  void update_organ(std::size_t organ, std::span<const Vec3> positions);
  /// The same with the wire's floats and the boxes of all blocks, without a look at any node: both
  /// are exchanged with buffers that are free. Without boxes they are made here.
  void take_organ(std::size_t organ, std::vector<float>& positions,
                  std::vector<geometry::BlockBox>& boxes);

  /// Other triangles of the same surface, until the next positions where they lie in those of now;
  /// what is remembered of the search is found again on them.
  /// @param rest_before, rest_after  of the surfaces' nodes at rest [m]
  /// @param blocks                   as at construction
  void change_organ(std::size_t organ, std::vector<geometry::Triangle> triangles,
                    std::span<const std::uint32_t> blocks, std::span<const Vec3> rest_before,
                    std::span<const Vec3> rest_after);

  /// Forgets what is remembered of earlier calls, of all probes or of one (reset, silence, jump):
  /// it is heard of for the first time again.
  void reset();
  void forget(std::size_t probe);

  /// Contacts of one probe that moved from pose_t0 to pose_t1 since the last call, all with
  /// gap ≤ margin at t1 or swept through in between. Weights and gap hold at pose_t1.
  /// Reduced (contact_reduction.h) to the limits.
  /// @param margin  how far tissue and probe may approach until the next search [m], > 0: twice the
  ///                way ahead, which may turn, and what tissue moves
  SearchReport find(std::size_t probe, const ProbeMotion& motion, double margin,
                    const ContactLimits& limits, ContactSet& result);

  /// Between two searches, of organs of the same triangles.
  void exchange(StateArchive& archive);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::collision
