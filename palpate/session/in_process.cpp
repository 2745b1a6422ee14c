#include "palpate/session/in_process.h"

#include <algorithm>
#include <map>

#include "collision/stage.h"
#include "deformation/organ_messages.h"
#include "modules/bus/memory_bus.h"
#include "modules/core/error.h"
#include "modules/core/units.h"
#include "modules/runtime/wiring.h"
#include "modules/scene/key_place.h"
#include "modules/scene/processes.h"
#include "modules/scene/scene_reader.h"

namespace palpate::session {
namespace {

/// Keeps the newest message of each key. One that somebody holds stays as it is; the next one then
/// gets memory of its own.
template <class Message>
class Newest {
 public:
  /// @param keeps  which messages; none: all
  Newest(bus::Bus& bus, const bus::TopicOf<Message>& topic, std::uint32_t Message::*key,
         std::size_t keys, bool (*keeps)(const Message&) = nullptr)
      : reader_(bus.reader(topic)),
        key_(key),
        keeps_(keeps),
        arrived_(std::make_shared<Message>()) {
    for (std::size_t i = 0; i < keys; ++i) {
      newest_.push_back(std::make_shared<Message>());
      (*newest_.back()).*key = static_cast<std::uint32_t>(i);
    }
  }

  void listen() {
    while (reader_.take(*arrived_)) {
      const std::uint32_t key = (*arrived_).*key_;
      if (key >= newest_.size() || (keeps_ != nullptr && !keeps_(*arrived_))) continue;
      std::swap(newest_[key], arrived_);
      if (arrived_.use_count() > 1) arrived_ = std::make_shared<Message>();
    }
  }
  Message& operator[](std::size_t key) { return *newest_.at(key); }
  const Message& operator[](std::size_t key) const { return *newest_.at(key); }
  std::shared_ptr<const Message> shared(std::size_t key) const { return newest_.at(key); }

 private:
  bus::Reader<Message> reader_;
  std::uint32_t Message::*key_;
  bool (*keeps_)(const Message&);
  std::vector<std::shared_ptr<Message>> newest_;
  std::shared_ptr<Message> arrived_;
};

/// A stage with its place in the session.
struct Member {
  std::string module;
  std::unique_ptr<runtime::Stage> stage;
  std::vector<bus::Output*> outputs;
  runtime::LockstepCursor cursor;
  runtime::Health health;
};

}  // namespace

Assets load_assets(const scene::Scene& scene, const scene::Resampling& resampling) {
  Assets assets;
  for (std::size_t i = 0; i < scene.organs.size(); ++i) {
    assets.organs.push_back(scene::with_organ(
        scene, i, [&](const auto& organ) { return scene::load_organ(organ, resampling); }));
  }
  assets.probe_meshes = scene::load_probe_meshes(scene);
  return assets;
}

struct InProcess::Impl {
  Impl(const scene::Scene& scene_in, Assets assets, const InProcessOptions& options)
      : scene(scene_in),
        troubles(options.troubles),
        from(options.from != nullptr ? *options.from : runtime::Snapshot{}),
        from_file(options.from_file),
        tapped(options.tap ? options.tap(carrier) : nullptr),
        probes(carrier, bus::kProbeState, &ProbeState::probe, scene.probes.size()),
        contacts(carrier, bus::kContacts, &Contacts::probe, scene.probes.size()),
        models(carrier, bus::kContactModel, &ContactModel::probe, scene.probes.size(),
               [](const ContactModel& model) { return model.process == 1; }),
        forces(carrier, bus::kHapticForce, &HapticForce::probe, scene.probes.size()),
        nodes(carrier, bus::kNodePositions, &NodePositions::organ, scene.organs.size()),
        surfaces(carrier, bus::kSurface, &SurfaceTopology::organ, scene.organs.size()) {
    const auto clock = [this] { return clock_ns; };
    carrier.set_clock(clock);
    if (tapped) tapped->set_clock(clock);
    add("haptics", options, [&](bus::Bus& bus) {
      auto stage = std::make_unique<haptics::HapticsStage>(scene, bus, warnings);
      haptics = stage.get();
      return stage;
    });
    add("collision", options, [&](bus::Bus& bus) {
      return std::make_unique<collision::CollisionStage>(
          scene, collision::probes_of(scene, assets.probe_meshes), bus);
    });
    for (std::size_t process = 1; process <= scene::process_count(scene); ++process) {
      const std::string name = runtime::name_of({"deformation", process});
      add(name, options,
          [&](bus::Bus& bus) { return add_deformation(process, assets, bus, options); });
    }
    listen();
    if (!from.modules.empty()) read_nodes();
  }

