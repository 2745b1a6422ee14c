// Organs driven without a world: so they can be put into any state.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>

#include "deformation/simulated_organ.h"
#include "tests/deformation/organs.h"

namespace palpate::deformation::testing {

inline SimulatedOrgan simulate(const scene::Organ& organ, const geometry::OrganShape& shape,
                               const Vec3& gravity = Vec3::Zero()) {
  auto model = std::make_unique<const OrganModel>(build_organ_model(organ, gravity, shape));
  auto dynamics = make_dynamics(organ, *model, kPeriod);
  return {organ, std::move(model), std::move(dynamics)};
}

inline scene::Organ ball_with(scene::Integrator integrator) {
  auto organ = testing::ball_organ();
  organ.integrator = integrator;
  return organ;
}

inline SimulatedOrgan simulated_ball(int levels, const scene::Organ& organ = ball_organ()) {
  return simulate(organ, geometry::make_ball(kBallRadius, levels));
}

/// What happened in some time without contacts.
struct Story {
  int replaced = 0, to_rest = 0;  ///< advances
  bool volume_released = false, volume_skipped = false, pressure_capped = false;
  bool step_reduced = false;
  bool finite = true;
  double fastest = 0;  ///< node at the end of an advance [m/s]
  Violation first_reason = Violation::kNone;
};

inline void note(const AdvanceReport& report, const OrganState& state, Story& story) {
  if (report.diverged && story.replaced == 0) story.first_reason = report.reason;
  story.replaced += report.diverged;
  story.to_rest += report.back_to_rest;
  story.volume_released |= report.volume_released;
  story.volume_skipped |= report.volume_skipped;
  story.pressure_capped |= report.pressure_capped;
  story.step_reduced |= report.step_reduced;
  for (std::size_t i = 0; i < state.positions.size(); ++i) {
    story.finite &= state.positions[i].allFinite() && state.velocities[i].allFinite();
    story.fastest = std::max(story.fastest, state.velocities[i].norm());
  }
}

inline Story run(SimulatedOrgan& organ, double seconds) {
  Story story;
  for (double time = 0; time < seconds; time += kPeriod) {
    AdvanceReport report;
    const int substeps = organ.substeps(kPeriod);
    for (int s = 1; s <= substeps; ++s) {
      organ.step(time + s * kPeriod / substeps, kPeriod / substeps, {}, report);
    }
    organ.finish(kPeriod, report);
    note(report, organ.state(), story);
  }
  return story;
}

/// Largest distance of a surface node from where it rests, after the rigid motion that fits best,
/// over the cube root of the rest volume.
inline double shape_error(const OrganModel& model, const std::vector<Vec3>& positions) {
  const auto count = static_cast<Eigen::Index>(model.surface_node_count);
  Eigen::Matrix3Xd rest(3, count), now(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    rest.col(i) = model.rest_positions[static_cast<std::size_t>(i)];
    now.col(i) = positions[static_cast<std::size_t>(i)];
  }
  const Eigen::Matrix4d fit = Eigen::umeyama(rest, now, false);
  const Eigen::Matrix3Xd fitted =
      (fit.topLeftCorner<3, 3>() * rest).colwise() + fit.topRightCorner<3, 1>().col(0);
  return (now - fitted).colwise().norm().maxCoeff() / std::cbrt(model.rest_volume);
}

inline double shape_error(const SimulatedOrgan& organ) {
  return shape_error(organ.model(), organ.state().positions);
}

inline double volume_error(const SimulatedOrgan& organ) {
  const double volume = geometry::enclosed_volume(organ.state().positions, organ.model().triangles);
  return std::abs(volume / organ.model().rest_volume - 1);
}

}  // namespace palpate::deformation::testing
