// A ball squeezed to half its width between two plates: the task both solvers get.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <string>

#include "deformation/model/organ_model.h"
#include "modules/geometry/triangle_surface.h"
#include "modules/scene/scene.h"

namespace palpate::bench {

inline constexpr double kBallRadius = 0.05;  ///< [m]
inline constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// What is squeezed. Both solvers get the springs, masses and triangles of `model`.
struct Ball {
  scene::Organ organ;
  geometry::TriangleSurface surface;
  deformation::OrganModel model;
};

/// R 5 cm, E 10 kPa, wall 3 mm, drag 2/s, nothing fixed.
/// @param nodes  162, 642, 2,562 …: an icosphere; else one resampled to as many
Ball make_bench_ball(std::size_t nodes);

/// A solver with the ball and the plates at ±height.
class Squeezer {
 public:
  virtual ~Squeezer() = default;
  /// Moves the plates to ±`height` at the step's end and advances by kStep.
  virtual void step(double height) = 0;
  /// Of the surface now, computed in double precision whatever the solver uses [m³].
  virtual double volume() const = 0;
  /// Of the contents [Pa]; NaN where the solver has none.
  virtual double pressure() const { return kNone; }
  /// With both plates, in the last step.
  virtual std::size_t contact_count() const = 0;
  /// Processor time of all steps so far, search for contacts left out [s]; NaN where the two are
  /// not timed apart.
  virtual double solver_seconds() const { return kNone; }
  /// Searches so far that left contacts out, or lost them.
  virtual std::uint64_t contacts_left_out() const { return 0; }
  /// The farthest any node is beyond a plate at ±height now [m].
  virtual double depth_beyond(double height) const = 0;
  /// Whether step() searches contacts as for any shape, not for these two plates only.
  virtual bool is_whole() const { return true; }
};

inline constexpr double kStep = 2e-3;  ///< h [s]

/// How the ball is squeezed: plates close with minimum jerk, as a scene's devices move, then stay.
struct Squeeze {
  double compression = 0.5;  ///< of the ball's width, at the end
  int closing_steps = 500;
  int holding_steps = 500;
};

/// Processor time per step, mean over a run [µs]. Only like is compared with like.
struct Cost {
  double solver = kNone;  ///< contacts given: forces, volume, contacts' response, motion
  double whole = kNone;   ///< with the search for contacts
};

struct Outcome {
  Cost cost;
  double peak = 0;           ///< largest |V−V₀|/V₀
  double held = 0;           ///< largest over the last fifth of the holding time
  double swing = 0;          ///< highest less lowest V/V₀ of that time
  double pressure = 0;       ///< of the contents at the end, by how much the ball resists [Pa]
  std::size_t contacts = 0;  ///< at the end, with both plates
  double beyond = 0;         ///< the farthest a node was beyond a plate in the holding time [m]
  std::uint64_t contacts_left_out = 0;  ///< searches; such a run is no result
  bool finite = true;
  /// "contacts left out", "stable", "swings" (the held volume by more than a twentieth),
  /// "collapsed" (no more than half of the volume is left: no longer the ball of the others) or
  /// "blew up".
  const char* verdict() const;
  bool stable() const;
};

/// Runs the squeeze from rest. @param keep_going  asked at each step; may throw to end the run
Outcome run(Squeezer& squeezer, const Squeeze& squeeze, const std::function<void()>& keep_going);

}  // namespace palpate::bench
