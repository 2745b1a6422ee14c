#include "studies/fuzz/insults.h"

#include <catch2/catch.hpp>

namespace palpate::fuzz {
namespace {

TEST_CASE("insults: what is not a number is refused, what is only odd is let through") {
  // Oracle: the rules of the wire.
  const auto pose = [](Insult insult) {
    ProbeState message;
    spoil(insult, message);
    return refusal(message) != nullptr;
  };
  CHECK(pose(Insult::kPoseNotANumber));
  CHECK(pose(Insult::kPoseInfinite));
  CHECK(pose(Insult::kRotationZero));
  CHECK_FALSE(pose(Insult::kPoseDenormal));
  CHECK_FALSE(pose(Insult::kGapNotANumber));  // not its message
  Contacts contacts;
  contacts.contacts.resize(1);
  contacts.contacts[0].barycentric = Vec3(1, 0, 0);
  CHECK(refusal(contacts) == nullptr);
  spoil(Insult::kGapNotANumber, contacts);
  CHECK(refusal(contacts) != nullptr);
  ContactModel model;
  CHECK(refusal(model) == nullptr);
  spoil(Insult::kModelNotANumber, model);
  CHECK(refusal(model) != nullptr);
}

}  // namespace
}  // namespace palpate::fuzz
