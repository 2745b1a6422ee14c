#include "collision/contact_finder.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "collision/core_contacts.h"
#include "collision/corner_pairs.h"
#include "collision/edge_contacts.h"
#include "collision/front_contacts.h"
#include "collision/near_surface.h"
#include "collision/node_contacts.h"
#include "collision/probe_model.h"
#include "collision/surface_change.h"
#include "modules/core/error.h"
#include "modules/core/sort_unique.h"
#include "modules/core/tolerances.h"

namespace palpate::collision {
namespace {

/// One probe and what it remembers of its last step.
class ProbeSearch {
 public:
  explicit ProbeSearch(geometry::ProbeForm form) : model_(std::move(form)) {}

  void reset() {
    cores_.reset();
    nodes_.reset();
    edges_.reset();
    seen_versions_.clear();
  }

  void exchange(StateArchive& archive) { archive(cores_, nodes_, edges_, seen_versions_); }

  void change_surface(const SurfaceChange& change) {
    cores_.change_surface(change);
    nodes_.change_surface(change);
    edges_.change_surface(change);
    if (change.organ >= seen_versions_.size() || seen_versions_[change.organ] == 0) return;
    seen_versions_[change.organ] = change.after.version();
  }

  SearchReport find(const ProbeMotion& motion, double margin, std::vector<OrganSurface>& organs,
                    const ContactLimits& limits, ContactSet& result) {
    report_ = {};
    const RelativeMotion relative(motion, model_.reach, model_.is_round);
    limits_ = limits;
    reach_ = {relative.direction_at_end(motion.ahead_W), margin};
    cores_.begin_step();
    nodes_.begin_step();
    edges_.begin_step();
    seen_versions_.resize(organs.size(), 0);
    found_.clear();
    for (std::uint32_t i = 0; i < organs.size(); ++i) {
      OrganSurface& organ = organs[i];
      if (!organ.present()) continue;
      OrganStep step{i,        organ,
                     relative, seen_versions_[i],
                     margin,   model_.max_tracked_penetration + relative.travel()};
      const bool first = seen_versions_[i] == 0;
      if (first) {
        hold_inside(step, 1);
        hold_lines_inside(step);
        report_.begun_inside |= !held_.empty();
      }
      const std::size_t others = found_.size();
      find_on(step);
      if (!first && !pushes(others)) report_.was_lost |= find_lost(step);
      if (!first && !pushes(others)) find_within(step);
      seen_versions_[i] = organ.version();
      organ.mark_found();
    }
    report_.wall_was_cut = cores_.wall_was_cut();
    reduce_contacts(found_, !model_.cores.empty(), limits, result, reach_);
    result.truncated |= report_.was_cut;
    return report_;
  }

 private:
  /// Puts a core that is inside, and of which nothing is remembered, behind the nearest wall:
  /// held_.
  void hold(const OrganStep& step, const Core& core) {
    if (cores_.hold_if_inside(step, core)) held_.push_back(core.index);
  }

  /// The same of all cores and corners: held_.
  /// @param every  the corners of a sharp probe that are looked at
  /// @returns whether there are any
  bool hold_inside(const OrganStep& step, std::size_t every) {
    held_.clear();
    for (const Core& core : model_.cores) hold(step, core);
    const std::size_t corners = model_.sharp ? model_.sharp->vertices().size() : 0;
    for (std::size_t i = 0; i < corners; i += every) {
      hold(step, model_.core(static_cast<std::uint32_t>(i)));
    }
    return !held_.empty();
  }

  /// The same of lines within a sharp probe.
  void hold_lines_inside(const OrganStep& step) {
    for (const Core& line : model_.lines) hold(step, line);
  }

  /// Is any contact from found_[first] on one of a probe that is deeper than the surface?
  bool pushes(std::size_t first) const {
    return std::any_of(found_.begin() + static_cast<std::ptrdiff_t>(first), found_.end(),
                       [](const FoundContact& c) { return c.gap < 0; });
  }

  /// Contacts for what lies between a sharp probe's corners, where nothing else tells of tissue.
  void find_within(const OrganStep& step) {
    held_.clear();
    hold_lines_inside(step);
    find_held(step);
  }

  /// The guard: contacts for a probe that is inside though no contact pushes it.
  bool find_lost(const OrganStep& step) {
    constexpr std::size_t kMostCorners = 16;
    const std::size_t corners = model_.sharp ? model_.sharp->vertices().size() : 0;
    if (!hold_inside(step, corners / kMostCorners + 1)) return false;
    find_held(step);
    return true;
  }

