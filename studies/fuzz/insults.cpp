#include "studies/fuzz/insults.h"

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
  return bus::first_invalid_field(message);
}

void spoil_contact(Insult insult, Contact& contact) {
  switch (insult) {
    case Insult::kGapNotANumber:
      contact.gap = kNaN;
      break;
    case Insult::kNormalNotANumber:
      contact.normal = Vec3::Constant(kNaN);
      break;
    case Insult::kNormalDenormal:
      contact.normal = Vec3(kDenormal, 0, 1);
      break;
    case Insult::kPointInfinite:
      contact.point_on_probe.x() = kInfinity;
      break;
    case Insult::kPointHuge:
      contact.point_on_probe = Vec3(kHuge, -kHuge, 1);
      break;
    case Insult::kGapHuge:
      contact.gap = -kHuge;
      break;
    case Insult::kUnknownOrgan:
      contact.organ = 999;
      break;
    case Insult::kUnknownTriangle:
      contact.triangle = std::numeric_limits<std::uint32_t>::max();
      break;
    default:
      break;
  }
}

}  // namespace

void spoil(Insult insult, ProbeState& message) {
  if (insult == Insult::kPoseNotANumber) message.pose.position.y() = kNaN;
  if (insult == Insult::kPoseInfinite) message.pose.position.x() = -kInfinity;
  if (insult == Insult::kPoseDenormal) message.pose.position = Vec3::Constant(kDenormal);
  if (insult == Insult::kPoseHuge) message.pose.position = Vec3(kHuge, 1, -kHuge);
  if (insult == Insult::kRotationZero) message.pose.rotation.coeffs().setZero();
  if (insult == Insult::kUnknownProbe) message.probe = 77;
}

void spoil(Insult insult, Contacts& message) {
  if (insult == Insult::kUnknownProbe) message.probe = 77;
  if (insult == Insult::kManyContacts && !message.contacts.empty()) {
    message.contacts.resize(kMaxContactsPerProbe, message.contacts.back());
  }
  for (Contact& contact : message.contacts) spoil_contact(insult, contact);
}

void spoil(Insult insult, ContactModel& message) {
  if (insult == Insult::kModelNotANumber) message.force.z() = kNaN;
  if (insult == Insult::kModelHuge) {
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
