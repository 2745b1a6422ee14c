#include "collision/collision_process.h"

#include <algorithm>
#include <optional>

#include "collision/contact_finder.h"
#include "collision/contact_margin.h"
#include "modules/core/units.h"
#include "modules/runtime/module.h"
#include "modules/runtime/silence_watch.h"
#include "modules/scene/assets.h"
#include "modules/scene/scene_reader.h"

namespace palpate::collision {
namespace {

std::vector<ProbeGeometry> load_probes(const scene::Scene& scene) {
  std::vector<ProbeGeometry> probes;
  for (const auto& probe : scene.probes) {
    probes.push_back({probe.shape, scene::load_probe_mesh(probe)});
  }
  return probes;
}

/// The organs' surfaces as deformation tells them, kept in a finder.
class OrganInputs {
 public:
  OrganInputs(runtime::Module& module, std::vector<ProbeGeometry> probes, std::size_t organs)
      : surfaces_(module.bus().reader(bus::kSurface)),
        positions_(module.bus().reader(bus::kNodePositions)),
        probes_(std::move(probes)),
        organs_(organs) {
    module.watch(bus::kSurface, surfaces_);
    module.watch(bus::kNodePositions, positions_);
  }

  void take() {
    while (surfaces_.take(surface_)) take_surface();
    while (positions_.take(newest_)) take_positions();
  }

  /// nullptr until the surfaces of all organs are known.
  ContactFinder* finder() { return finder_ ? &*finder_ : nullptr; }
  std::uint64_t sequence() const { return sequence_; }  ///< of the newest node positions
  /// Of node positions, as they come [s]; 0 before the second.
  double interval() const { return interval_; }

 private:
  struct OrganInput {
    std::uint32_t generation = 0;
    std::vector<geometry::Triangle> triangles;
    std::size_t surface_node_count = 0;
    std::vector<Vec3> positions;
  };

  static void read_positions(const std::vector<float>& from, OrganInput& organ) {
    organ.positions.resize(organ.surface_node_count);
    for (std::size_t i = 0; i < organ.surface_node_count; ++i) {
      organ.positions[i] = Vec3(from[3 * i], from[3 * i + 1], from[3 * i + 2]);
    }
  }

  /// A surface starts its organ anew: what was remembered of the search before no longer holds.
  void take_surface() {
    if (surface_.organ >= organs_.size()) return;
    OrganInput& organ = organs_[surface_.organ];
    const bool same_shape = finder_ && organ.triangles == surface_.triangles;
    organ.generation = surface_.generation;
    organ.surface_node_count = surface_.surface_node_count;
    organ.triangles = surface_.triangles;
    read_positions(surface_.rest_positions, organ);
    same_shape ? finder_->reset() : make_finder();
    if (finder_) finder_->update_organ(surface_.organ, organ.positions);
  }

  void make_finder() {
    finder_.reset();
    std::vector<std::vector<geometry::Triangle>> triangles;
    for (const OrganInput& organ : organs_) {
      if (organ.triangles.empty()) return;
      triangles.push_back(organ.triangles);
    }
    finder_.emplace(std::move(triangles), probes_);
    for (std::size_t i = 0; i < organs_.size(); ++i) {
      finder_->update_organ(i, organs_[i].positions);
    }
  }

  /// Positions of another generation than the surface's wait for their surface.
  void take_positions() {
    if (newest_.organ >= organs_.size() || !finder_) return;
    OrganInput& organ = organs_[newest_.organ];
    if (newest_.generation != organ.generation ||
        newest_.positions.size() < 3 * organ.surface_node_count) {
      return;
    }
    read_positions(newest_.positions, organ);
    finder_->update_organ(newest_.organ, organ.positions);
    sequence_ = newest_.header.sequence;
    if (newest_.organ != 0) return;
    if (came_ns_ != 0) interval_ = seconds_from_ns(newest_.header.source_time_ns - came_ns_);
    came_ns_ = newest_.header.source_time_ns;
  }

  bus::Reader<SurfaceTopology> surfaces_;
  bus::Reader<NodePositions> positions_;
  std::vector<ProbeGeometry> probes_;
  std::vector<OrganInput> organs_;
  std::optional<ContactFinder> finder_;
  SurfaceTopology surface_;
  NodePositions newest_;
  std::uint64_t sequence_ = 0;
  std::int64_t came_ns_ = 0;
  double interval_ = 0;
};

/// The probes' ways from search to search.
class ProbeInputs {
 public:
  ProbeInputs(runtime::Module& module, std::size_t probes)
      : states_(module.bus().reader(bus::kProbeState)),
        probes_(probes),
        heard_(probes, runtime::kInputStaleAfter) {
    module.watch(bus::kProbeState, states_);
  }

