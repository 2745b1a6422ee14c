// Where one probe touches one organ, or soon will, for its mesh to be fine there.
//
// A round probe is looked at as balls along its core, another as the points of its surface that lie
// furthest apart. Each is at the mean of the skin near it, at rest, weighted by area and by
//   (1 − (gap − least gap)/(R/2))²
// which moves evenly as tissue wraps around a tip, where the nearest point jumps about. Nothing
// within 2 R: no place. A place stays until the mean is R/4 away from it: meshes change seldom, and
// then only further than R from where it touches.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "deformation/model/body.h"
#include "deformation/model/following_mesh.h"
#include "modules/core/state_archive.h"
#include "modules/geometry/probe_form.h"

namespace palpate::deformation {

/// Longest edge under a probe over its radius R, for forces that are wrong by at most so much: what
/// `palpate chart` found at R, R/2 and R/3 (docs/accuracy.md) is about 0.27 (edge/R)^1.6.
double edge_over_radius(double force_error);
/// The inverse of edge_over_radius(), defined for longer edges, too.
double force_error_of_edge(double edge_over_radius);
/// The same of quadratic tetrahedra: medians at 1.4 R, R and 0.7 R are about 0.027 (edge/R)^2.65.
double quadratic_edge_over_radius(double force_error);

class TouchFollower {
 public:
  /// @param form              a half-space is not followed, nor a mesh that was not loaded
  /// @param edge              longest under the probe [m]; none: by its radius
  /// @param edge_over_radius  then
  TouchFollower(const geometry::ProbeForm& form, std::optional<double> edge,
                double edge_over_radius);

  void reset();
  /// Appends its places of an organ.
  /// @param pose  where the probe soon will be
  void look(const Pose& pose, const Body& body, std::span<const Vec3> positions,
            std::vector<TouchedPlace>& places);

  double radius() const { return radius_; }  ///< R [m]

  void exchange(StateArchive& archive) {
    for (Sample& sample : samples_) archive(sample.place);
  }

 private:
  struct Sample {
    Vec3 centre_P = Vec3::Zero();  ///< [m]
    std::optional<Vec3> place;     ///< at rest [m]
  };
  struct Near {
    double gap = 0, area = 0;
    Vec3 rest = Vec3::Zero();
  };

  /// Mean of the near skin at rest; none: nothing is near enough.
  std::optional<Vec3> mean_near(const Vec3& centre, double reach, const Body& body,
                                std::span<const Vec3> positions);

  double radius_ = 0, ball_radius_ = 0, edge_ = 0;  ///< [m]
  std::vector<Sample> samples_;
  std::vector<Near> near_;  ///< buffer
};

}  // namespace palpate::deformation