  void find_held(const OrganStep& step) {
    for (const std::uint32_t core : held_) {
      triangle_list_.clear();
      cores_.append_near_wall(step, model_.core(core), CornerPairs::kManyWallPairs, triangle_list_);
      near_.clear();
      near_.add(step, triangle_list_);
      cores_.find(step, model_.core(core), near_.triangles(), found_);
    }
  }

  void find_on(OrganStep& step) {
    if (!model_.is_bounded) {
      node_list_.clear();
      near_.gather_nodes(step, model_.hull, step.margin, node_list_);
      nodes_.append_remembered(step.organ_index, node_list_);
      sort_unique(node_list_);
      nodes_.find(step, *model_.solid, node_list_, found_);
      return;
    }
    if (gather_triangles(step)) return;
    for (const Core& core : model_.cores) cores_.find(step, core, near_.triangles(), found_);
    if (model_.sharp) find_sharp(step);
  }

  /// Every triangle the probe may touch in the step.
  /// @returns whether their contacts are found as well
  bool gather_triangles(OrganStep& step) {
    double reach = 0;
    triangle_list_.clear();
    bool all_behind = !model_.cores.empty();
    for (const Core& core : model_.cores) {
      const double of_wall = cores_.wall_reach(step, core);
      all_behind = all_behind && of_wall > 0;
      reach = std::max(reach, of_wall);
      cores_.append_remembered(step, core, triangle_list_);
    }
    // Behind a wall nothing else is touched; what a core goes through is met whatever the reach.
    if (!all_behind) reach = std::max(reach, model_.hull_radius + step.margin);
    const bool in_front = !model_.cores.empty() && triangle_list_.empty();
    if (in_front && near_.gather_front(step, model_.cores[0], step.margin)) {
      if (front_.find(step, model_.cores[0], near_, found_)) return true;
      near_.sweep_candidates(step);
    }
    if (!in_front) near_.gather(step, model_.hull, reach);
    if (model_.sharp) corners_.hold(step, model_, cores_, triangle_list_);
    near_.add(step, triangle_list_);
    step.depth_limit += near_.travel();
    return false;
  }

  void find_sharp(const OrganStep& step) {
    if (corners_.are_too_many(step, model_, near_.triangles())) look_straight_ahead(step);
    corners_.list(step, model_, near_.triangles());
    report_.was_cut |= corners_.was_cut();
    node_list_.clear();
    nodes_.append_remembered(step.organ_index, node_list_);
    near_.append_nodes(node_list_);
    nodes_.find(step, *model_.solid, node_list_, found_);

    first_choice_ = found_.size();
    choice_left_ = kManyFound;
    find_vertices(step);
    edge_list_.clear();
    for (const SweptTriangle& t : near_.triangles()) {
      const auto& edges = step.organ.edges_of_triangle(t.index);
      edge_list_.insert(edge_list_.end(), edges.begin(), edges.end());
    }
    edges_.append_remembered(step.organ_index, edge_list_);
    sort_unique(edge_list_);
    const auto searched = edges_.find(step, *model_.sharp, reach_, edge_list_, found_);
    report_.looked_less_ahead |= searched != EdgeContacts::Searched::kAll;
    report_.was_cut |= searched == EdgeContacts::Searched::kPart;
  }

  /// Of very many triangles those alone that it comes to as it goes on.
  void look_straight_ahead(const OrganStep& step) {
    Bounds way = model_.hull;
    way.add(way.lower + reach_.ahead_P);
    way.add(way.upper + reach_.ahead_P);
    near_.gather(step, way, model_.hull_radius + reach_.sideways());
    near_.add(step, triangle_list_);
    report_.looked_less_ahead = true;
  }

  void find_vertices(const OrganStep& step) {
    const auto pairs = corners_.pairs();
    for (auto first = pairs.begin(); first != pairs.end();) {
      const std::uint32_t vertex = first->first;
      near_triangles_.clear();
      for (; first != pairs.end() && first->first == vertex; ++first) {
        near_triangles_.push_back(near_.triangles()[first->second]);
      }
      cores_.find(step, model_.core(vertex), near_triangles_, found_);
      leave_choice_of_many();
    }
  }

  void leave_choice_of_many() {
    if (found_.size() - first_choice_ < choice_left_) return;
    leave_choice(found_, first_choice_, limits_, reach_);
    choice_left_ = found_.size() - first_choice_ + kManyFound;
  }

