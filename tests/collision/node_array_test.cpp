#include "collision/node_array.h"

#include <catch2/catch.hpp>

namespace palpate::collision {

TEST_CASE("node array: the same places from doubles and from floats, which are exchanged") {
  // Oracle: definition.
  NodeArray nodes;
  CHECK(nodes.empty());
  const std::vector<Vec3> places{Vec3(1, 2, 3), Vec3(4, 5, 6.5)};
  nodes.assign(places);
  CHECK(nodes.size() == 2);
  CHECK(nodes[1] == places[1]);
  CHECK(nodes.doubles().size() == 2);
  std::vector<float> floats{1, 2, 3, 4, 5, 6.5F, 7, 8, 9};
  const float* const memory = floats.data();
  nodes.swap_in(floats);
  CHECK(nodes.size() == 3);
  CHECK(nodes[1] == places[1]);
  CHECK(nodes.floats().data() == memory);
  CHECK(nodes.doubles().empty());
  CHECK(floats.empty());
  nodes.assign(places);
  CHECK(nodes.size() == 2);
}

}  // namespace palpate::collision