  std::unique_ptr<runtime::Stage> add_deformation(std::size_t process, Assets& assets,
                                                  bus::Bus& bus, const InProcessOptions& options) {
    const auto own = scene::organs_of(scene, process);
    std::vector<geometry::OrganShape> shapes;
    for (const std::size_t organ : own) shapes.push_back(std::move(assets.organs.at(organ)));
    auto stage = std::make_unique<deformation::DeformationStage>(
        scene, std::move(shapes), bus, process, options.runner, options.guarding,
        assets.probe_meshes);
    deformation.resize(std::max(deformation.size(), process));
    deformation[process - 1] = stage.get();
    for (std::size_t k = 0; k < own.size(); ++k) {
      deformation::write_node_positions(stage->world(), k, nodes[own[k]]);
      nodes[own[k]].organ = static_cast<std::uint32_t>(own[k]);
    }
    return stage;
  }

  /// Of organs that go on from somewhere: nothing says where their nodes are before they advance.
  void read_nodes() {
    for (std::size_t organ = 0; organ < scene.organs.size(); ++organ) {
      const std::size_t process = scene.organs[organ].process;
      if (process > deformation.size() || deformation[process - 1] == nullptr) continue;
      const auto [owner, own] = owner_of(organ);
      deformation::write_node_positions(owner->world(), own, nodes[organ]);
      nodes[organ].organ = static_cast<std::uint32_t>(organ);
    }
  }

  /// Where an organ is simulated, and its index there.
  std::pair<deformation::DeformationStage*, std::size_t> owner_of(std::size_t organ) const {
    const std::size_t process = scene.organs.at(organ).process;
    PALPATE_DEMAND(process <= deformation.size() && deformation[process - 1] != nullptr);
    const auto own = scene::organs_of(scene, process);
    return {deformation[process - 1],
            static_cast<std::size_t>(std::find(own.begin(), own.end(), organ) - own.begin())};
  }

  ~Impl() {
    if (troubles != nullptr) *troubles += contact_troubles();
  }

  ContactTroubles contact_troubles() const {
    ContactTroubles sum;
    for (const Member& member : members) sum += member.health.contacts;
    return sum;
  }

  bus::Bus& stages_bus() { return tapped ? *tapped : static_cast<bus::Bus&>(carrier); }

  void add(const std::string& module, const InProcessOptions& options, const MakeStage& usual) {
    if (!options.make) return add(module, usual);
    add(module, [&](bus::Bus& bus) { return options.make(module, bus, usual); });
  }

  void add(const std::string& module, const MakeStage& make) {
    const std::size_t others = stages_bus().inputs().size();
    const std::size_t others_out = stages_bus().outputs().size();
    auto stage = make(stages_bus());
    if (stage == nullptr) return;
    const auto own = stages_bus().inputs().subspan(others);
    const auto outputs = stages_bus().outputs().subspan(others_out);
    members.push_back({module,
                       std::move(stage),
                       {outputs.begin(), outputs.end()},
                       {scene, module, std::vector<bus::Input*>(own.begin(), own.end())},
                       {}});
    if (from.modules.empty()) return;
    Member& member = members.back();
    runtime::go_on_from(from, from_file, module, member.cursor, *member.stage, member.outputs);
  }

  runtime::Snapshot snapshot() {
    runtime::Snapshot now{next_ns()};
    for (Member& member : members) {
      runtime::add_to(now, member.module, member.cursor, *member.stage, member.outputs);
    }
    return now;
  }

  std::int64_t next_ns() const {
    const auto earlier = [](const Member& a, const Member& b) {
      return a.cursor.next_ns() < b.cursor.next_ns();
    };
    return std::min_element(members.begin(), members.end(), earlier)->cursor.next_ns();
  }

  void tick() {
    const std::int64_t now_ns = clock_ns = next_ns();
    for (Member& member : members) {
      if (member.cursor.next_ns() != now_ns) continue;
      member.health = member.cursor.step(*member.stage);
    }
    listen();
  }

  void finish(std::int64_t end_ns) {
    for (Member& member : members) member.cursor.finish(*member.stage, end_ns);
  }

  void listen() {
    probes.listen();
    contacts.listen();
    models.listen();
    forces.listen();
    nodes.listen();
    surfaces.listen();
  }

