#include "studies/fuzz/faults.h"

#include <limits>

#include "modules/messages/message_checks.h"

namespace palpate::fuzz {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kDenormal = 1e-310, kHuge = 1e300;

template <class Message>
const char* refused_field(Message& message) {
  message.header.sequence = 1;  // the codec's to fill
  return messages::first_invalid_field(message);
}

void corrupt_contact(Fault fault, Contact& contact) {
  switch (fault) {
    case Fault::kGapNotANumber:
      contact.gap = kNaN;
      break;
    case Fault::kNormalNotANumber:
      contact.normal = Vec3::Constant(kNaN);
      break;
    case Fault::kNormalDenormal:
      contact.normal = Vec3(kDenormal, 0, 1);
      break;
    case Fault::kPointInfinite:
      contact.point_on_probe.x() = kInfinity;
      break;
    case Fault::kPointHuge:
      contact.point_on_probe = Vec3(kHuge, -kHuge, 1);
      break;
    case Fault::kGapHuge:
      contact.gap = -kHuge;
      break;
    case Fault::kUnknownOrgan:
      contact.organ = 999;
      break;
    case Fault::kUnknownTriangle:
      contact.triangle = std::numeric_limits<std::uint32_t>::max();
      break;
    default:
      break;
  }
}

}  // namespace

void corrupt(Fault fault, ProbeState& message) {
  if (fault == Fault::kPoseNotANumber) message.pose.position.y() = kNaN;
  if (fault == Fault::kPoseInfinite) message.pose.position.x() = -kInfinity;
  if (fault == Fault::kPoseDenormal) message.pose.position = Vec3::Constant(kDenormal);
  if (fault == Fault::kPoseHuge) message.pose.position = Vec3(kHuge, 1, -kHuge);
  if (fault == Fault::kRotationZero) message.pose.rotation.coeffs().setZero();
  if (fault == Fault::kUnknownProbe) message.probe = 77;
}

void corrupt(Fault fault, Contacts& message) {
  if (fault == Fault::kUnknownProbe) message.probe = 77;
  if (fault == Fault::kManyContacts && !message.contacts.empty()) {
    message.contacts.resize(kMaxContactsPerProbe, message.contacts.back());
  }
  for (Contact& contact : message.contacts) corrupt_contact(fault, contact);
}

void corrupt(Fault fault, ContactModel& message) {
  if (fault == Fault::kModelNotANumber) message.force.z() = kNaN;
  if (fault == Fault::kModelHuge) {
    message.force = Vec3(kHuge, kHuge, 0);
    message.stiffness = Mat3::Identity() * kHuge;
    message.touching = true;
  }
}

const char* refusal(ProbeState message) { return refused_field(message); }
const char* refusal(Contacts message) { return refused_field(message); }
const char* refusal(ContactModel message) { return refused_field(message); }
const char* refusal(NodePositions message) { return refused_field(message); }
const char* refusal(HapticForce message) { return refused_field(message); }

}  // namespace palpate::fuzz
