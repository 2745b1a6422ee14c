#include "collision/contact_reduction.h"

#include <algorithm>
#include <array>
#include <limits>
#include <tuple>

#include "collision/thinning.h"
#include "modules/core/tolerances.h"

namespace palpate::collision {
namespace {

constexpr double kSameDirection = 1e-9;

auto order_within(const FoundContact& c) {
  return std::tuple(c.gap, c.point_P[0], c.point_P[1], c.point_P[2], c.normal_P[0], c.normal_P[1]);
}

bool same(const FoundContact& a, const FoundContact& b) {
  return (a.point_P - b.point_P).cwiseAbs().maxCoeff() < kDirectionless &&
         (a.normal_P - b.normal_P).cwiseAbs().maxCoeff() < kSameDirection;
}

/// Contacts of nodes mostly come in order, and there may be thousands.
template <class Before>
void sort_unless_sorted(std::vector<FoundContact>& found, const Before& before) {
  if (!std::is_sorted(found.begin(), found.end(), before)) {
    std::sort(found.begin(), found.end(), before);
  }
}

/// Of the same place and normal found twice keeps the first.
/// @param sorted      those at a feature follow each other
/// @param contact_of  a FoundContact of each
template <class Sorted, class ContactOf>
void keep_distinct(Sorted& sorted, const ContactOf& contact_of) {
  std::size_t kept = 0, group = 0;  // the group: kept ones at the feature
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const FoundContact& c = contact_of(sorted[i]);
    if (kept == group || contact_of(sorted[group]).organ != c.organ ||
        contact_of(sorted[group]).feature != c.feature) {
      group = kept;
    }
    const auto is_same = [&](const auto& other) { return same(contact_of(other), c); };
    const auto first = sorted.begin() + static_cast<std::ptrdiff_t>(group);
    const auto last = sorted.begin() + static_cast<std::ptrdiff_t>(kept);
    if (std::none_of(first, last, is_same)) sorted[kept++] = sorted[i];
  }
  sorted.resize(kept);
}

void merge_duplicates(std::vector<FoundContact>& found) {
  sort_unless_sorted(found, [](const FoundContact& a, const FoundContact& b) {
    if (a.organ != b.organ) return a.organ < b.organ;
    if (a.feature != b.feature) return a.feature < b.feature;
    if (a.triangle != b.triangle) return a.triangle < b.triangle;
    return order_within(a) < order_within(b);
  });
  keep_distinct(found, [](const FoundContact& c) -> const FoundContact& { return c; });
}

auto deepest_first(const FoundContact& c) {
  return std::tuple_cat(order_within(c), std::tie(c.organ, c.triangle, c.feature));
}

bool deeper(const FoundContact& a, const FoundContact& b) {
  if (a.gap != b.gap) return a.gap < b.gap;  // nearly always decides
  return deepest_first(a) < deepest_first(b);
}

Vec3 tissue_of(const FoundContact& c) { return c.point_P - c.gap * c.normal_P; }

/// A contact with one organ, moved about in its place.
struct Ranked {
  const FoundContact* contact = nullptr;
  double gap = 0;
  std::uint64_t place = 0;  ///< the same for the same feature, and for hardly any other
};
using Ranking = std::vector<Ranked>;

bool deeper_ranked(const Ranked& a, const Ranked& b) {
  return a.gap != b.gap ? a.gap < b.gap : deepest_first(*a.contact) < deepest_first(*b.contact);
}

/// The same of contacts with one organ, sorted by numbers.
void merge_duplicates(Ranking& ranking) {
  for (Ranked& ranked : ranking) {
    const auto& [a, b, c] = ranked.contact->feature;
    constexpr std::uint64_t kOdd = 0x9e3779b97f4a7c15;
    ranked.place = ((a * kOdd) ^ b) * kOdd ^ c;
  }
  std::sort(ranking.begin(), ranking.end(), [](const Ranked& a, const Ranked& b) {
    if (a.place != b.place) return a.place < b.place;
    const auto order = [](const FoundContact& c) {
      return std::tuple_cat(std::tie(c.feature, c.triangle), order_within(c));
    };
    return order(*a.contact) < order(*b.contact);
  });
  keep_distinct(ranking, [](const Ranked& c) -> const FoundContact& { return *c.contact; });
}

/// Of contacts with one organ, as thin() leaves them, keeps kMostOfRound.
void spread(Ranking& ranking) {
  if (ranking.size() <= kMostOfRound) return;
  std::sort(ranking.begin(), ranking.end(), deeper_ranked);
  // Coordinates by themselves: what is done with them vectorizes.
  using Numbers = Eigen::Array<float, kMostThinned, 1>;
  const auto count = static_cast<Eigen::Index>(ranking.size());
  Numbers x, y, z,
      apart = Numbers::Constant(
          std::numeric_limits<float>::infinity());      // from what is kept, squared [m²]
  const Vec3 deepest = tissue_of(*ranking[0].contact);  // floats are fine beside it
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Vector3f beside = (tissue_of(*ranking[i].contact) - deepest).cast<float>();
    x[i] = beside[0];
    y[i] = beside[1];
    z[i] = beside[2];
  }
  constexpr Eigen::Index kMost{kMostOfRound}, kAtOnce = 4;
  static_assert(kMost % (2 * kAtOnce) == 0);
  Eigen::Index kept = kMost / 2;
  const auto rest = [&](Numbers& numbers) { return numbers.segment(kept, count - kept); };
  const auto from = [&](Eigen::Index other) {
    return (rest(x) - x[other]).square() +
           ((rest(y) - y[other]).square() + (rest(z) - z[other]).square());
  };
  for (Eigen::Index i = 0; i < kept; i += kAtOnce) {
    rest(apart) = rest(apart).min(from(i).min(from(i + 1))).min(from(i + 2).min(from(i + 3)));
  }
  while (kept < kMost) {
    const float most = rest(apart).maxCoeff();
    const Eigen::Index farthest =
        std::find(apart.data() + kept, apart.data() + count, most) - apart.data();
    std::swap(ranking[kept], ranking[farthest]);
    for (Numbers* along : {&x, &y, &z, &apart}) std::swap((*along)[kept], (*along)[farthest]);
    ++kept;
    rest(apart) = rest(apart).min(from(kept - 1));
  }
  ranking.resize(kMostOfRound);
}

