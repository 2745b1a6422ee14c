#include "modules/scene/models.h"

#include <catch2/catch.hpp>
#include <set>
#include <string>

#include "modules/scene/scene.h"

namespace palpate::scene {
namespace {

TEST_CASE("scene models: each word names one row, the default among them") {
  // Oracle: counting.
  std::set<std::string_view> words;
  for (const ModelFormat& format : model_formats()) {
    CHECK(words.insert(format.word).second);
    CHECK(&format_of(format.word) == &format);
    CHECK(std::string(format.meaning) != "");
  }
  CHECK(words.count(Organ().model) == 1);
}

TEST_CASE("scene models: dropping what a model ignores leaves it nothing to refuse") {
  // Oracle: ignored_by_model(), and idempotence.
  for (const ModelFormat& format : model_formats()) {
    Organ organ;
    organ.model = format.word;
    organ.iterations = 3;
    organ.integrator = Integrator::kBackwardEuler;
    organ.volume_corrections = 2;
    organ.springs.inner_ratio = 1;
    organ.tissue.wall_thickness = 0.01;
    organ.tissue.damping_ratio = 0.3;
    organ.solid = {0.3, 0.01, 12, {{SphereRegion{}}, 0.01, 1}};
    INFO(format.word);
    CHECK_FALSE(ignored_by_model(organ).none());
    drop_ignored_keys(organ);
    CHECK(ignored_by_model(organ).none());
    CHECK((organ.iterations == 3) == (format.iterations > 0));
    CHECK((organ.solid.modes == 12) == format.has_modes);
    CHECK(organ.solid.refine.near.empty() != format.is_solid());
    CHECK((organ.tissue.wall_thickness == 0.01) != format.is_solid());
  }
}

TEST_CASE("scene models: contacts of organs are refused where a step does not take them") {
  // Oracle: the table, and the names in the message.
  Scene scene;
  scene.organs.resize(2);
  scene.organs[1].name = "liver";
  for (const ModelFormat& format : model_formats()) {
    INFO(format.word);
    scene.organs[1].model = format.word;
    scene.contacts = {};
    CHECK(misfit_of_contacts(scene).none());
    scene.contacts.self = true;
    const Misfit misfit = misfit_of_contacts(scene);
    CHECK(misfit.none() == format.takes_organ_contacts);
    CHECK_FALSE((format.takes_organ_contacts && format.is_solid()));
    if (misfit.none()) continue;
    CHECK(misfit.key == "contacts.self");
    CHECK(misfit.why.find("'liver'") != std::string::npos);
    CHECK(misfit.why.find(format.word) != std::string::npos);
  }
  scene.organs[1].model = "implicit_volume";
  scene.organs[1].integrator = Integrator::kBackwardEuler;
  scene.contacts.organs = true;
  CHECK(misfit_of_contacts(scene).key == "contacts.organs");
  scene.organs[1].integrator = Integrator::kSymplecticEuler;
  CHECK(misfit_of_contacts(scene).none());
}

}  // namespace
}  // namespace palpate::scene
