#include "collision/contact_finder.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "collision/core_contacts.h"
#include "collision/edge_contacts.h"
#include "collision/node_contacts.h"
#include "collision/probe_model.h"
#include "modules/core/error.h"
#include "modules/core/sort_unique.h"
#include "modules/core/tolerances.h"

namespace palpate::collision {
namespace {

/// A vertex of the probe and a candidate triangle near it.
using VertexPair = std::pair<std::uint32_t, std::size_t>;

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

  SearchReport find(const ProbeMotion& motion, double margin, std::vector<OrganSurface>& organs,
                    std::size_t at_most, ContactSet& result) {
    SearchReport report;
    const RelativeMotion relative(motion, model_.reach, model_.is_round);
    cores_.begin_step();
    nodes_.begin_step();
    edges_.begin_step();
    seen_versions_.resize(organs.size(), 0);
    found_.clear();
    for (std::uint32_t i = 0; i < organs.size(); ++i) {
      OrganSurface& organ = organs[i];
      if (!organ.present()) continue;
      const double displacement = organ.displacement_since(seen_versions_[i]);
      const OrganStep step{
          i,        organ,
          relative, organ.positions_at(seen_versions_[i]),
          margin,   model_.max_tracked_penetration + relative.travel() + displacement};
      const bool first = seen_versions_[i] == 0;
      if (first) report.begun_inside |= hold_inside(step, 1);
      const std::size_t others = found_.size();
      find_on(step, displacement);
      if (!first && !pushes(others)) report.was_lost |= find_lost(step);
      seen_versions_[i] = organ.version();
      organ.mark_found();
    }
    reduce_contacts(found_, at_most, result);
    return report;
  }

 private:
  /// Puts cores that are inside, and of which nothing is remembered, behind the nearest wall.
  /// @param every  the corners of a sharp probe that are looked at
  /// @returns whether there are any
  bool hold_inside(const OrganStep& step, std::size_t every) {
    bool any = false;
    for (const Core& core : model_.cores) any |= cores_.hold_if_inside(step, core);
    if (!model_.sharp) return any;
    const std::size_t corners = model_.sharp->vertices().size();
    for (std::size_t i = 0; i < corners; i += every) {
      any |= cores_.hold_if_inside(step, core_of(static_cast<std::uint32_t>(i)));
    }
    return any;
  }

  /// Is any contact from found_[first] on one of a probe that is deeper than the surface?
  bool pushes(std::size_t first) const {
    return std::any_of(found_.begin() + static_cast<std::ptrdiff_t>(first), found_.end(),
                       [](const FoundContact& c) { return c.gap < 0; });
  }

  /// The guard: contacts for a probe that is inside though no contact pushes it.
  bool find_lost(const OrganStep& step) {
    constexpr std::size_t kMostCorners = 16;
    const std::size_t corners = model_.sharp ? model_.sharp->vertices().size() : 0;
    if (!hold_inside(step, corners / kMostCorners + 1)) return false;
    held_.clear();
    cores_.append_held(step.organ_index, held_);
    for (const std::uint32_t core : held_) {
      triangle_list_.clear();
      cores_.append_near_wall(step, core_of(core), triangle_list_);
      sweep_listed(step);
      cores_.find(step, core_of(core), triangles_, found_);
    }
    return true;
  }

  Core core_of(std::uint32_t index) const {
    if (!model_.sharp) return model_.cores[index];
    const Vec3& x = model_.sharp->vertices()[index];
    return {index, x, x, 0};
  }

  void find_on(const OrganStep& step, double displacement) {
    if (!model_.is_bounded) {
      node_list_.resize(step.organ.positions().size());
      for (std::uint32_t i = 0; i < node_list_.size(); ++i) node_list_[i] = i;
      nodes_.find(step, *model_.solid, node_list_, found_);
      return;
    }
    gather_triangles(step, displacement);
    for (const Core& core : model_.cores) cores_.find(step, core, triangles_, found_);
    if (model_.sharp) find_sharp(step);
  }

  /// Every triangle the probe may touch in the step, ascending.
  void gather_triangles(const OrganStep& step, double displacement) {
    Bounds box = step.motion.swept(model_.bounds);
    triangle_list_.clear();
    held_.clear();
    cores_.append_held(step.organ_index, held_);
    for (const std::uint32_t core : held_) {
      cores_.append_near_wall(step, core_of(core), triangle_list_);
    }
    box.inflate(step.margin + step.motion.chord_error() + displacement);
    step.organ.bvh().append_overlapping(box, triangle_list_);
    sweep_listed(step);
  }

  void sweep_listed(const OrganStep& step) {
    sort_unique(triangle_list_);
    triangles_.clear();
    SweptTriangle swept;
    for (const std::uint32_t triangle : triangle_list_) {
      if (step.sweep(triangle, swept)) triangles_.push_back(swept);
    }
  }

