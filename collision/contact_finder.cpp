#include "collision/contact_finder.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "collision/core_contacts.h"
#include "collision/edge_contacts.h"
#include "collision/front_contacts.h"
#include "collision/near_surface.h"
#include "collision/node_contacts.h"
#include "collision/probe_model.h"
#include "collision/surface_change.h"
#include "modules/core/error.h"
#include "modules/core/sort_unique.h"
#include "modules/core/tolerances.h"
#include "modules/geometry/continuous_collision.h"

namespace palpate::collision {
namespace {

/// A vertex of the probe and a candidate triangle near it.
using VertexPair = PairSorter::Pair;

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
      hold(step, core_of(static_cast<std::uint32_t>(i)));
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
      cores_.append_near_wall(step, core_of(core), triangle_list_);
      near_.clear();
      near_.add(step, triangle_list_);
      cores_.find(step, core_of(core), near_.triangles(), found_);
    }
  }

  Core core_of(std::uint32_t index) const {
    if (!model_.sharp) return model_.cores[index];
    const std::size_t corners = model_.sharp->vertices().size();
    if (index >= corners) return model_.lines[index - corners];
    const Vec3& x = model_.sharp->vertices()[index];
    return {index, x, x, 0};
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
    held_.clear();
    if (model_.sharp) cores_.append_held(step.organ_index, held_);
    wall_pairs_.clear();
    for (const std::uint32_t vertex : held_) {
      const std::size_t first = triangle_list_.size();
      cores_.append_near_wall(step, core_of(vertex), triangle_list_);
      for (std::size_t i = first; i < triangle_list_.size(); ++i) {
        wall_pairs_.push_back({vertex, triangle_list_[i]});
      }
    }
    near_.add(step, triangle_list_);
    step.depth_limit += near_.travel();
    return false;
  }

  void find_sharp(const OrganStep& step) {
    node_list_.clear();
    nodes_.append_remembered(step.organ_index, node_list_);
    near_.append_nodes(node_list_);
    nodes_.find(step, *model_.solid, node_list_, found_);

    first_choice_ = found_.size();
    choice_left_ = kManyFound;
    gather_pairs(step);
    find_vertices(step);
    edge_list_.clear();
    for (const SweptTriangle& t : near_.triangles()) {
      const auto& edges = step.organ.edges_of_triangle(t.index);
      edge_list_.insert(edge_list_.end(), edges.begin(), edges.end());
    }
    edges_.append_remembered(step.organ_index, edge_list_);
    sort_unique(edge_list_);
    const auto searched = edges_.find(step, *model_.sharp, edge_list_, found_);
    report_.looked_less_ahead |= searched != EdgeContacts::Searched::kAll;
    report_.was_cut |= searched == EdgeContacts::Searched::kPart;
  }

  /// Vertices of the probe with the organ's triangles near them. Where those are very many, with
  /// each triangle those that it may go past in the step, and of the others the nearest.
  void gather_pairs(const OrganStep& step) {
    const std::vector<SweptTriangle>& triangles = near_.triangles();
    const std::size_t many = std::max(kManyPairs, kFewestOfEach * triangles.size());
    vertex_pairs_.clear();
    for (std::uint32_t i = 0; i < triangles.size(); ++i) {
      pair_vertices_in(step, triangles[i].bounds(), step.margin, i);
      if (vertex_pairs_.size() > many) return gather_nearest_pairs(step, many / triangles.size());
    }
    add_wall_pairs();
  }

  void pair_vertices_in(const OrganStep& step, Bounds box, double beside, std::uint32_t triangle) {
    box.inflate(beside + step.motion.chord_error());
    near_vertices_.clear();
    model_.sharp->append_vertices(box, near_vertices_);
    for (const std::uint32_t vertex : near_vertices_) vertex_pairs_.push_back({vertex, triangle});
  }

  void gather_nearest_pairs(const OrganStep& step, std::size_t of_each) {
    const std::vector<SweptTriangle>& triangles = near_.triangles();
    vertex_pairs_.clear();
    std::size_t passed = 0;
    for (std::uint32_t i = 0; i < triangles.size(); ++i) {
      if (passed <= kMostPassed) {
        pair_vertices_in(step, triangles[i].bounds(), geometry::kImpactTolerance, i);
        passed += near_vertices_.size();
      }
      near_vertices_.clear();
      model_.sharp->append_nearest_vertices(triangles[i].end, step.margin, of_each, near_vertices_);
      for (const std::uint32_t vertex : near_vertices_) vertex_pairs_.push_back({vertex, i});
    }
    report_.was_cut |= passed > kMostPassed;
    add_wall_pairs();
  }

  void add_wall_pairs() {
    const std::vector<SweptTriangle>& triangles = near_.triangles();
    for (const auto& [vertex, t] : wall_pairs_) {
      const auto at =
          std::lower_bound(triangles.begin(), triangles.end(), t,
                           [](const SweptTriangle& s, std::uint32_t k) { return s.index < k; });
      if (at != triangles.end() && at->index == t) {
        vertex_pairs_.push_back({vertex, static_cast<std::uint32_t>(at - triangles.begin())});
      }
    }
    sorter_.sort_unique(vertex_pairs_, model_.sharp->vertices().size() + model_.lines.size());
  }

  void find_vertices(const OrganStep& step) {
    for (auto first = vertex_pairs_.begin(); first != vertex_pairs_.end();) {
      const std::uint32_t vertex = first->first;
      near_triangles_.clear();
      for (; first != vertex_pairs_.end() && first->first == vertex; ++first) {
        near_triangles_.push_back(near_.triangles()[first->second]);
      }
      cores_.find(step, core_of(vertex), near_triangles_, found_);
      leave_choice_of_many();
    }
  }

  void leave_choice_of_many() {
    if (found_.size() - first_choice_ < choice_left_) return;
    leave_choice(found_, first_choice_, limits_, reach_);
    choice_left_ = found_.size() - first_choice_ + kManyFound;
  }

  /// More pairs of a vertex and a triangle, and more than so many with each triangle, are not all
  /// looked at; of those that may have gone past each other so many.
  static constexpr std::size_t kManyPairs = 65536, kFewestOfEach = 16, kMostPassed = 262144;
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
  std::vector<SweptTriangle> near_triangles_;
  std::vector<std::uint32_t> triangle_list_, node_list_, edge_list_, near_vertices_, held_;
  std::vector<VertexPair> vertex_pairs_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> wall_pairs_;  ///< held vertex, triangle
  PairSorter sorter_;
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
