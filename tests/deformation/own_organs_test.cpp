#include "deformation/own_organs.h"

#include <catch2/catch.hpp>

using namespace palpate;
using namespace palpate::deformation;

TEST_CASE(
    "own organs: contacts of others are left out, and one's own counted as the process does") {
  // Oracle: by hand. Of five organs the process has 1 and 3.
  scene::Scene scene;
  scene.organs.resize(5);
  for (const std::size_t organ : {1u, 3u}) scene.organs[organ].process = 2;
  const OwnOrgans own(scene, 2);
  REQUIRE(own.count() == 2);
  CHECK(own.in_scene(0) == 1);
  CHECK(own.in_scene(1) == 3);

  ContactSet contacts;
  for (const std::uint32_t organ : {0u, 1u, 3u, 9u}) {
    contacts.contacts.emplace_back().organ = organ;
    contacts.contacts.back().triangle = 10 + organ;
  }
  for (const std::uint32_t organ : {0u, 1u, 2u, 3u}) {
    contacts.faces.emplace_back().organ = organ;
    contacts.faces.back().node_count = organ + 1;
    for (std::uint32_t k = 0; k <= organ; ++k) contacts.face_nodes.push_back(100 * organ + k);
  }
  std::vector<std::uint32_t> generations{5, 6, 7, 8, 9};
  own.keep_own(contacts, generations);
  REQUIRE(contacts.contacts.size() == 2);
  CHECK(contacts.contacts[0].organ == 0);
  CHECK(contacts.contacts[0].triangle == 11);
  CHECK(contacts.contacts[1].organ == 1);
  CHECK(contacts.contacts[1].triangle == 13);
  REQUIRE(contacts.faces.size() == 2);
  CHECK(contacts.faces[0].organ == 0);
  CHECK(contacts.faces[1].organ == 1);
  CHECK(contacts.face_nodes == std::vector<std::uint32_t>{100, 101, 300, 301, 302, 303});
  CHECK(generations == std::vector<std::uint32_t>{6, 8});

  std::vector<std::uint32_t> unknown{5};
  own.keep_own(contacts, unknown);
  CHECK(unknown.empty());
}

TEST_CASE("own organs: who has all leaves contacts as they are") {
  // Oracle: identity.
  scene::Scene scene;
  scene.organs.resize(2);
  const OwnOrgans own(scene, 1);
  ContactSet contacts;
  contacts.contacts.resize(2);
  contacts.contacts[1].organ = 7;  // the world's to refuse
  std::vector<std::uint32_t> generations{3, 4};
  own.keep_own(contacts, generations);
  CHECK(contacts.contacts.size() == 2);
  CHECK(contacts.contacts[1].organ == 7);
  CHECK(generations == std::vector<std::uint32_t>{3, 4});
}
