// Deformation as a stage: probes and contacts in, organs and the tissue's local law out.
// A session has one such stage for each process that the scene gives organs to.
#pragma once

#include "deformation/world.h"
#include "modules/bus/bus.h"
#include "modules/runtime/stage.h"

namespace palpate::deformation {

/// Says the organs' surfaces when built and after a reset. Each cycle: take the newest probes and
/// contacts, advance its organs by what the cycle may take on, publish them and, per probe, the
/// local law of the touched tissue. Of a probe or contacts not heard of for
/// runtime::input_stale_after() the hand feels nothing; a round probe holds tissue without
/// contacts, others while they are within a millimetre of where these were found, and both for a
/// second without poses. What does not hold touches nothing. While the session does not run, the
/// organs stand still and give no law: a force that nobody computed anew must grow stale. They
/// stand still, too, for at most a second where they go on from what another process kept
/// (runtime::KeptState), or after the process was stopped, until what touches them is heard of.
class DeformationStage : public runtime::Stage {
 public:
  /// @param shapes   one per organ of the process
  /// @param process  whose organs these are, from 1
  /// @param runner  outlives the stage; none: the calling thread alone. The bits are the same
  /// @param probe_meshes  see scene::load_probe_meshes()
  /// @throws InputError as DeformationWorld does
  DeformationStage(const scene::Scene& scene, std::vector<geometry::OrganShape> shapes,
                   bus::Bus& bus, std::size_t process = 1, ChunkRunner* runner = nullptr,
                   Guarding guarding = Guarding::kOn,
                   const std::vector<geometry::TriangleSurface>& probe_meshes = {});
  ~DeformationStage() override;
  runtime::Health cycle(const runtime::Cycle& now) override;
  void prepare() override;
  void exchange(StateArchive& archive) override;

  const DeformationWorld& world() const;                 ///< of its own organs
  void ask_for_volume(std::size_t organ, double ratio);  ///< of its own, as DeformationWorld does
  /// Of the last cycle that ran.
  const AdvanceReport& report() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::deformation
