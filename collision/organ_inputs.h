// The organs' surfaces as deformation tells them, kept in a finder.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "collision/contact_finder.h"
#include "modules/bus/bus.h"
#include "modules/scene/scene.h"

namespace palpate::collision {

class OrganInputs {
 public:
  OrganInputs(bus::Bus& bus, std::vector<geometry::ProbeForm> probes,
              const std::vector<scene::Organ>& organs);

  void take();
  /// What was remembered of searches no longer holds, and nothing is known of where the organs are
  /// until positions are heard that were said since.
  void hear_anew(std::int64_t since_ns);

  /// nullptr until the surfaces of all organs are known.
  ContactFinder* finder() { return finder_ ? &*finder_ : nullptr; }
  /// Is it known of each organ where it is? One whose surface was told before the session's first
  /// cycle is at rest until it moves; of one heard of later, a surface alone does not tell how far
  /// it is deformed.
  bool placed() const;
  /// By organ: of the surface that is searched.
  void tell_generations(std::vector<std::uint32_t>& generations) const;
  /// Of node positions, as they come [s]; 0 before the second.
  double interval() const { return interval_; }
  /// Are the newest boxes of an organ so many that they cannot be its blocks'?
  bool boxes_misfit() const;

  void exchange(StateArchive& archive);

 private:
  struct OrganInput {
    bool follows = false;  ///< its mesh changes, sometimes inside alone
    std::uint32_t generation = 0;
    std::vector<geometry::Triangle> triangles;
    std::vector<std::uint32_t> triangle_blocks;
    std::size_t surface_node_count = 0;
    std::vector<float> rest_positions;  ///< x, y, z per node [m]
    std::size_t block_count = 0;        ///< of triangle_blocks
    /// Told, the newest last, but no positions have come that are of them. A mesh that changes in
    /// every advance has its next surface told together with the positions of the one before.
    std::vector<SurfaceTopology> next;
    bool boxes_misfit = false;  ///< of the newest node positions
    bool placed = false;        ///< see OrganInputs::placed()
    bool anew = false;          ///< its next positions are of another process
    std::int64_t came_ns = 0;   ///< source time of the newest positions; 0: none

    void exchange(StateArchive& archive);
    bool is_surface() const;  ///< by the rules of the wire; or none was heard
  };

  void take_surface();
  void take_positions();
  void take_next(std::size_t index, std::uint32_t generation);
  void put_at_rest(std::size_t organ);
  void make_finder();
  static void know(const SurfaceTopology& surface, OrganInput& organ);
  static std::vector<Vec3> rest_of(const OrganInput& organ);

  bus::Reader<SurfaceTopology> surfaces_;
  bus::Reader<NodePositions> positions_;
  std::vector<geometry::ProbeForm> probes_;
  std::vector<OrganInput> organs_;
  std::optional<ContactFinder> finder_;
  double interval_ = 0;
  std::int64_t since_ns_ = std::numeric_limits<std::int64_t>::min();  ///< see hear_anew()
  // Kept between calls for their memory only.
  SurfaceTopology surface_;
  NodePositions newest_;
  std::vector<geometry::BlockBox> boxes_;
};

}  // namespace palpate::collision
