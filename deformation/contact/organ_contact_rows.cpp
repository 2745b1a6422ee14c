#include "deformation/contact/organ_contact_rows.h"

#include <algorithm>
#include <utility>

namespace palpate::deformation {
namespace {

constexpr std::uint32_t kNoNode = ~std::uint32_t{0};

OrganPlace place_on(std::uint32_t organ, std::span<const std::uint32_t> nodes,
                    std::span<const double> weights) {
  OrganPlace place{organ, {}, Vec3::Zero()};
  std::size_t used = 0;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    if (weights[k] == 0) continue;
    place.nodes[used] = nodes[k];
    place.weights[static_cast<Eigen::Index>(used++)] = weights[k];
  }
  return place;
}

std::array<std::uint32_t, 4> key_of(const OrganPlace& place) {
  std::array<std::uint32_t, 4> key{place.organ, kNoNode, kNoNode, kNoNode};
  for (std::size_t k = 0; k < 3; ++k) {
    if (place.weights[static_cast<Eigen::Index>(k)] != 0) key[k + 1] = place.nodes[k];
  }
  std::sort(key.begin() + 1, key.end());
  return key;
}

}  // namespace

ContactKey key_of(const OrganContactRow& row) {
  ContactKey key{};
  const auto first = key_of(row.places[0]), second = key_of(row.places[1]);
  std::copy(first.begin(), first.end(), key.begin());
  std::copy(second.begin(), second.end(), key.begin() + first.size());
  return key;
}

OrganContactRow row_between(const StepPair& step, double rest_gap, double friction, double h) {
  const std::size_t split = step.pair.first_count();
  const std::span<const std::uint32_t> nodes(step.pair.nodes);
  const std::span<const double> weights(step.separation.weights);
  OrganContactRow row;
  row.places = {place_on(step.pair.surfaces[0], nodes.first(split), weights.first(split)),
                place_on(step.pair.surfaces[1], nodes.subspan(split), weights.subspan(split))};
  row.normal = step.separation.direction;
  if (key_of(row.places[1]) < key_of(row.places[0])) {
    std::swap(row.places[0], row.places[1]);
    row.normal = -row.normal;
  }
  row.approach = allowed_approach(step.separation.distance - rest_gap, h);
  row.friction = friction;
  return row;
}

void keep_each_once(std::vector<OrganContactRow>& rows) {
  std::vector<std::pair<ContactKey, std::size_t>> order;
  for (std::size_t r = 0; r < rows.size(); ++r) order.emplace_back(key_of(rows[r]), r);
  std::sort(order.begin(), order.end());
  std::vector<OrganContactRow> once;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i == 0 || order[i].first != order[i - 1].first) once.push_back(rows[order[i].second]);
  }
  rows = std::move(once);
}

ContactRow seen_from(const OrganContactRow& row, std::size_t side,
                     std::span<const TouchedOrgan> organs) {
  const OrganPlace &own = row.places[side], &other = row.places[1 - side];
  ContactRow seen;
  seen.nodes = own.nodes;
  seen.weights = own.weights;
  seen.normal = side == 0 ? row.normal : Vec3(-row.normal);
  for (std::size_t k = 0; k < 3; ++k) {
    seen.probe_velocity += other.weights[static_cast<Eigen::Index>(k)] *
                           organs[other.organ].velocities[other.nodes[k]];
  }
  seen.friction = row.friction;
  seen.normal_impulse = row.normal_impulse;
  seen.tangential_impulse = (side == 0 ? -1 : 1) * row.tangential_impulse;
  return seen;
}

}  // namespace palpate::deformation