  /// As many contacts at once are found before it is asked which are needed.
  static constexpr std::size_t kManyFound = 8192;

  ProbeModel model_;
  CoreContacts cores_;
  NodeContacts nodes_;
  EdgeContacts edges_;
  std::vector<std::uint64_t> seen_versions_;  ///< per organ, in the last step

  // Of a call.
  SearchReport report_;
  ContactLimits limits_;
  ProbeReach reach_;
  std::size_t first_choice_ = 0, choice_left_ = 0;  ///< of found_: contacts of corners and edges
  // Kept between calls for their memory only.
  std::vector<FoundContact> found_;
  NearSurface near_;
  FrontContacts front_;
  CornerPairs corners_;
  std::vector<SweptTriangle> near_triangles_;
  std::vector<std::uint32_t> triangle_list_, node_list_, edge_list_, held_;
};

}  // namespace

struct ContactFinder::Impl {
  std::vector<OrganSurface> organs;
  std::vector<ProbeSearch> probes;
};

ContactFinder::ContactFinder(std::vector<std::vector<geometry::Triangle>> organ_triangles,
                             std::vector<geometry::ProbeForm> probes,
                             const std::vector<std::vector<std::uint32_t>>& blocks)
    : impl_(std::make_unique<Impl>()) {
  PALPATE_DEMAND(blocks.empty() || blocks.size() == organ_triangles.size());
  for (std::size_t i = 0; i < organ_triangles.size(); ++i) {
    std::span<const std::uint32_t> of_organ;
    if (!blocks.empty()) of_organ = blocks[i];
    impl_->organs.emplace_back(std::move(organ_triangles[i]), of_organ);
  }
  for (geometry::ProbeForm& probe : probes) impl_->probes.emplace_back(std::move(probe));
}

ContactFinder::~ContactFinder() = default;

void ContactFinder::update_organ(std::size_t organ, std::span<const Vec3> positions) {
  PALPATE_DEMAND(organ < impl_->organs.size());
  impl_->organs[organ].update(positions);
}

void ContactFinder::take_organ(std::size_t organ, std::vector<float>& positions,
                               std::vector<geometry::BlockBox>& boxes) {
  PALPATE_DEMAND(organ < impl_->organs.size());
  impl_->organs[organ].take(positions, boxes);
}

void ContactFinder::change_organ(std::size_t organ, std::vector<geometry::Triangle> triangles,
                                 std::span<const std::uint32_t> blocks,
                                 std::span<const Vec3> rest_before,
                                 std::span<const Vec3> rest_after) {
  PALPATE_DEMAND(organ < impl_->organs.size());
  OrganSurface& before = impl_->organs[organ];
  OrganSurface after(std::move(triangles), blocks);
  const geometry::SurfaceTransfer to(rest_before, before.triangles(), rest_after,
                                     after.triangles());
  if (before.present()) {
    const geometry::SurfaceTransfer back(rest_after, after.triangles(), rest_before,
                                         before.triangles());
    after.update(carried_positions(before, after, back));
    after.mark_found();
  }
  for (ProbeSearch& probe : impl_->probes) {
    probe.change_surface({static_cast<std::uint32_t>(organ), before, after, to});
  }
  before = std::move(after);
}

void ContactFinder::exchange(StateArchive& archive) {
  for (OrganSurface& organ : impl_->organs) archive(organ);
  for (ProbeSearch& probe : impl_->probes) archive(probe);
}

void ContactFinder::reset() {
  for (ProbeSearch& probe : impl_->probes) probe.reset();
}

void ContactFinder::forget(std::size_t probe) {
  PALPATE_DEMAND(probe < impl_->probes.size());
  impl_->probes[probe].reset();
}

SearchReport ContactFinder::find(std::size_t probe, const ProbeMotion& motion, double margin,
                                 const ContactLimits& limits, ContactSet& result) {
  PALPATE_DEMAND(probe < impl_->probes.size());
  PALPATE_DEMAND(margin > 0 && std::isfinite(margin));
  result.probe = static_cast<std::uint32_t>(probe);
  result.probe_pose = motion.pose_t1;
  result.clear();
  if (!is_believable(motion.pose_t0) || !is_believable(motion.pose_t1)) return {};
  return impl_->probes[probe].find(motion, margin, impl_->organs, limits, result);
}

}  // namespace palpate::collision