  const scene::Scene scene;
  ContactTroubles* troubles;
  const runtime::Snapshot from;  ///< without modules: none
  const std::filesystem::path from_file;
  std::int64_t clock_ns = runtime::CycleGrid::kSetUp;
  bus::MemoryBus carrier{true};
  std::unique_ptr<bus::Bus> tapped;
  Newest<ProbeState> probes;
  Newest<Contacts> contacts;
  Newest<ContactModel> models;
  Newest<HapticForce> forces;
  Newest<NodePositions> nodes;
  Newest<SurfaceTopology> surfaces;
  std::vector<std::string> warnings;
  haptics::HapticsStage* haptics = nullptr;
  std::vector<deformation::DeformationStage*> deformation;  ///< by process
  std::vector<Member> members;                              ///< in the order of runtime::kModules
};

InProcess::InProcess(const scene::Scene& scene, Assets assets, const InProcessOptions& options)
    : impl_(std::make_unique<Impl>(scene, std::move(assets), options)) {}

InProcess::~InProcess() = default;
InProcess::InProcess(InProcess&&) noexcept = default;

void InProcess::add(const std::string& module, const MakeStage& make) { impl_->add(module, make); }

void InProcess::run_until(double time) {
  const std::int64_t until_ns = ns_from_seconds(time);
  while (impl_->next_ns() < until_ns) impl_->tick();
}

void InProcess::tick() { impl_->tick(); }
double InProcess::time() const { return seconds_from_ns(impl_->next_ns()); }
runtime::Snapshot InProcess::snapshot() { return impl_->snapshot(); }
void InProcess::finish(double time) { impl_->finish(ns_from_seconds(time)); }

const scene::Scene& InProcess::scene() const { return impl_->scene; }
bus::Bus& InProcess::bus() { return impl_->carrier; }
haptics::HapticsStage& InProcess::haptics() {
  PALPATE_DEMAND(impl_->haptics != nullptr);
  return *impl_->haptics;
}
const deformation::DeformationStage& InProcess::deformation() const {
  PALPATE_DEMAND(impl_->deformation.size() == 1);
  return *impl_->deformation.front();
}

const runtime::Health& InProcess::health(const std::string& module) const {
  const auto found = std::find_if(impl_->members.begin(), impl_->members.end(),
                                  [&](const Member& member) { return member.module == module; });
  PALPATE_DEMAND(found != impl_->members.end());
  return found->health;
}

void InProcess::ask_for_volume(std::size_t organ, double ratio) {
  const auto [stage, own] = impl_->owner_of(organ);
  stage->ask_for_volume(own, ratio);
}

std::vector<std::pair<std::string, runtime::Health>> InProcess::healths() const {
  std::vector<std::pair<std::string, runtime::Health>> all;
  for (const Member& member : impl_->members) all.emplace_back(member.module, member.health);
  return all;
}

ContactTroubles InProcess::contact_troubles() const { return impl_->contact_troubles(); }

const ProbeState& InProcess::probe(std::size_t probe) const { return impl_->probes[probe]; }
const Contacts& InProcess::contacts(std::size_t probe) const { return impl_->contacts[probe]; }
const ContactModel& InProcess::contact_model(std::size_t probe) const {
  return impl_->models[probe];
}
const HapticForce& InProcess::haptic_force(std::size_t probe) const { return impl_->forces[probe]; }
const NodePositions& InProcess::node_positions(std::size_t organ) const {
  return impl_->nodes[organ];
}
const SurfaceTopology& InProcess::surface(std::size_t organ) const {
  return impl_->surfaces[organ];
}

template <>
std::shared_ptr<const ProbeState> InProcess::shared(std::size_t probe) const {
  return impl_->probes.shared(probe);
}
template <>
std::shared_ptr<const Contacts> InProcess::shared(std::size_t probe) const {
  return impl_->contacts.shared(probe);
}
template <>
std::shared_ptr<const ContactModel> InProcess::shared(std::size_t probe) const {
  return impl_->models.shared(probe);
}
template <>
std::shared_ptr<const HapticForce> InProcess::shared(std::size_t probe) const {
  return impl_->forces.shared(probe);
}
template <>
std::shared_ptr<const NodePositions> InProcess::shared(std::size_t organ) const {
  return impl_->nodes.shared(organ);
}
template <>
std::shared_ptr<const SurfaceTopology> InProcess::shared(std::size_t organ) const {
  return impl_->surfaces.shared(organ);
}

InProcess load_session(const scene::Scene& scene) { return InProcess(scene, load_assets(scene)); }

}  // namespace palpate::session
