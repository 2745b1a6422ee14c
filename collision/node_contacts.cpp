#include "collision/node_contacts.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace palpate::collision {
namespace {

/// The nearest face may replace the held one while they look the same way (within 60°).
constexpr double kSameFace = 0.5;

/// A wall at right angles to the solid's surface does not face it, whatever the rounding.
bool faces(const Vec3& node_normal, const Vec3& outward) {
  return node_normal.dot(outward) < -1e-3 * node_normal.norm();
}

}  // namespace

void NodeContacts::reset() {
  before_.clear();
  now_.clear();
}

void NodeContacts::change_surface(const SurfaceChange& change) {
  std::erase_if(now_, [&](Hold& hold) {
    if (hold.organ == change.organ) hold.node = change.node(hold.node);
    return hold.node == geometry::kNoPlace;
  });
}

void NodeContacts::begin_step() {
  before_.swap(now_);
  now_.clear();
  const auto place = [](const Hold& hold) { return std::tie(hold.organ, hold.node); };
  if (!std::ranges::is_sorted(before_, {}, place)) std::ranges::sort(before_, {}, place);
}

void NodeContacts::append_remembered(std::uint32_t organ, std::vector<std::uint32_t>& nodes) const {
  for (const Hold& hold : before_) {
    if (hold.organ == organ) nodes.push_back(hold.node);
  }
}

const NodeContacts::Hold* NodeContacts::held(const OrganStep& step, std::uint32_t node) const {
  const auto key = std::pair(step.organ_index, node);
  const auto at = std::lower_bound(
      before_.begin(), before_.end(), key,
      [](const Hold& hold, const auto& k) { return std::pair(hold.organ, hold.node) < k; });
  return at != before_.end() && std::pair(at->organ, at->node) == key ? &*at : nullptr;
}

void NodeContacts::find(const OrganStep& step, const ProbeSolid& solid,
                        std::span<const std::uint32_t> nodes, std::vector<FoundContact>& found) {
  for (const std::uint32_t node : nodes) {
    if (!step.organ.triangles_of_node(node).empty()) find_node(step, solid, node, found);
  }
}

std::optional<NodeContacts::Kept> NodeContacts::kept_face(const OrganStep& step,
                                                          const SweptNode& node) const {
  const Hold* hold = held(step, node.index);
  if (hold != nullptr) return Kept{{hold->point, hold->outward}, hold->depth_limit};
  if (!node.entry || !faces(step.node_normal_end(node.index), node.entry->outward)) return {};
  return Kept{{node.entry->point, node.entry->outward}, step.depth_limit};
}

void NodeContacts::find_node(const OrganStep& step, const ProbeSolid& solid, std::uint32_t index,
                             std::vector<FoundContact>& found) {
  SweptNode node;
  node.index = index;
  node.end = step.node_end(index);
  node.near = solid.nearest(node.end, step.margin);
  node.entry = solid.entry(step.node_start(index), node.end, step.motion.chord_error());
  if (!node.near && !node.entry && held(step, index) == nullptr) return;

  const bool is_outside = node.near && node.near->distance > 0;
  std::optional<Kept> kept = kept_face(step, node);
  if (kept && is_outside && kept->face.height(node.end) >= 0) kept.reset();  // came back out
  std::optional<Face> face;
  if (kept) {
    const double height = kept->face.height(node.end);
    if (node.near && !is_outside && node.near->outward.dot(kept->face.outward) >= kSameFace) {
      face = Face{node.near->point, node.near->outward};
    } else if (height <= 0 && -height <= kept->depth_limit &&
               (node.entry || solid.shadows(node.end, kept->face.outward))) {
      face = kept->face;
    }
  }
  if (!face && node.near && faces(step.node_normal_end(index), node.near->outward)) {
    // A node that was never seen entering counts only where its face is beyond doubt.
    if (std::abs(node.near->distance) > step.margin && !node.near->one_sided) return;
    face = Face{node.near->point, node.near->outward};
    if (!is_outside) kept = Kept{*face, step.depth_limit};
  }
  if (!face) return;
  FoundContact contact;
  contact.point_P = face->point;
  contact.normal_P = -face->outward;
  contact.gap = face->height(node.end);
  append_node_contact(step, index, contact, found);
  if (kept && contact.gap <= 0) {
    now_.push_back({step.organ_index, index, face->point, face->outward, kept->depth_limit});
  }
}

}  // namespace palpate::collision
