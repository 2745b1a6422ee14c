// The scene's first seconds run in one way, and how far what they gave is from what is true.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "modules/geometry/organ_shape.h"
#include "modules/messages/messages.h"
#include "modules/scene/scene.h"
#include "studies/truth/force_truth.h"

namespace palpate::plan {

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
  double time = 0;      ///< simulated, probes that are held included [s]
  std::string stopped;  ///< why it was not run to its end; empty: it was
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
  /// By truths the worst instant's, of the true force there or, where that is light, of kLight of
  /// the largest; by a reference RMS over its RMS. 0 where nothing was touched.
  double force = 0;
  double surface = 0;  ///< RMS [m]
  double volume = 0;
  double force_bar = 0, surface_bar = 0;  ///< how far the errors themselves may be off
  Feel feel;
};

/// Points of the rest surface, in W, at which courses are compared; the same for all meshes [m].
std::vector<Vec3> marks_on(const geometry::TriangleSurface& surface);

/// Why a course need not run on, judged by what it gave so far; empty: it is to run on.
using WhyStop = std::function<std::string(const Course& so_far)>;

/// Runs the scene's first `duration` seconds.
/// @param held  instants of the scene at which the probes stop until all is still, rising [s]
/// @param keep_going  asked often; may throw
/// @param why_stop    asked at each held instant and four times a second; costs of publishing are
///                    not known before the end
/// @throws InputError if the candidate cannot run it
Course run_course(
    const scene::Scene& scene, const geometry::OrganShape& shape, const std::vector<Vec3>& marks,
    double duration, const std::vector<double>& held, const std::function<void()>& keep_going,
    const WhyStop& why_stop = [](const Course&) { return std::string(); });

/// All forces and surfaces on the way.
Errors compare(const Course& course, const Course& reference);
/// A part of the largest true force.
inline constexpr double kLight = 0.2;
/// Forces along the true ones and surfaces, where the probes were held.
/// @param truths  of all instants  @param count  so many of them, the first, are compared
Errors compare(const Course& course, std::span<const TrueTouch> truths, std::size_t count);
inline Errors compare(const Course& course, std::span<const TrueTouch> truths) {
  return compare(course, truths, truths.size());
}

}  // namespace palpate::plan
