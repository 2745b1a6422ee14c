// `palpate plan`: the cheapest model, mesh and step that meet what a scene needs, measured on that
// scene and this machine.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "modules/geometry/organ_shape.h"
#include "modules/messages/messages.h"
#include "modules/scene/scene.h"

namespace palpate::plan {

/// One way to run the scene.
struct Candidate {
  std::string model = "implicit_volume";
  std::size_t nodes = 0;  ///< of the surface mesh, as the scene's key `nodes`
  double rate = 0;        ///< of deformation [Hz]
  scene::Integrator integrator = scene::Integrator::kAutomatic;

  std::string name() const;
};

/// What a run of the scene gave, at kSampleRate per simulated second.
struct Course {
  std::vector<std::vector<Vec3>> forces;    ///< per sample and probe [N]
  std::vector<std::vector<Vec3>> surfaces;  ///< per sample, at the marks [m]
  double volume_error = 0;                  ///< largest |V − V*|/V*
  double deformation_cost = 0;              ///< processor seconds per simulated second
  double collision_cost = 0;                ///< the same of the search for contacts
  std::size_t node_count = 0;               ///< of the state, inner ones included
  bool diverged = false;
  ContactTroubles contacts;
};
inline constexpr double kSampleRate = 20;  // [Hz]

/// How far a course is from the reference solution.
struct Errors {
  double force = 0;    ///< RMS over the reference's RMS; 0 where nothing was touched
  double surface = 0;  ///< RMS [m]
  double volume = 0;
};

struct Verdict {
  Candidate candidate;
  Errors errors;
  double deformation_load = 0;  ///< of one core, at the candidate's rate
  double total_load = 0;        ///< of all cores wanted: deformation, collision, haptics
  std::size_t node_count = 0;
  std::vector<std::string> failures;  ///< needs it does not meet, in words; empty: it meets all
};

/// A load above this leaves no room for a slower moment.
inline constexpr double kLargestLoad = 0.8;
/// Processor time of one haptic tick, more than any measured here [s].
inline constexpr double kHapticTick = 20e-6;

/// Points of the rest surface, in W, at which courses are compared; the same for all meshes [m].
std::vector<Vec3> marks_on(const geometry::TriangleSurface& surface);

/// Where the reference comes from: for a solid, tetrahedra with averaged pressures on a mesh
/// refined where the probes go (solid_reference.h); for a wall filled with fluid, springs and the
/// implicit volume on four times the nodes; both in small steps.
Candidate reference_of(const scene::Scene& scene);

/// All that are tried, on a quarter, half, once and twice the scene's nodes, at the least rate and
/// twice that.
std::vector<Candidate> candidates_of(const scene::Scene& scene);

/// The scene as the candidate would run it.
scene::Scene scene_with(const scene::Scene& scene, const Candidate& candidate);

/// Runs the scene's first `duration` seconds. @param keep_going  asked often; may throw
/// @throws InputError if the candidate cannot run it
Course run_course(const scene::Scene& scene, const geometry::OrganShape& shape,
                  const std::vector<Vec3>& marks, double duration,
                  const std::function<void()>& keep_going);

Errors compare(const Course& course, const Course& reference);

Verdict judge(const scene::Needs& needs, const Candidate& candidate, const Course& course,
              const Course& reference);

/// The one of least total load among those that meet all needs.
const Verdict* best(const std::vector<Verdict>& verdicts);

/// What would have to be given up or gained so that something meets the needs; one line per way,
/// from candidates that fail one need only.
std::vector<std::string> ways_out(const scene::Needs& needs, const std::vector<Verdict>& verdicts);

}  // namespace palpate::plan
