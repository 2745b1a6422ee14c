#include "collision/stage.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "collision/activation_distance.h"
#include "collision/contact_reduction.h"
#include "collision/organ_inputs.h"
#include "modules/core/error.h"
#include "modules/core/tolerances.h"
#include "modules/core/units.h"
#include "modules/messages/message_state.h"
#include "modules/runtime/pause_watch.h"
#include "modules/runtime/silence_watch.h"
#include "modules/runtime/wiring.h"
#include "modules/scene/assets.h"

namespace palpate::collision {
namespace {

/// The probes' ways from search to search.
class ProbeInputs {
 public:
  ProbeInputs(bus::Bus& bus, const scene::Scene& scene)
      : states_(bus.reader(bus::kProbeState)),
        probes_(scene.probes.size()),
        heard_(scene.probes.size(), runtime::input_stale_after(scene)) {}

  void take() {
    while (states_.take(newest_)) {
      const bool said_before = newest_.header.source_time_ns < since_ns_;
      if (newest_.probe >= probes_.size() || said_before) continue;
      Way& way = probes_[newest_.probe];
      if (!way.known) {
        way.searched = newest_.pose;
        way.searched_ns = newest_.header.source_time_ns;
      }
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
    way.searched_ns = way.newest.header.source_time_ns;
    return motion;
  }

  /// Nothing is known of any until something is heard of it that was said since.
  void hear_anew(std::int64_t since_ns) {
    for (Way& way : probes_) way = {};
    since_ns_ = since_ns;
  }
  /// A probe that fell silent or jumped begins where it is found again.
  void lose(std::size_t probe) { probes_[probe].known = false; }

  /// Has it moved faster than a hand since it was searched?
  bool jumped(std::size_t probe) const {
    const Way& way = probes_[probe];
    const std::int64_t since_ns = way.newest.header.source_time_ns - way.searched_ns;
    return way.known && (way.newest.pose.position - way.searched.position).norm() >
                            kMaxProbeSpeed * seconds_from_ns(since_ns) + kDirectionless;
  }
  /// Begins where it is.
  void begin_anew(std::size_t probe) { probes_[probe].searched = probes_[probe].newest.pose; }

  const ProbeState& newest(std::size_t probe) const { return probes_[probe].newest; }
  bool heard_of(std::size_t probe) const { return newest(probe).header.sequence != 0; }
  std::size_t count() const { return probes_.size(); }
  bool silent(std::size_t probe, std::int64_t now_ns) const { return heard_.silent(probe, now_ns); }

  void exchange(StateArchive& archive) {
    archive.same(probes_.size());
    for (Way& way : probes_) {
      archive(way.known, way.searched, way.searched_ns);
      messages::exchange_message(archive, way.newest);
    }
    archive(heard_);
  }

 private:
  struct Way {
    bool known = false;
    ProbeState newest;
    Pose searched;
    std::int64_t searched_ns = 0;  ///< source time of the state searched last
  };
  bus::Reader<ProbeState> states_;
  std::vector<Way> probes_;
  runtime::SilenceWatch heard_;
  std::int64_t since_ns_ = std::numeric_limits<std::int64_t>::min();
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

/// What acted in a cycle, on any probe.
struct Acted {
  bool silent = false, truncated = false, boxes_misfit = false;
  SearchReport found;
};

/// What a message holds.
constexpr ContactLimits kLimits{kUsualContacts, kMaxFacesPerProbe, kMaxFaceNodes,
                                kMaxContactsPerProbe};

const char* acting_guard(const Acted& acted) {
  if (acted.found.was_lost) {
    return "a probe was inside an organ without contact: the nearest wall pushes it out";
  }
  if (acted.found.was_cut) {
    return "a probe's mesh is too fine for its speed: not all that it went past was searched";
  }
  if (acted.truncated)
    return "more contacts than a message holds: the deepest are kept, the others pass";
  if (acted.found.begun_inside) {
    return "a probe was first heard of inside an organ: the nearest wall pushes it out, gently";
  }
  if (acted.found.wall_was_cut) {
    return "a probe is behind finely meshed skin: only what is nearest to it was searched";
  }
  if (acted.found.looked_less_ahead) {
    return "a probe's mesh is too fine for its speed: it was searched less far ahead";
  }
  if (acted.boxes_misfit) {
    return "node_positions tells boxes of other blocks than surface: they are made here";
  }
  return acted.silent ? "no news of a probe: it touches nothing until it is heard again" : "";
}

}  // namespace

struct CollisionStage::Impl {
  Impl(const scene::Scene& scene, std::vector<geometry::ProbeForm> forms, bus::Bus& bus)
      : rates(scene.rates),
        organs(bus, std::move(forms), scene.organs),
        probes(bus, scene),
        writer(bus.writer(bus::kContacts)),
        pauses(1 / scene.rates.collision) {}

