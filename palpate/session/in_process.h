// A whole session in one process: the stages of haptics, collision and deformation in lockstep on
// the memory bus, as fast as the machine allows. What studies and checks run instead of a wiring of
// their own, and what `palpate run --in-process` is.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "deformation/stage.h"
#include "haptics/stage.h"
#include "modules/geometry/organ_shape.h"
#include "modules/geometry/triangle_surface.h"
#include "modules/runtime/lockstep.h"
#include "modules/runtime/snapshot.h"
#include "modules/scene/assets.h"
#include "modules/scene/scene.h"

namespace palpate::session {

/// What a scene's files hold.
struct Assets {
  std::vector<geometry::OrganShape> organs;             ///< one per organ
  std::vector<geometry::TriangleSurface> probe_meshes;  ///< one per probe; empty: no MeshShape
};
/// @throws InputError for a mesh that cannot be used; Interrupted as scene::load_organ()
Assets load_assets(const scene::Scene& scene, const scene::Resampling& resampling = {});

/// Makes a stage on the session's bus.
using MakeStage = std::function<std::unique_ptr<runtime::Stage>(bus::Bus&)>;

struct InProcessOptions {
  ChunkRunner* runner = nullptr;  ///< of deformation; outlives the session
  deformation::Guarding guarding = deformation::Guarding::kOn;
  ContactTroubles* troubles = nullptr;  ///< at the session's end gets its own added; outlives it
  /// The bus that the stages see, given the one that carries: for taps. None: the same.
  std::function<std::unique_ptr<bus::Bus>(bus::Bus&)> tap;
  /// Where the session goes on instead of at rest; outlives the construction. Its file is for
  /// messages.
  const runtime::Snapshot* from = nullptr;
  std::filesystem::path from_file;
  /// How a module's stage is made, given the usual way: to time it (timed_stage.h), to put another
  /// in its place, or, with nullptr, to go without the module. None: the usual way.
  std::function<std::unique_ptr<runtime::Stage>(std::string_view module, bus::Bus& bus,
                                                const MakeStage& usual)>
      make;
};

class InProcess {
 public:
  /// @throws InputError as the stages do
  InProcess(const scene::Scene& scene, Assets assets, const InProcessOptions& options = {});
  ~InProcess();
  InProcess(InProcess&&) noexcept;

  /// Another module, by its name in runtime::kModules; before the first cycle.
  void add(const std::string& module, const MakeStage& make);

  /// All cycles that begin before `time` [s].
  void run_until(double time);
  /// All cycles that begin at the next instant at which one does.
  void tick();
  /// That instant [s].
  double time() const;
  /// Of now, between two ticks: what options.from takes.
  runtime::Snapshot snapshot();
  /// Ends the session at `time` [s]: what was said before it reaches every module.
  void finish(double time);

  const scene::Scene& scene() const;
  bus::Bus& bus();  ///< for listening
  // Of the usual stages; a broken demand where another is in their place.
  haptics::HapticsStage& haptics();
  const deformation::DeformationStage& deformation() const;  ///< of a scene with one process of it
  const deformation::DeformationWorld& world() const { return deformation().world(); }
  /// As TargetVolume::ask() of that organ.
  void ask_for_volume(std::size_t organ, double ratio);
  const runtime::Health& health(const std::string& module) const;  ///< after its last cycle
  /// The same of all stages, each with its module's name.
  std::vector<std::pair<std::string, runtime::Health>> healths() const;
  ContactTroubles contact_troubles() const;  ///< of all stages so far

  // The newest of what the stages said; before the first of its kind a default one, of organs the
  // rest shape.
  const ProbeState& probe(std::size_t probe) const;
  const Contacts& contacts(std::size_t probe) const;
  const ContactModel& contact_model(std::size_t probe) const;  ///< of the first process
  const HapticForce& haptic_force(std::size_t probe) const;
  const NodePositions& node_positions(std::size_t organ) const;
  const SurfaceTopology& surface(std::size_t organ) const;
  /// The same, of whichever of these kinds, to keep: it stays as it is when newer ones come.
  template <class Message>
  std::shared_ptr<const Message> shared(std::size_t key) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A session of the scene with its files loaded.
/// @throws InputError as load_assets() and the stages do
InProcess load_session(const scene::Scene& scene);

}  // namespace palpate::session
