#include "modules/bus/dds_bus.h"

#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>

#include <algorithm>
#include <chrono>
#include <deque>

#include "modules/bus/bundled_stream.h"
#include "modules/bus/clock_exchange.h"
#include "modules/bus/participant.h"
#include "modules/bus/payload_type.h"
#include "modules/bus/wall_clock_shift.h"
#include "modules/messages/message_types.h"

namespace palpate::bus {
namespace {

namespace dds = eprosima::fastdds::dds;
using eprosima::fastrtps::Duration_t;
using eprosima::fastrtps::types::ReturnCode_t;

WriterId writer_of(const dds::SampleInfo& info) {
  WriterId id;
  const auto& guid = info.sample_identity.writer_guid();
  std::copy_n(guid.guidPrefix.value, 12, id.begin());
  std::copy_n(guid.entityId.value, 4, id.begin() + 12);
  return id;
}

template <class Clock>
std::int64_t ns_of() {
  return std::chrono::nanoseconds(Clock::now().time_since_epoch()).count();
}

class DdsWriter : public RawWriter {
 public:
  DdsWriter(Participant& participant, const TopicInfo& topic)
      : participant_(participant), writer_(participant.add_writer(topic)) {}
  ~DdsWriter() override { participant_.remove(writer_); }

  bool write(messages::Payload payload) override {
    sample_.bytes = payload;
    return writer_->write(&sample_);
  }
  int matched_readers() const override {
    dds::PublicationMatchedStatus status;
    writer_->get_publication_matched_status(status);
    return status.current_count;
  }
  bool wait_until_received(double longest) override {
    const Duration_t duration(static_cast<long double>(longest));
    return writer_->wait_for_acknowledgments(duration) == ReturnCode_t::RETCODE_OK;
  }

 private:
  Participant& participant_;
  dds::DataWriter* writer_;
  PayloadType::Sample sample_;
};

class DdsReader : public RawReader {
 public:
  /// @param clocks  on which what is read is put on this host's; nullptr: it stays as it came
  DdsReader(Participant& participant, const TopicInfo& topic, Keep keep, HostClocks* clocks)
      : participant_(participant),
        topic_(topic),
        clocks_(clocks),
        reader_(participant.add_reader(topic, keep)) {}
  ~DdsReader() override { participant_.remove(reader_); }

  bool take(RawSample& sample) override {
    if (clocks_ == nullptr) return take_as_it_came(sample);
    if (take_waiting(sample)) return true;
    while (take_as_it_came(sample)) {
      if (put_on_this_clock(sample)) return true;
      clocks_->missed(sample.writer, sample.received_time_ns);
      if (topic_.delivery == Delivery::kState) keep_waiting(sample);
    }
    return false;
  }
  bool wait(double timeout) override {
    // What waits for a clock wakes nobody: who waits looks again.
    if (!waiting_.empty()) timeout = std::min(timeout, kLookAgain);
    return reader_->wait_for_unread_message(Duration_t(static_cast<long double>(timeout)));
  }
  int matched_writers() const override {
    dds::SubscriptionMatchedStatus status;
    reader_->get_subscription_matched_status(status);
    return status.current_count;
  }

 private:
  static constexpr std::size_t kMostWaiting = 64;
  static constexpr double kLookAgain = 0.01;  ///< [s]

