#include "studies/fuzz/faults.h"

#include <limits>

#include "modules/core/units.h"
#include "modules/messages/cdr.h"

namespace palpate::fuzz {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kDenormal = 1e-310, kHuge = 1e300;

constexpr double kSpell = 0.1;               // of loss, delay and repetition [s]
constexpr std::int64_t kDelay = 30'000'000;  // [ns]

bool is_of_transport(Fault fault) { return fault >= Fault::kLost; }

bool acts(const TimedFault& timed, double time, double period) {
  const double lasts = is_of_transport(timed.fault) ? kSpell : period;
  return timed.time <= time && time < timed.time + lasts;
}

void corrupt_contact(Fault fault, Contact& contact) {
  switch (fault) {
    case Fault::kGapNotANumber:
      contact.gap = kNaN;
      break;
    case Fault::kNormalNotANumber:
      contact.normal_P = Vec3::Constant(kNaN);
      break;
    case Fault::kNormalDenormal:
      contact.normal_P = Vec3(kDenormal, 0, 1);
      break;
    case Fault::kPointInfinite:
      contact.point_P.x() = kInfinity;
      break;
    case Fault::kPointHuge:
      contact.point_P = Vec3(kHuge, -kHuge, 1);
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

template <class Message>
bus::Tap tap_of(Fault fault) {
  switch (fault) {
    case Fault::kLost:
      return bus::lose_tap([](const bus::Passing&) { return true; });
    case Fault::kLate:
      return bus::time_delay_tap(kDelay);
    case Fault::kTwice:
      return bus::repeat_tap(2);
    default:
      return bus::change_tap<Message>([fault](Message& message) { corrupt(fault, message); },
                                      false);
  }
}

template <class Message>
void tap_topic(const RandomScene& scene, const bus::TopicOf<Message>& topic, bus::TappedBus& bus) {
  for (const TimedFault& timed : scene.faults) {
    const auto concerns = [timed, period = 1 / scene.scene.rates.deformation,
                           message = Message()](const bus::Passing& passing) mutable {
      return acts(timed, seconds_from_ns(passing.now_ns), period) &&
             messages::read_payload(passing.payload, message) == nullptr &&
             message.probe == timed.probe;
    };
    bus.set_tap(topic.name, bus::tap_while(concerns, tap_of<Message>(timed.fault)));
  }
}

class FaultyDevice : public haptics::Device {
 public:
  FaultyDevice(std::unique_ptr<haptics::Device> device, std::vector<TimedFault> faults,
               double period)
      : device_(std::move(device)), faults_(std::move(faults)), period_(period) {}

  haptics::DeviceSample read(double time) override {
    haptics::DeviceSample sample = device_->read(time);
    for (const TimedFault& timed : faults_) {
      if (!acts(timed, time, period_)) continue;
      sample.pose.position.x() = sample.twist.linear.y() = kNaN;
    }
    return sample;
  }
  void feel(const RenderedForce& force) override { device_->feel(force); }

 private:
  std::unique_ptr<haptics::Device> device_;
  std::vector<TimedFault> faults_;
  double period_;  ///< of deformation [s]
};

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
  if (fault == Fault::kModelNotANumber) message.growth = kNaN;
  if (fault != Fault::kModelHuge) return;
  for (LawRow& row : message.rows) row.force = kHuge * row.normal;
}

void tap_faults(const RandomScene& scene, bus::TappedBus& bus) {
  tap_topic(scene, bus::kProbeState, bus);
  tap_topic(scene, bus::kContacts, bus);
  tap_topic(scene, bus::kContactModel, bus);
}

std::unique_ptr<haptics::Device> faulty_device(const RandomScene& scene, std::uint32_t probe) {
  std::vector<std::string> warnings;
  std::vector<TimedFault> faults = scene.faults;
  std::erase_if(faults, [probe](const TimedFault& timed) {
    return timed.probe != probe || timed.fault != Fault::kDeviceNotANumber;
  });
  return std::make_unique<FaultyDevice>(
      haptics::make_device(scene.scene.probes[probe].device, scene.scene.haptics, warnings),
      std::move(faults), 1 / scene.scene.rates.deformation);
}

}  // namespace palpate::fuzz
