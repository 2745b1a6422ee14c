// What the touched tissue gives way by within one period of deformation.
//
// A force held for a period T moves a patch, from free flight, by u = A⁻¹ f at its end,
//     A = M/T² + (drag M + D)/T · d + K k
// as if every node moved there evenly. With n steps explicit in the elastic forces d = (n − 1)/n
// and k = (n − 1)/2n, with implicit ones d = 1 and k = (n + 1)/2n: the means over the steps of the
// velocities and displacements their forces are taken at. Within T a wave of shear in soft tissue
// makes its way of some millimetres; the patch is that large, and what is beyond is held. On a mesh
// so fine that many nodes go along, and in a solid, the patch answers by its near nodes and, beyond
// them, as a whole (far_answers.h, solid_answers.h). Contents whose volume is kept take their share
// at once, wherever they are: a rank-one less.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "deformation/contact/compliance_row.h"
#include "deformation/contact/even_press.h"
#include "deformation/contact/far_answers.h"
#include "deformation/contact/solid_answers.h"
#include "deformation/model/organ_model.h"
#include "deformation/model/patch.h"
#include "modules/core/state_archive.h"

namespace palpate::deformation {

/// Adds K and D of the patch to the lower triangles.
using AddStiffness =
    std::function<void(const Patch& patch, Eigen::MatrixXf& stiffness, Eigen::MatrixXf& damping)>;

class PatchCompliance {
 public:
  /// Of a solid that answers beyond its patch; more where more are touched.
  static constexpr std::size_t kNearInSolid = 48;
  /// Of springs where more are touched than a patch has, at most.
  static constexpr std::size_t kMostNearInSprings = 110;

  /// @param model  outlives this
  /// @param nodes  of a patch; of a solid at most
  /// @param runner  outlives this; none: the calling thread alone. The bits are the same
  PatchCompliance(const OrganModel& model, Neighbours neighbours, std::size_t nodes,
                  ChunkRunner* runner = nullptr);

  /// C A⁻¹ Cᵀ [m/N], symmetric. In explicit steps of springs near by it is scaled so that the
  /// press of the rows' forces, or without any that of the first row, gives way as in those steps
  /// (even_press.h). Nodes that are touched but do not fit the patch answer alone.
  /// @param gradient  of a kept volume (volume_gradient.h), empty: none is kept
  /// @param last  of a solid; none: the nodes beyond the patch are held
  Eigen::MatrixXd solve(const std::vector<Vec3>& positions, std::span<const ComplianceRow> rows,
                        const PeriodSteps& steps, std::span<const Vec3> gradient,
                        const AddStiffness& add_stiffness, const StepMatrix& last = {});

  /// Drops what was found for earlier periods.
  void forget() { solid_.reset(); }
  /// Begins with what was found on an earlier mesh. @param carried  from that one to this
  void begin_with(const PatchCompliance& before, const SolidAnswers::Carry& carried);

  /// What was found for periods before.
  void exchange(StateArchive& archive);

 private:
  /// @returns the middle of the rows [m]
  Vec3 find_touched(const std::vector<Vec3>& positions, std::span<const ComplianceRow> rows);
  /// C M⁻¹ Cᵀ, the volume kept: in a single explicit step no spring has a share [1/kg].
  Eigen::MatrixXd answers_of_masses(std::span<const ComplianceRow> rows,
                                    std::span<const Vec3> gradient);
  /// How many nodes answer each by itself, once touched_ is found.
  std::size_t near_nodes(const StepMatrix& last) const;
  /// Adds the directions in which the body goes along beyond the patch to A.
  /// @returns their number
  Eigen::Index extend(const std::vector<Vec3>& positions, const Vec3& centre, double stiffness,
                      std::span<const ComplianceRow> rows, const SpringShares& shares,
                      const StepMatrix& last, Eigen::MatrixXf& A);
  /// Of a push at a node, one for each direction beyond.
  Eigen::Vector3f far_load(std::uint32_t node, const Vec3& push) const;
  /// How far a push of 1 N moves a touched node that does not fit the patch while all others are
  /// held [m/N]
  Mat3 alone(std::uint32_t node, Eigen::Index far, double mass_share) const;
  /// @param A    lower triangle: of the patch, and of `far` directions beyond
  Eigen::MatrixXd answers(const Eigen::MatrixXf& A, Eigen::Index far, double mass_share,
                          std::span<const ComplianceRow> rows,
                          std::span<const Vec3> gradient) const;

  /// @param evenly  C A⁻¹ Cᵀ
  /// @returns what the press gives way by in explicit steps, over what it does by that
  double shortfall(const Eigen::MatrixXd& evenly, std::span<const ComplianceRow> rows,
                   const PeriodSteps& steps, std::span<const Vec3> gradient);

  /// Of a row's force of 1 N, on one of its nodes.
  struct Push {
    std::uint32_t node = 0;
    Eigen::Index row = 0;
    Vec3 push;
  };

  const OrganModel& model_;
  Neighbours neighbours_;
  std::size_t nodes_;
  std::vector<std::uint32_t> touched_;
  Patch patch_;
  std::vector<Push> pushes_;  ///< buffer
  PressedPatch pressed_;      ///< K and D of patch_; the rest in explicit steps
  std::optional<SolidAnswers> solid_;
  std::optional<FarAnswers> far_;  ///< of springs
};

/// As laws of a probe need it. @param model  outlives it
/// @param runner  outlives it; none: the calling thread alone
std::unique_ptr<PatchCompliance> make_compliance(const OrganModel& model, ChunkRunner* runner);

}  // namespace palpate::deformation
