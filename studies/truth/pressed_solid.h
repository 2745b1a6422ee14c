// One mesh of an organ at rest under rigid probes without friction, by quadratic elements: of a
// solid or of a wall that is filled with fluid.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "deformation/contact/rigid_contact.h"
#include "deformation/steppers/quasi_static_newton.h"
#include "modules/geometry/probe_form.h"

namespace palpate::truth {

/// A solid of one tissue, meshed with linear tetrahedra that are as large as its surface has them.
struct Body {
  geometry::TetMesh mesh;  ///< in W [m]
  deformation::ElasticConstants tissue;
  std::function<bool(const Vec3&)> is_fixed;  ///< of a place at rest
  bool is_filled = false;                     ///< its cavities, with one incompressible fluid
};

/// The probes, in W.
using Station = std::vector<geometry::RoundedSegment>;

struct Equilibrium {
  std::vector<Vec3> forces;         ///< on the probes [N]
  std::vector<Vec3> displacements;  ///< of the surface's points nearest to the marks [m]
};

/// Of the surface's points nearest to the marks, from rest [m].
std::vector<Vec3> displacements_at(const std::vector<Vec3>& marks,
                                   const deformation::TaylorHoodElements& solid,
                                   const deformation::SolidState& state);

class PressedSolid {
 public:
  /// @param stations  where probes will be: faces farther than four radii from all of them are not
  ///                  looked at
  PressedSolid(const geometry::TetMesh& mesh, const Body& body,
               const std::vector<Station>& stations);
  /// @param constrained  as QuasiStaticNewton
  PressedSolid(deformation::TaylorHoodElements solid, std::vector<char> constrained,
               const std::vector<Station>& stations, bool is_filled = false);
  PressedSolid(const PressedSolid&) = delete;
  PressedSolid& operator=(const PressedSolid&) = delete;

  deformation::SolidState rest_state() const { return solid_.rest_state(); }

  /// The equilibrium under probes at `to`, that `state` comes to when they move there in straight
  /// lines: by a soft contact, and where that leads to none, by a hard one.
  /// @param from  where `state` is an equilibrium, the last one looked for
  /// @param keep_going  as QuasiStaticNewton::solve()
  /// @param at          told after each stride what part of the way is done
  /// @returns false if none is found, however short the strides
  bool press(
      const Station& from, const Station& to, deformation::SolidState& state,
      const std::function<void()>& keep_going,
      const std::function<void(double part)>& at = [](double) {});

  /// The equilibrium under probes at `station`, from a state near it. @returns false if none is
  /// found, or one that has a probe's core behind its skin
  bool settle(
      const Station& station, deformation::SolidState& state,
      const std::function<void()>& keep_going = [] {});

  /// Of the last equilibrium.
  Equilibrium equilibrium(const deformation::SolidState& state,
                          const std::vector<Vec3>& marks) const;

  /// The state of a coarser mesh, of which this is a refinement, on this one.
  deformation::SolidState refined(const PressedSolid& coarser,
                                  const deformation::SolidState& state) const;

  std::size_t node_count() const { return solid_.mesh().nodes.size(); }

 private:
  /// Moves the probes stride by stride, an equilibrium after each.
  /// @param hardness  of the contact, see set_hardness()
  /// @returns false if Newton's method fails, however short the strides; `state` is then the last
  ///          equilibrium
  bool follow(const Station& from, const Station& to, double hardness,
              deformation::SolidState& state, const std::function<void()>& keep_going,
              const std::function<void(double part)>& at);
  /// The contact's penalty over 3 μ / R.
  void set_hardness(double hardness);
  bool is_behind_skin(const Station& station, const deformation::SolidState& state) const;

  deformation::TaylorHoodElements solid_;
  std::vector<std::uint32_t> cavity_;     ///< faces that fluid touches
  std::vector<geometry::Triangle> skin_;  ///< all others, by their corners
  deformation::RigidContact contact_;
  std::optional<deformation::EnclosedFluid> fluid_;
  std::vector<char> constrained_;  ///< per coordinate
  deformation::QuasiStaticNewton solver_;
  double radius_;  ///< of the smallest probe [m]
};

}  // namespace palpate::truth
