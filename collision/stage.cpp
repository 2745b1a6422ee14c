#include "collision/stage.h"

#include <algorithm>
#include <optional>

#include "collision/activation_distance.h"
#include "collision/contact_reduction.h"
#include "modules/core/error.h"
#include "modules/core/tolerances.h"
#include "modules/core/units.h"
#include "modules/messages/message_state.h"
#include "modules/runtime/wiring.h"
#include "modules/scene/assets.h"

namespace palpate::collision {
namespace {

/// Surfaces of an organ that wait for their positions.
constexpr std::size_t kMostTold = 8;

/// The organs' surfaces as deformation tells them, kept in a finder.
class OrganInputs {
 public:
  OrganInputs(bus::Bus& bus, std::vector<geometry::ProbeForm> probes, std::size_t organs)
      : surfaces_(bus.reader(bus::kSurface)),
        positions_(bus.reader(bus::kNodePositions)),
        probes_(std::move(probes)),
        organs_(organs) {}

  void take() {
    while (surfaces_.take(surface_)) take_surface();
    while (positions_.take(newest_)) take_positions();
  }

  /// nullptr until the surfaces of all organs are known.
  ContactFinder* finder() { return finder_ ? &*finder_ : nullptr; }
  /// By organ: of the surface that is searched.
  void tell_generations(std::vector<std::uint32_t>& generations) const {
    generations.clear();
    for (const OrganInput& organ : organs_) generations.push_back(organ.generation);
  }
  /// Of node positions, as they come [s]; 0 before the second.
  double interval() const { return interval_; }
  /// Are the newest boxes of an organ so many that they cannot be its blocks'?
  bool boxes_misfit() const {
    return std::any_of(organs_.begin(), organs_.end(),
                       [](const OrganInput& organ) { return organ.boxes_misfit; });
  }

  void exchange(StateArchive& archive) {
    archive.same(organs_.size());
    for (OrganInput& organ : organs_) archive(organ);
    bool has_finder = finder_.has_value();
    archive(has_finder, came_ns_, interval_);
    if (archive.reads() && has_finder) make_finder();
    if (finder_) archive(*finder_);
  }

 private:
  struct OrganInput {
    std::uint32_t generation = 0;
    std::vector<geometry::Triangle> triangles;
    std::vector<std::uint32_t> triangle_blocks;
    std::size_t surface_node_count = 0;
    std::vector<float> rest_positions;  ///< x, y, z per node [m]
    std::size_t block_count = 0;        ///< of triangle_blocks
    /// Told, the newest last, but no positions have come that are of them. A mesh that changes in
    /// every advance has its next surface told together with the positions of the one before.
    std::vector<SurfaceTopology> next;
    bool boxes_misfit = false;  ///< of the newest node positions

    void exchange(StateArchive& archive) {
      archive(generation, triangles, triangle_blocks, surface_node_count, rest_positions,
              block_count, boxes_misfit);
      std::size_t told = next.size();
      archive(told);
      if (told > kMostTold) throw InputError("its state holds surfaces that cannot be");
      next.resize(told);
      for (SurfaceTopology& surface : next) messages::exchange_message(archive, surface);
    }
  };

  static void read_boxes(std::span<const float> from, std::vector<geometry::BlockBox>& boxes) {
    boxes.resize(from.size() / 6);
    for (geometry::BlockBox& box : boxes) {
      std::copy_n(from.begin(), 3, box.lower.begin());
      std::copy_n(from.begin() + 3, 3, box.upper.begin());
      from = from.subspan(6);
    }
  }

  /// The first surface puts its organ at rest. One of the same triangles starts it anew: what was
  /// remembered of the search before no longer holds. One of others waits for its positions: until
  /// then the organ is where it was.
  void take_surface() {
    if (surface_.organ >= organs_.size()) return;
    OrganInput& organ = organs_[surface_.organ];
    if (!finder_ || surface_.triangles.empty()) {
      know(surface_, organ);
      return make_finder();
    }
    if (!organ.next.empty() || organ.triangles != surface_.triangles ||
        organ.triangle_blocks != surface_.triangle_blocks) {
      if (organ.next.size() == kMostTold) organ.next.erase(organ.next.begin());
      organ.next.push_back(surface_);
      return;
    }
    know(surface_, organ);
    finder_->reset();
    put_at_rest(surface_.organ);
  }

  static void know(const SurfaceTopology& surface, OrganInput& organ) {
    organ.generation = surface.generation;
    organ.surface_node_count = surface.surface_node_count;
    organ.triangles = surface.triangles;
    organ.triangle_blocks = surface.triangle_blocks;
    organ.block_count = 0;
    for (const std::uint32_t block : organ.triangle_blocks) {
      organ.block_count = std::max(organ.block_count, std::size_t{block} + 1);
    }
    organ.rest_positions = surface.rest_positions;
  }

  static std::vector<Vec3> rest_of(const OrganInput& organ) {
    std::vector<Vec3> rest;
    for (std::size_t i = 0; i < organ.surface_node_count; ++i) {
      const float* x = organ.rest_positions.data() + 3 * i;
      rest.emplace_back(x[0], x[1], x[2]);
    }
    return rest;
  }

