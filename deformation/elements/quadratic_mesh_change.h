// The state of quadratic tetrahedra carried from one mesh of halves to another.
//
// Positions: a node of both meshes keeps its own; a new one lies where the quadratic function of
// the tetrahedron that it is in had its place: the same shape as before. All ten nodes of a
// tetrahedron are nodes of its halves, so none is ever without a value.
//
// Velocities: the same values, and then each tetrahedron that is halved, or made of halves, takes
// over its own momentum. Lumped masses of quadratic tetrahedra are not those of their halves (four
// nodes have 1/36, six 4/27 of it), so the mean of what was found is set to what it was, and, if it
// would gain kinetic energy, the difference from the mean is made smaller. A node takes the mean of
// what its tetrahedra give it, by mass. So momentum stays what it was (what comes to a fixed node
// is taken by what holds it), an even motion stays one, and kinetic energy never grows: squares of
// means are no more than means of squares.
//
// Pressures, which each tetrahedron has one of: halves have that of the whole, a whole the mean of
// its halves, by volume.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "deformation/model/organ_model.h"
#include "deformation/model/organ_state.h"
#include "modules/core/simd_vectors.h"

namespace palpate::deformation {

class QuadraticMeshChange {
 public:
  /// @param from, to  quadratic; outlive this
  /// @param from_halvings, to_halvings  of their tetrahedra, see geometry::HalvedMesh
  QuadraticMeshChange(const OrganModel& from, std::span<const std::uint8_t> from_halvings,
                      const OrganModel& to, std::span<const std::uint8_t> to_halvings);

  OrganState carried(const OrganState& state) const;
  /// How far nodes go, zero of fixed ones  (node_count of `from`, of `to`).
  std::vector<Vec4f> carried(const std::vector<Vec4f>& ways) const;

 private:
  /// Of a tetrahedron's mass.
  struct Share {
    std::uint32_t node = 0;
    double mass = 0;  ///< [kg]
  };
  /// What is one tetrahedron on one mesh and several on the other.
  struct Part {
    std::vector<Share> before, after;
  };
  /// Rows of tetrahedra that fill the same place, one of them alone.
  struct Row {
    std::size_t from = 0, from_end = 0, to = 0, to_end = 0;
  };
  struct Coming {
    std::uint32_t node = 0;              ///< of `to`
    std::array<std::uint32_t, 10> in{};  ///< nodes of `from`
    std::array<double, 10> shape{};      ///< their functions there
  };

  void find_parts(std::span<const std::uint8_t> from_halvings,
                  std::span<const std::uint8_t> to_halvings);
  void find_coming(std::size_t in, std::size_t first, std::size_t end, std::vector<bool>& found);
  Eigen::VectorXd carried(const Eigen::VectorXd& pressures) const;
  void hand_over(const Part& part, const std::vector<Vec3>& before, const std::vector<Vec3>& found,
                 std::vector<Vec3>& velocities) const;

  const OrganModel& from_;
  const OrganModel& to_;
  std::vector<std::uint32_t> kept_;  ///< of each node of `to` the same one of `from`
  std::vector<Coming> coming_;
  std::vector<Part> parts_;
  std::vector<Row> rows_;
};

}  // namespace palpate::deformation