  void find_sharp(const OrganStep& step) {
    node_list_.clear();
    for (const SweptTriangle& t : triangles_) {
      node_list_.insert(node_list_.end(), t.nodes.begin(), t.nodes.end());
    }
    nodes_.append_remembered(step.organ_index, node_list_);
    sort_unique(node_list_);
    nodes_.find(step, *model_.solid, node_list_, found_);

    gather_pairs(step);
    find_vertices(step);
    edges_.find(step, *model_.sharp, edge_pairs_, found_);
  }

  /// Vertices and edges of the probe with the organ's triangles and edges near them.
  void gather_pairs(const OrganStep& step) {
    vertex_pairs_.clear();
    edge_pairs_.clear();
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      Bounds box = triangles_[i].bounds();
      box.inflate(step.margin + step.motion.chord_error());
      model_.sharp->features_near(box, near_vertices_, near_edges_);
      for (const std::uint32_t vertex : near_vertices_) vertex_pairs_.push_back({vertex, i});
      for (const std::uint32_t edge : near_edges_) {
        for (const std::uint32_t organ_edge : step.organ.edges_of_triangle(triangles_[i].index)) {
          edge_pairs_.push_back({edge, organ_edge});
        }
      }
    }
    for (const std::uint32_t vertex : held_) {
      triangle_list_.clear();
      cores_.append_near_wall(step, core_of(vertex), triangle_list_);
      for (const std::uint32_t t : triangle_list_) {
        const auto at =
            std::lower_bound(triangles_.begin(), triangles_.end(), t,
                             [](const SweptTriangle& s, std::uint32_t k) { return s.index < k; });
        if (at != triangles_.end() && at->index == t) {
          vertex_pairs_.push_back({vertex, static_cast<std::size_t>(at - triangles_.begin())});
        }
      }
    }
    edges_.append_remembered(step.organ_index, edge_pairs_);
    sort_unique(vertex_pairs_);
    sort_unique(edge_pairs_);
  }

  void find_vertices(const OrganStep& step) {
    for (auto first = vertex_pairs_.begin(); first != vertex_pairs_.end();) {
      const std::uint32_t vertex = first->first;
      near_triangles_.clear();
      for (; first != vertex_pairs_.end() && first->first == vertex; ++first) {
        near_triangles_.push_back(triangles_[first->second]);
      }
      cores_.find(step, core_of(vertex), near_triangles_, found_);
    }
  }

  ProbeModel model_;
  CoreContacts cores_;
  NodeContacts nodes_;
  EdgeContacts edges_;
  std::vector<std::uint64_t> seen_versions_;  ///< per organ, in the last step

  // Kept between calls for their memory only.
  std::vector<FoundContact> found_;
  std::vector<SweptTriangle> triangles_, near_triangles_;
  std::vector<std::uint32_t> triangle_list_, node_list_, near_vertices_, near_edges_, held_;
  std::vector<VertexPair> vertex_pairs_;
  std::vector<EdgePair> edge_pairs_;
};

}  // namespace

struct ContactFinder::Impl {
  std::vector<OrganSurface> organs;
  std::vector<ProbeSearch> probes;
};

ContactFinder::ContactFinder(std::vector<std::vector<geometry::Triangle>> organ_triangles,
                             std::vector<geometry::ProbeForm> probes)
    : impl_(std::make_unique<Impl>()) {
  for (auto& triangles : organ_triangles) impl_->organs.emplace_back(std::move(triangles));
  for (geometry::ProbeForm& probe : probes) impl_->probes.emplace_back(std::move(probe));
}

ContactFinder::~ContactFinder() = default;

void ContactFinder::update_organ(std::size_t organ, std::span<const Vec3> positions) {
  PALPATE_DEMAND(organ < impl_->organs.size());
  impl_->organs[organ].update(positions);
}

void ContactFinder::reset() {
  for (ProbeSearch& probe : impl_->probes) probe.reset();
}

void ContactFinder::forget(std::size_t probe) {
  PALPATE_DEMAND(probe < impl_->probes.size());
  impl_->probes[probe].reset();
}

SearchReport ContactFinder::find(std::size_t probe, const ProbeMotion& motion, double margin,
                                 std::size_t at_most, ContactSet& result) {
  PALPATE_DEMAND(probe < impl_->probes.size());
  PALPATE_DEMAND(margin > 0 && std::isfinite(margin));
  result.probe = static_cast<std::uint32_t>(probe);
  result.probe_pose = motion.pose_t1;
  result.truncated = false;
  result.contacts.clear();
  if (!is_believable(motion.pose_t0) || !is_believable(motion.pose_t1)) return {};
  return impl_->probes[probe].find(motion, margin, impl_->organs, at_most, result);
}

}  // namespace palpate::collision