  bool take_as_it_came(RawSample& sample) {
    dds::SampleInfo info;
    sample_.into = &sample.payload;
    const std::int64_t asked = ns_of<std::chrono::steady_clock>();
    while (reader_->take_next_sample(&sample_, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;  // a writer has left
      if (!participant_.admit(sample.payload)) continue;
      sample.writer = writer_of(info);
      sample.received_time_ns = monotonic(info.reception_timestamp.to_ns());
      return true;
    }
    wall_shift_.nothing_waits(asked);
    return false;
  }

  /// DDS stamps arrivals with the wall clock; everything else here runs on the monotonic one.
  std::int64_t monotonic(std::int64_t wall_ns) {
    const std::int64_t before = ns_of<std::chrono::steady_clock>();
    const std::int64_t wall_now = ns_of<std::chrono::system_clock>();
    return wall_shift_.arrival(wall_ns, before, wall_now, ns_of<std::chrono::steady_clock>());
  }

  bool put_on_this_clock(RawSample& sample) const {
    const HostClocks::Reading clock = clocks_->of(sample.writer, sample.received_time_ns);
    // Drivers stamp by any clock; haptics follows it (haptics/devices/driver_clock.h).
    if (!clock.known) return topic_.name == kProbeInput.name;
    sample.clock_error = clock.error;
    if (clock.shift_ns != 0) messages::shift_times(*topic_.type, clock.shift_ns, sample.payload);
    return true;
  }

  void keep_waiting(const RawSample& sample) {
    if (waiting_.size() == kMostWaiting) waiting_.pop_front();
    waiting_.push_back(sample);
  }

  bool take_waiting(RawSample& sample) {
    for (auto each = waiting_.begin(); each != waiting_.end(); ++each) {
      if (!put_on_this_clock(*each)) continue;
      std::swap(sample, *each);
      waiting_.erase(each);
      return true;
    }
    return false;
  }

  Participant& participant_;
  TopicInfo topic_;
  HostClocks* clocks_;
  dds::DataReader* reader_;
  PayloadType::Sample sample_;
  WallClockShift wall_shift_;
  std::deque<RawSample> waiting_;
};

}  // namespace

DdsBus::DdsBus(const BusOptions& options)
    : every_sample_(options.every_sample), participant_(new Participant(options)) {
  // In lockstep times are simulated ones, the same everywhere.
  if (!participant_->over_hosts() || options.every_sample) return;
  const TopicInfo topic = info_of(kClock);
  clocks_ = std::make_unique<HostClocks>(
      [this](const GuidPrefix& participant) { return participant_->host_of(participant); });
  exchanger_ = std::make_unique<ClockExchanger>(
      std::make_unique<DdsWriter>(*participant_, topic),
      std::make_unique<DdsReader>(*participant_, topic, Keep::kBacklog, nullptr), *clocks_);
}
DdsBus::~DdsBus() = default;

std::unique_ptr<RawWriter> DdsBus::raw_writer(const TopicInfo& topic) {
  if (is_bundled(topic)) return std::make_unique<BundledWriter>(sender_of(topic));
  return std::make_unique<DdsWriter>(*participant_, topic);
}

std::unique_ptr<RawReader> DdsBus::raw_reader(const TopicInfo& topic, Keep keep) {
  auto reader = std::make_unique<DdsReader>(*participant_, topic, keep, clocks_.get());
  if (!is_bundled(topic)) return reader;
  return std::make_unique<BundledReader>(std::move(reader));
}

void DdsBus::flush() {
  for (const auto& [topic, sender] : senders_) {
    if (const auto alive = sender.lock()) alive->send();
  }
}

bool DdsBus::is_bundled(const TopicInfo& topic) const {
  return every_sample_ && topic.delivery == Delivery::kStream;
}

std::shared_ptr<BundleSender> DdsBus::sender_of(const TopicInfo& topic) {
  std::erase_if(senders_, [](const auto& known) { return known.second.expired(); });
  const auto known = std::ranges::find(senders_, topic.name, [](const auto& s) { return s.first; });
  if (known != senders_.end()) return known->second.lock();
  auto made = std::make_shared<BundleSender>(std::make_unique<DdsWriter>(*participant_, topic));
  senders_.emplace_back(topic.name, made);
  return made;
}

Refusals DdsBus::packets_refused() const { return participant_->packets_refused(); }

const char* DdsBus::clock_trouble() const {
  return clocks_ == nullptr ? "" : clocks_->trouble(now_ns());
}

}  // namespace palpate::bus
