// The squeezed ball by our own solvers.
#pragma once

#include "bench/bullet/squeezed_ball.h"
#include "deformation/models.h"
#include "palpate/session/in_process.h"

namespace palpate::bench {

/// How the ball's springs are stepped.
struct Method {
  std::string model = "implicit_volume";
  scene::Integrator integrator = scene::Integrator::kSymplecticEuler;
  int corrections = 0;  ///< Newton corrections of the volume per step
  /// One sub-step even where the method would take more for accuracy.
  bool one_step = false;
};

/// Deformation and contacts: every node near a plate gets a contact row. In equal sub-steps as
/// large as the method takes.
class PalpateBall : public Squeezer {
 public:
  /// @param ball  outlives this
  PalpateBall(const Ball& ball, const Method& method);

  void step(double height) override;
  double volume() const override;
  double pressure() const override { return state_.pressure; }
  std::size_t contact_count() const override { return rows_.size(); }
  double depth_beyond(double height) const override;
  double solver_seconds() const override { return solver_seconds_; }
  bool is_whole() const override { return false; }
  int substeps() const { return substeps_; }

 private:
  void find_contacts(double height, double speed);
  void keep_impulses();

  const Ball& ball_;
  deformation::OrganModel model_;
  std::unique_ptr<deformation::OrganDynamics> dynamics_;
  deformation::OrganState state_;
  std::vector<std::array<std::uint32_t, 3>> corners_;  ///< per node, itself first
  std::vector<deformation::ContactRow> rows_;
  std::vector<double> impulses_;  ///< of the last sub-step, per node [N·s]
  double height_ = kBallRadius;
  int substeps_ = 1;
  double solver_seconds_ = 0;
};

/// The whole in-process pipeline as a scene runs it: devices, collision on any shape, contact model
/// and haptic force, once per step.
class PipelineBall : public Squeezer {
 public:
  PipelineBall(const Ball& ball, const Squeeze& squeeze);
  void step(double height) override;
  double volume() const override;
  double pressure() const override;
  std::size_t contact_count() const override;
  std::uint64_t contacts_left_out() const override;
  double depth_beyond(double height) const override;

 private:
  session::InProcess pipeline_;
};

}  // namespace palpate::bench