  void take() {
    while (states_.take(newest_)) {
      if (newest_.probe >= probes_.size()) continue;
      Way& way = probes_[newest_.probe];
      if (!way.known) way.searched = newest_.pose;
      way.known = true;
      way.newest = newest_;
      heard_.heard(newest_.probe, newest_.header.source_time_ns);
    }
  }

  /// The way since the last call.
  ProbeMotion motion(std::size_t probe) {
    Way& way = probes_[probe];
    const ProbeMotion motion{way.searched, way.newest.pose};
    way.searched = way.newest.pose;
    return motion;
  }

  /// A probe that was lost begins where it is found again.
  void lose(std::size_t probe) { probes_[probe].known = false; }

  const ProbeState& newest(std::size_t probe) const { return probes_[probe].newest; }
  std::size_t count() const { return probes_.size(); }
  bool silent(std::size_t probe, std::int64_t now_ns) const { return heard_.silent(probe, now_ns); }
  bool any_silent(std::int64_t now_ns) const { return heard_.any_silent(now_ns); }

 private:
  struct Way {
    bool known = false;
    ProbeState newest;
    Pose searched;
  };
  bus::Reader<ProbeState> states_;
  std::vector<Way> probes_;
  runtime::SilenceWatch heard_;
  ProbeState newest_;
};

/// The rates that hold at the moment: a deformation that cannot keep up uses contacts for longer.
scene::Rates present_rates(scene::Rates rates, double interval) {
  constexpr double kLongestInterval = 0.05;
  if (interval > 0) {
    rates.deformation = std::min(rates.deformation, 1 / std::min(interval, kLongestInterval));
  }
  return rates;
}

/// Contacts of contacts.probe on its way since the last search; none if it is lost. They are as old
/// as the pose they hold for.
void search(const scene::Rates& rates, std::int64_t now_ns, ContactFinder& finder,
            ProbeInputs& probes, Contacts& contacts) {
  const ProbeState& state = probes.newest(contacts.probe);
  contacts.header.source_time_ns = state.header.source_time_ns;
  contacts.probe_pose = state.pose;
  contacts.truncated = false;
  contacts.contacts.clear();
  if (probes.silent(contacts.probe, now_ns)) {
    probes.lose(contacts.probe);
    return;
  }
  const double margin = contact_margin(rates, state.twist.linear.norm());
  finder.find(contacts.probe, probes.motion(contacts.probe), margin, contacts);
}

const char* acting_guard(const ProbeInputs& probes, const Contacts& last, std::int64_t now_ns) {
  if (probes.any_silent(now_ns)) {
    return "no news of a probe: it touches nothing until it is heard again";
  }
  return last.truncated ? "more contacts than a message holds: the deepest are kept" : "";
}

}  // namespace

runtime::ModuleProgram collision_program() {
  return {"collision", "Finds the contacts between the probes and the organs of a scene.", {}};
}

void run_collision(const runtime::ModuleOptions& options) {
  const scene::Scene scene = scene::load_scene(options.scene);
  auto probe_geometry = load_probes(scene);
  runtime::Module module(options, scene, "collision", scene.rates.collision,
                         runtime::Priority::kPreferred);
  OrganInputs organs(module, std::move(probe_geometry), scene.organs.size());
  ProbeInputs probes(module, scene.probes.size());
  auto writer = module.bus().writer(bus::kContacts);

  Contacts contacts;
  while (module.next_cycle()) {
    organs.take();
    probes.take();
    ContactFinder* finder = organs.finder();
    if (finder == nullptr) continue;
    module.ready();
    if (module.take_reset()) finder->reset();
    const scene::Rates rates = present_rates(scene.rates, organs.interval());

    for (std::uint32_t probe = 0; probe < probes.count(); ++probe) {
      contacts.probe = probe;
      contacts.node_positions_sequence = organs.sequence();
      contacts.header = module.header();
      search(rates, module.now_ns(), *finder, probes, contacts);
      writer.write(contacts);
    }
    module.set_guard(acting_guard(probes, contacts, module.now_ns()));
  }
}

}  // namespace palpate::collision