  /// A process that was stopped goes on as one that begins anew: it says nothing before it has
  /// heard where probes and organs are. What waits to be heard is of its stop's beginning.
  void take(const runtime::Cycle& now) {
    if (pauses.was_stopped(now.now_ns, now.computed_ns)) {
      organs.hear_anew(now.now_ns);
      probes.hear_anew(now.now_ns);
    }
    organs.take();
    probes.take();
  }

  /// Contacts of a probe on its way since the last search; none if it is silent. A probe that was
  /// silent or jumped has no way: it is heard of for the first time.
  void search(const runtime::Cycle& now, std::uint32_t probe, Acted& acted) {
    const ProbeState& state = probes.newest(probe);
    contacts.probe = probe;
    contacts.probe_pose = state.pose;
    contacts.clear();
    if (probes.silent(probe, now.now_ns)) {
      acted.silent = true;
      probes.lose(probe);
      return organs.finder()->forget(probe);
    }
    if (probes.jumped(probe)) {
      probes.begin_anew(probe);
      organs.finder()->forget(probe);
    }
    const scene::Rates present = present_rates(rates, organs.interval());
    ProbeMotion motion = probes.motion(probe);
    motion.ahead_W = blind_time(present) * state.twist.linear;
    const double margin = activation_distance(present, state.twist.linear.norm());
    const SearchReport found = organs.finder()->find(probe, motion, margin, kLimits, contacts);
    acted.found.begun_inside |= found.begun_inside;
    acted.found.was_lost |= found.was_lost;
    acted.found.wall_was_cut |= found.wall_was_cut;
    acted.found.looked_less_ahead |= found.looked_less_ahead;
    acted.found.was_cut |= found.was_cut;
    acted.truncated |= contacts.truncated;
    troubles.truncated += contacts.truncated;
    troubles.lost += found.was_lost;
  }

  scene::Rates rates;
  OrganInputs organs;
  ProbeInputs probes;
  bus::Writer<Contacts> writer;
  Contacts contacts;
  ContactTroubles troubles;
  runtime::PauseWatch pauses;
  bool begun_before = false;  ///< a probe inside, and the session does not run yet
};

std::vector<geometry::ProbeForm> probes_of(const scene::Scene& scene,
                                           std::vector<geometry::TriangleSurface> meshes) {
  PALPATE_DEMAND(meshes.size() == scene.probes.size());
  std::vector<geometry::ProbeForm> probes;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    probes.push_back(scene::form_of(scene.probes[i].shape, std::move(meshes[i])));
  }
  return probes;
}

std::vector<geometry::ProbeForm> load_probes(const scene::Scene& scene) {
  return probes_of(scene, scene::load_probe_meshes(scene));
}

CollisionStage::CollisionStage(const scene::Scene& scene, std::vector<geometry::ProbeForm> probes,
                               bus::Bus& bus)
    : impl_(std::make_unique<Impl>(scene, std::move(probes), bus)) {}

CollisionStage::~CollisionStage() = default;

void CollisionStage::exchange(StateArchive& archive) {
  archive(impl_->organs, impl_->probes, impl_->troubles);
}

void CollisionStage::prepare() { impl_->organs.take(); }

runtime::Health CollisionStage::cycle(const runtime::Cycle& now) {
  impl_->take(now);
  ContactFinder* finder = impl_->organs.finder();
  runtime::Health health;
  health.ready = finder != nullptr;
  if (!health.ready) return health;
  if (now.reset) finder->reset();
  if (!impl_->organs.placed()) return health;
  Acted acted;
  for (std::uint32_t probe = 0; probe < impl_->probes.count(); ++probe) {
    if (!impl_->probes.heard_of(probe)) {
      acted.silent = true;
      continue;
    }
    impl_->search(now, probe, acted);
    impl_->contacts.header = now.header();
    impl_->organs.tell_generations(impl_->contacts.generations);
    impl_->writer.write(impl_->contacts);
  }
  acted.boxes_misfit = impl_->organs.boxes_misfit();
  // What begins while the session waits is told as that begins: until then nobody is degraded.
  impl_->begun_before |= acted.found.begun_inside;
  if (now.running) acted.found.begun_inside = std::exchange(impl_->begun_before, false);
  health.guard = acting_guard(acted);
  health.contacts = impl_->troubles;
  return health;
}

}  // namespace palpate::collision