  /// The surface told last that positions of a generation are of, if it waits for them.
  void take_next(std::size_t index, std::uint32_t generation) {
    OrganInput& organ = organs_[index];
    const auto told = std::find_if(
        organ.next.rbegin(), organ.next.rend(),
        [&](const SurfaceTopology& surface) { return surface.generation == generation; });
    if (told == organ.next.rend()) return;
    const std::vector<Vec3> before = rest_of(organ);
    know(*told, organ);
    organ.next.erase(organ.next.begin(), told.base());
    finder_->change_organ(index, organ.triangles, organ.triangle_blocks, before, rest_of(organ));
  }

  void put_at_rest(std::size_t organ) {
    std::vector<float> positions = organs_[organ].rest_positions;
    std::vector<geometry::BlockBox> boxes;
    finder_->take_organ(organ, positions, boxes);
  }

  void make_finder() {
    finder_.reset();
    std::vector<std::vector<geometry::Triangle>> triangles;
    std::vector<std::vector<std::uint32_t>> blocks;
    for (const OrganInput& organ : organs_) {
      if (organ.triangles.empty()) return;
      triangles.push_back(organ.triangles);
      blocks.push_back(organ.triangle_blocks);
    }
    finder_.emplace(std::move(triangles), probes_, blocks);
    for (std::size_t i = 0; i < organs_.size(); ++i) put_at_rest(i);
  }

  /// Positions of another generation than the surface's wait for their surface.
  void take_positions() {
    if (newest_.organ >= organs_.size() || !finder_) return;
    OrganInput& organ = organs_[newest_.organ];
    if (newest_.generation != organ.generation) take_next(newest_.organ, newest_.generation);
    if (newest_.generation != organ.generation ||
        newest_.positions.size() < 3 * organ.surface_node_count) {
      return;
    }
    read_boxes(newest_.block_boxes, boxes_);
    organ.boxes_misfit = !boxes_.empty() && boxes_.size() != organ.block_count;
    finder_->take_organ(newest_.organ, newest_.positions, boxes_);
    if (newest_.organ != 0) return;
    if (came_ns_ != 0) interval_ = seconds_from_ns(newest_.header.source_time_ns - came_ns_);
    came_ns_ = newest_.header.source_time_ns;
  }

  bus::Reader<SurfaceTopology> surfaces_;
  bus::Reader<NodePositions> positions_;
  std::vector<geometry::ProbeForm> probes_;
  std::vector<OrganInput> organs_;
  std::optional<ContactFinder> finder_;
  SurfaceTopology surface_;
  NodePositions newest_;
  std::vector<geometry::BlockBox> boxes_;
  std::int64_t came_ns_ = 0;
  double interval_ = 0;
};

/// The probes' ways from search to search.
class ProbeInputs {
 public:
  ProbeInputs(bus::Bus& bus, const scene::Scene& scene)
      : states_(bus.reader(bus::kProbeState)),
        probes_(scene.probes.size()),
        heard_(scene.probes.size(), runtime::input_stale_after(scene)) {}

  void take() {
    while (states_.take(newest_)) {
      if (newest_.probe >= probes_.size()) continue;
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
constexpr ContactLimits kLimits{kMaxContactsPerProbe, kMaxFacesPerProbe, kMaxFaceNodes};

const char* acting_guard(const Acted& acted) {
  if (acted.found.was_lost) {
    return "a probe was inside an organ without contact: the nearest wall pushes it out";
  }
  if (acted.truncated)
    return "more contacts than a message holds: the deepest are kept, the others pass";
  if (acted.found.begun_inside) {
    return "a probe was first heard of inside an organ: the nearest wall pushes it out, gently";
  }
  if (acted.found.wall_was_cut) {
    return "a probe is behind finely meshed skin: only what is nearest to it was searched";
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
        organs(bus, std::move(forms), scene.organs.size()),
        probes(bus, scene),
        writer(bus.writer(bus::kContacts)) {}

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
    const double margin =
        activation_distance(present_rates(rates, organs.interval()), state.twist.linear.norm());
    const SearchReport found =
        organs.finder()->find(probe, probes.motion(probe), margin, kLimits, contacts);
    acted.found.begun_inside |= found.begun_inside;
    acted.found.was_lost |= found.was_lost;
    acted.found.wall_was_cut |= found.wall_was_cut;
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
  std::vector<geometry::TriangleSurface> meshes;
  for (const auto& probe : scene.probes) meshes.push_back(scene::load_probe_mesh(probe));
  return probes_of(scene, std::move(meshes));
}

CollisionStage::CollisionStage(const scene::Scene& scene, std::vector<geometry::ProbeForm> probes,
                               bus::Bus& bus)
    : impl_(std::make_unique<Impl>(scene, std::move(probes), bus)) {}

CollisionStage::~CollisionStage() = default;

void CollisionStage::exchange(StateArchive& archive) {
  archive(impl_->organs, impl_->probes, impl_->troubles);
}

runtime::Health CollisionStage::cycle(const runtime::Cycle& now) {
  impl_->organs.take();
  impl_->probes.take();
  ContactFinder* finder = impl_->organs.finder();
  runtime::Health health;
  health.ready = finder != nullptr;
  if (!health.ready) return health;
  if (now.reset) finder->reset();
  Acted acted;
  for (std::uint32_t probe = 0; probe < impl_->probes.count(); ++probe) {
    impl_->search(now, probe, acted);
    impl_->contacts.header = now.header();
    impl_->organs.tell_generations(impl_->contacts.generations);
    impl_->writer.write(impl_->contacts);
  }
  acted.boxes_misfit = impl_->organs.boxes_misfit();
  health.guard = acting_guard(acted);
  health.contacts = impl_->troubles;
  return health;
}

}  // namespace palpate::collision