void reduce_of_round(std::vector<FoundContact>& found) {
  const auto by_organ = [](const FoundContact& a, const FoundContact& b) {
    return a.organ < b.organ;
  };
  if (!std::is_sorted(found.begin(), found.end(), by_organ)) {
    std::stable_sort(found.begin(), found.end(), by_organ);
  }
  std::vector<const FoundContact*> kept;
  Ranking ranking;
  for (auto c = found.begin(); c != found.end();) {
    const std::uint32_t organ = c->organ;
    ranking.clear();
    for (; c != found.end() && c->organ == organ; ++c) ranking.push_back({&*c, c->gap, 0});
    thin(ranking, deeper_ranked, [](const Ranked& of) { return tissue_of(*of.contact); });
    merge_duplicates(ranking);
    spread(ranking);
    for (const Ranked& ranked : ranking) kept.push_back(ranked.contact);
  }
  std::sort(kept.begin(), kept.end());
  for (std::size_t i = 0; i < kept.size(); ++i) found[i] = *kept[i];
  found.resize(kept.size());
}

bool is_on_node(const FoundContact& c) { return c.feature[1] == kNoNode; }

double offset(const FoundContact& c) { return c.normal_P.dot(c.point_P); }

/// By planes; those of no node last.
auto plane_order(const FoundContact& c) {
  return std::tuple(!is_on_node(c), c.organ, c.normal_P[0], c.normal_P[1], c.normal_P[2]);
}

/// Nodes on one plane, sorted as they will be needed: by their triangle.
void append_face(std::vector<FoundContact>::iterator first,
                 std::vector<FoundContact>::iterator last, ContactSet& result) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> nodes;  // by their triangles
  for (auto c = first; c != last; ++c) nodes.push_back({c->triangle, c->feature[0]});
  std::sort(nodes.begin(), nodes.end());
  const auto leads = std::find_if(first, last, [&](const FoundContact& c) {
    return c.triangle == nodes[0].first && c.feature[0] == nodes[0].second;
  });
  FaceContacts face;
  face.organ = first->organ;
  face.point_P = leads->point_P;
  face.normal_P = leads->normal_P.normalized();
  face.gap = std::min_element(first, last, [](const FoundContact& a, const FoundContact& b) {
               return a.gap < b.gap;
             })->gap;
  face.node_count = static_cast<std::uint32_t>(last - first);
  result.faces.push_back(face);
  for (const auto& [triangle, node] : nodes) result.face_nodes.push_back(node);
}

/// Takes nodes on one plane out of `found`.
void take_faces(std::vector<FoundContact>& found, const ContactLimits& limits, ContactSet& result) {
  sort_unless_sorted(found, [](const FoundContact& a, const FoundContact& b) {
    return std::tuple_cat(plane_order(a), std::tuple(offset(a), a.feature)) <
           std::tuple_cat(plane_order(b), std::tuple(offset(b), b.feature));
  });
  auto kept = found.begin();
  for (auto first = found.begin(); first != found.end();) {
    auto last = first + 1;
    while (last != found.end() && is_on_node(*last) && plane_order(*last) == plane_order(*first) &&
           offset(*last) - offset(*(last - 1)) < kDirectionless) {
      ++last;
    }
    const auto count = static_cast<std::size_t>(last - first);
    if (count >= kFewestOnFace && result.faces.size() < limits.faces &&
        count <= limits.face_nodes - result.face_nodes.size()) {
      append_face(first, last, result);
    } else {
      kept = std::move(first, last, kept);
    }
    first = last;
  }
  found.erase(kept, found.end());
}

