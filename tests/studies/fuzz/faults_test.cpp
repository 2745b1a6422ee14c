#include "studies/fuzz/faults.h"

#include <catch2/catch.hpp>

namespace palpate::fuzz {
namespace {

TEST_CASE("faults: what is not a number is refused, what is only odd is let through") {
  // Oracle: the rules of the wire.
  const auto pose = [](Fault fault) {
    ProbeState message;
    corrupt(fault, message);
    return refusal(message) != nullptr;
  };
  CHECK(pose(Fault::kPoseNotANumber));
  CHECK(pose(Fault::kPoseInfinite));
  CHECK(pose(Fault::kRotationZero));
  CHECK_FALSE(pose(Fault::kPoseDenormal));
  CHECK_FALSE(pose(Fault::kGapNotANumber));  // not its message
  Contacts contacts;
  contacts.contacts.resize(1);
  contacts.contacts[0].barycentric = Vec3(1, 0, 0);
  CHECK(refusal(contacts) == nullptr);
  corrupt(Fault::kGapNotANumber, contacts);
  CHECK(refusal(contacts) != nullptr);
  ContactModel model;
  CHECK(refusal(model) == nullptr);
  corrupt(Fault::kModelNotANumber, model);
  CHECK(refusal(model) != nullptr);
}

}  // namespace
}  // namespace palpate::fuzz
