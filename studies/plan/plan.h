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
#include "studies/truth/force_truth.h"

namespace palpate::plan {

/// One way to run the scene.
struct Candidate {
  std::string model = "implicit_volume";
  std::size_t nodes = 0;  ///< of the surface mesh, as the scene's key `nodes`
  double rate = 0;        ///< of deformation [Hz]
  scene::Integrator integrator = scene::Integrator::kAutomatic;
  scene::Refinement refine = {};  ///< of a solid's tetrahedra

  std::string name() const;
};

/// What a run of the scene gave, at kSampleRate per simulated second.
struct Course {
  std::vector<std::vector<Vec3>> forces;    ///< per sample and probe [N]
  std::vector<std::vector<Vec3>> surfaces;  ///< per sample, displacements at the marks [m]
  /// The same where the probes were held until all was still, and the forces just before [N].
  std::vector<std::vector<Vec3>> held_forces, moving_forces, held_surfaces;
  double volume_error = 0;      ///< largest |V − V*|/V*
  double deformation_cost = 0;  ///< processor seconds per simulated second
  double collision_cost = 0;    ///< the same of the search for contacts
  double publishing_cost = 0;   ///< the same of making bytes of what they say, new meshes included
  double haptic_tick = 0;       ///< processor time of one [s]
  std::size_t node_count = 0;   ///< of the state, inner ones included; most, of a mesh that changes
  bool diverged = false;
  ContactTroubles contacts;
};
inline constexpr double kSampleRate = 20;  // [Hz]

/// What is true of a solid at rest under its probes at one instant.
struct TrueTouch {
  double time = 0;                    ///< of the scene [s]
  std::vector<std::uint32_t> probes;  ///< that touch
  truth::Truth truth;                 ///< forces in the order of `probes`
};

/// What the hand would feel wrong. Of a solid; parts of the true forces' RMS.
struct Feel {
  double stiffness = 0;  ///< mean of force over true force, less 1: above 0 too stiff
  double uneven = 0;     ///< how far it varies about that from place to place (standard deviation)
  double moving = 0;     ///< what motion changes: damping, inertia, what has not come to rest
  double sideways = 0;   ///< across the true force: friction, which the truth has none of
};

/// How far a course is from the reference solution.
struct Errors {
  double force = 0;    ///< RMS over the reference's RMS; 0 where nothing was touched
  double surface = 0;  ///< RMS [m]
  double volume = 0;
  double force_bar = 0, surface_bar = 0;  ///< how far the errors themselves may be off
  Feel feel;
};

struct Verdict {
  Candidate candidate;
  Errors errors;
  double deformation_load = 0;  ///< of one core, at the candidate's rate
  double total_load = 0;        ///< of all cores wanted: deformation, collision, bytes, haptics
  std::size_t node_count = 0;
  std::vector<std::string> failures;  ///< needs it does not meet, in words; empty: it meets all
};

/// A load above this leaves no room for a slower moment.
inline constexpr double kLargestLoad = 0.8;
/// Loads that differ by less are equal: as far as two runs of one candidate differ.
inline constexpr double kLoadNoise = 0.1;

/// Points of the rest surface, in W, at which courses are compared; the same for all meshes [m].
std::vector<Vec3> marks_on(const geometry::TriangleSurface& surface);

/// Where the reference of a wall filled with fluid comes from: springs and the implicit volume on
/// four times the nodes in small steps.
Candidate reference_of(const scene::Scene& scene);

/// All that are tried, on a quarter, half, once and twice the scene's nodes, at the least rate and
/// twice that; of a solid also with small tetrahedra at the places that probes touch, in advance or
/// wherever they are.
/// @param touched  those places; none: no such candidates
/// @param radius   of the smallest probe [m]
std::vector<Candidate> candidates_of(const scene::Scene& scene,
                                     const std::vector<scene::Region>& touched = {},
                                     double radius = 0);

/// The scene as the candidate would run one of its organs.
scene::Scene scene_with(const scene::Scene& scene, const Candidate& candidate,
                        std::size_t organ = 0);

/// Runs the scene's first `duration` seconds.
/// @param held  instants of the scene at which the probes stop until all is still, rising [s]
/// @param keep_going  asked often; may throw
/// @throws InputError if the candidate cannot run it
Course run_course(const scene::Scene& scene, const geometry::OrganShape& shape,
                  const std::vector<Vec3>& marks, double duration, const std::vector<double>& held,
                  const std::function<void()>& keep_going);

/// All forces and surfaces on the way.
Errors compare(const Course& course, const Course& reference);
/// Forces along the true ones and surfaces, where the probes were held.
Errors compare(const Course& course, const std::vector<TrueTouch>& truths);

Verdict judge(const scene::Needs& needs, const Candidate& candidate, const Course& course,
              const Errors& errors);

/// Of those that meet all needs and load little more than the least (kLoadNoise): the one of the
/// fewest nodes, then of the cheaper model, then of the lower rate.
/// @param rate  of deformation [Hz], if only candidates of that rate are asked for
const Verdict* best(const std::vector<Verdict>& verdicts, std::optional<double> rate = {});

/// What would have to be given up or gained so that something meets the needs; one line per way,
/// from candidates that fail one need only.
std::vector<std::string> ways_out(const scene::Needs& needs, const std::vector<Verdict>& verdicts);

}  // namespace palpate::plan