/// Takes out of contacts all but what touches and of each place on the tissue the nearest that the
/// probe may come to.
std::vector<FoundContact> take_others(std::vector<FoundContact>& found, const ProbeReach& reach) {
  std::sort(found.begin(), found.end(), [](const FoundContact& a, const FoundContact& b) {
    return std::tuple_cat(std::tie(a.organ, a.feature), deepest_first(a)) <
           std::tuple_cat(std::tie(b.organ, b.feature), deepest_first(b));
  });
  std::vector<FoundContact> others;
  std::size_t needed = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const bool is_nearest = needed == 0 || found[needed - 1].organ != found[i].organ ||
                            found[needed - 1].feature != found[i].feature;
    if (found[i].gap <= 0 || (is_nearest && reach.may_touch(found[i]))) {
      found[needed++] = found[i];
    } else {
      others.push_back(found[i]);
    }
  }
  found.resize(needed);
  return others;
}

/// Leaves the first `size`, in no useful order.
template <class Before>
void cut(std::vector<FoundContact>& found, std::size_t size, const Before& before) {
  if (found.size() <= size) return;
  std::nth_element(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(size), found.end(),
                   before);
  found.resize(size);
}

/// Of what a message must hold, what touches and of each place on the tissue the nearest that the
/// probe may come to are first, then the nearest of the others.
/// @returns whether it must hold more than it can
bool keep_nearest(std::vector<FoundContact>& found, const ContactLimits& limits,
                  const ProbeReach& reach) {
  if (found.size() <= limits.contacts) return false;
  const std::size_t most = std::max(limits.contacts, limits.needed);
  std::vector<FoundContact> others = take_others(found, reach);
  const bool holds_all = found.size() <= most;
  cut(found, most, [&](const FoundContact& a, const FoundContact& b) {
    const double gap_a = reach.least_gap(a), gap_b = reach.least_gap(b);
    return gap_a != gap_b ? gap_a < gap_b : deeper(a, b);
  });
  cut(others, limits.contacts - std::min(limits.contacts, found.size()), deeper);
  found.insert(found.end(), others.begin(), others.end());
  return !holds_all;
}

}  // namespace

void append_contact(const FoundContact& contact, const geometry::Triangle& nodes,
                    std::vector<FoundContact>& found) {
  auto& feature = found.emplace_back(contact).feature;
  for (int k = 0; k < 3; ++k) feature[k] = contact.barycentric[k] > 0 ? nodes[k] : kNoNode;
  std::sort(feature.begin(), feature.end());
}

void append_node_contact(const OrganStep& step, std::uint32_t node, FoundContact contact,
                         std::vector<FoundContact>& found) {
  contact.organ = step.organ_index;
  contact.triangle = step.organ.triangles_of_node(node).front();
  const geometry::Triangle& nodes = step.organ.triangles()[contact.triangle];
  const auto corner = std::find(nodes.begin(), nodes.end(), node) - nodes.begin();
  contact.barycentric = Vec3::Unit(corner);
  contact.feature = {node, kNoNode, kNoNode};
  found.push_back(contact);
}

void leave_choice(std::vector<FoundContact>& found, std::size_t first, const ContactLimits& limits,
                  const ProbeReach& reach) {
  const auto begin = found.begin() + static_cast<std::ptrdiff_t>(first);
  std::vector<FoundContact> choice(begin, found.end());
  merge_duplicates(choice);
  std::vector<FoundContact> others = take_others(choice, reach);
  cut(others, limits.contacts, deeper);
  found.erase(begin, found.end());
  found.insert(found.end(), choice.begin(), choice.end());
  found.insert(found.end(), others.begin(), others.end());
}

void reduce_contacts(std::vector<FoundContact>& found, bool is_round, const ContactLimits& limits,
                     ContactSet& result, const ProbeReach& reach) {
  result.clear();
  if (is_round) {
    reduce_of_round(found);
  } else {
    merge_duplicates(found);
    take_faces(found, limits, result);
  }
  result.truncated = keep_nearest(found, limits, reach);
  std::sort(found.begin(), found.end(), [](const FoundContact& a, const FoundContact& b) {
    return std::tuple_cat(std::tie(a.organ, a.triangle), order_within(a)) <
           std::tuple_cat(std::tie(b.organ, b.triangle), order_within(b));
  });
  for (const FoundContact& c : found) {
    result.contacts.push_back(c);
    result.contacts.back().normal_P.normalize();
  }
}

}  // namespace palpate::collision
