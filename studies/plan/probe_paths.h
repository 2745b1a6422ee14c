// Where a scene's probes go, whatever the organ answers, and what they touch on the way.
#pragma once

#include <vector>

#include "modules/scene/scene.h"
#include "studies/truth/force_truth.h"

namespace palpate::plan {

/// Radii within which a probe touches what is about to be pressed.
inline constexpr double kNear = 1.5;

class ProbePaths {
 public:
  /// @param skin  the organ's surface at rest, in W
  /// @param duration  of the scene, from its start [s]
  ProbePaths(const scene::Scene& scene, geometry::TriangleSurface skin, double duration);

  /// At most `count` instants, spread evenly over the time in which a probe is deeper in the organ
  /// at rest than a twentieth of its radius [s].
  std::vector<double> touching(std::size_t count) const;
  /// The poses at that instant, come to straight from outside, for the truth.
  /// @param probes  numbers of those that are asked, in its order: others are not near
  truth::Question question_at(double time, std::vector<std::uint32_t>& probes) const;
  /// Where tetrahedra are to be small: balls of the probes' radius around the places they touch.
  std::vector<scene::Region> regions() const;
  /// The smallest radius of a probe [m].
  double smallest_radius() const;

 private:
  geometry::RoundedSegment probe_at(std::size_t probe, double time) const;
  truth::Station freed(const truth::Station& station) const;

  static constexpr double kRate = 50;  // [Hz]
  geometry::TriangleSurface skin_;
  std::vector<geometry::RoundedSegment> forms_;  ///< in P
  std::vector<std::vector<Pose>> poses_;         ///< per probe, at kRate
};

/// At most `count` of them, evenly spread.
std::vector<double> spread(const std::vector<double>& times, std::size_t count);

/// Whether the truth knows the shapes of all probes: spheres and capsules.
bool has_known_shapes(const scene::Scene& scene);
/// @throws InputError naming the probe of which it does not
void check_shapes(const scene::Scene& scene);

}  // namespace palpate::plan
