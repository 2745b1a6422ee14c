// Collision as a stage: probes and organs in, contacts out.
#pragma once

#include "collision/contact_finder.h"
#include "modules/bus/bus.h"
#include "modules/runtime/stage.h"
#include "modules/scene/scene.h"

namespace palpate::collision {

/// The probes of a scene with their meshes, see scene::load_probe_mesh().
std::vector<geometry::ProbeForm> probes_of(const scene::Scene& scene,
                                           std::vector<geometry::TriangleSurface> meshes);
/// The same with the meshes loaded.
/// @throws InputError for a mesh that cannot be used
std::vector<geometry::ProbeForm> load_probes(const scene::Scene& scene);

/// Each cycle: take the newest organs and probe poses, search each probe's way since the last
/// search, publish its contacts, none included. A probe not heard of for
/// runtime::input_stale_after() touches nothing. Ready once the surfaces of all organs are known.
/// Who begins while a session runs hears the others one after another: until it knows where the
/// organs are (OrganInputs::placed()), and of a probe it has never heard of, it says nothing.
class CollisionStage : public runtime::Stage {
 public:
  /// @param scene   outlives the stage
  /// @param probes  one per probe of the scene
  CollisionStage(const scene::Scene& scene, std::vector<geometry::ProbeForm> probes, bus::Bus& bus);
  ~CollisionStage() override;
  runtime::Health cycle(const runtime::Cycle& now) override;
  void prepare() override;
  void exchange(StateArchive& archive) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::collision
