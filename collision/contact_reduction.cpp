#include "collision/contact_reduction.h"

#include <algorithm>
#include <tuple>

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

void merge_duplicates(std::vector<FoundContact>& found) {
  std::sort(found.begin(), found.end(), [](const FoundContact& a, const FoundContact& b) {
    return std::tuple_cat(std::tie(a.organ, a.feature, a.triangle), order_within(a)) <
           std::tuple_cat(std::tie(b.organ, b.feature, b.triangle), order_within(b));
  });
  std::size_t kept = 0, group = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (kept == 0 || found[group].organ != found[i].organ ||
        found[group].feature != found[i].feature) {
      group = kept;
    }
    const auto is_same = [&](const FoundContact& c) { return same(c, found[i]); };
    const auto first = found.begin() + static_cast<std::ptrdiff_t>(group);
    const auto last = found.begin() + static_cast<std::ptrdiff_t>(kept);
    if (std::none_of(first, last, is_same)) found[kept++] = found[i];
  }
  found.resize(kept);
}

}  // namespace

void append_contact(FoundContact contact, const geometry::Triangle& nodes,
                    std::vector<FoundContact>& found) {
  for (int k = 0; k < 3; ++k) contact.feature[k] = contact.barycentric[k] > 0 ? nodes[k] : kNoNode;
  std::sort(contact.feature.begin(), contact.feature.end());
  found.push_back(contact);
}

void append_node_contact(const OrganStep& step, std::uint32_t node, FoundContact contact,
                         std::vector<FoundContact>& found) {
  contact.organ = step.organ_index;
  contact.triangle = step.organ.triangles_of_node(node).front();
  const geometry::Triangle& nodes = step.organ.triangles()[contact.triangle];
  const auto corner = std::find(nodes.begin(), nodes.end(), node) - nodes.begin();
  contact.barycentric = Vec3::Unit(corner);
  append_contact(contact, nodes, found);
}

void reduce_contacts(std::vector<FoundContact>& found, std::size_t at_most, ContactSet& result) {
  merge_duplicates(found);
  const auto deeper = [](const FoundContact& a, const FoundContact& b) {
    return std::tuple_cat(order_within(a), std::tie(a.organ, a.triangle, a.feature)) <
           std::tuple_cat(order_within(b), std::tie(b.organ, b.triangle, b.feature));
  };
  result.truncated = found.size() > at_most;
  if (result.truncated) {
    std::nth_element(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(at_most),
                     found.end(), deeper);
    found.resize(at_most);
  }
  std::sort(found.begin(), found.end(), [](const FoundContact& a, const FoundContact& b) {
    return std::tuple_cat(std::tie(a.organ, a.triangle), order_within(a)) <
           std::tuple_cat(std::tie(b.organ, b.triangle), order_within(b));
  });
  result.contacts.clear();
  for (const FoundContact& c : found) {
    result.contacts.push_back(c);
    result.contacts.back().normal_P.normalize();
  }
}

}  // namespace palpate::collision
