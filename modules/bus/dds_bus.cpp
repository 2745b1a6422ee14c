#include "modules/bus/dds_bus.h"

#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>

#include <algorithm>
#include <chrono>
#include <deque>

#include "modules/bus/bundled_stream.h"
#include "modules/bus/clock_exchange.h"
#include "modules/bus/clock_ns.h"
#include "modules/bus/host_stream.h"
#include "modules/bus/participant.h"
#include "modules/bus/payload_type.h"
#include "modules/bus/polled_sockets.h"
#include "modules/bus/sample_shortcut.h"
#include "modules/bus/wall_clock_shift.h"
#include "modules/core/units.h"
#include "modules/messages/message_types.h"

namespace palpate::bus {
namespace {

namespace dds = eprosima::fastdds::dds;
using eprosima::fastrtps::Duration_t;
using eprosima::fastrtps::types::ReturnCode_t;

WriterId id_of(const eprosima::fastrtps::rtps::GUID_t& guid) {
  WriterId id;
  std::copy_n(guid.guidPrefix.value, 12, id.begin());
  std::copy_n(guid.entityId.value, 4, id.begin() + 12);
  return id;
}

/// That was matched last, or is no more.
WriterId writer_of(const dds::SubscriptionMatchedStatus& status) {
  return id_of(eprosima::fastrtps::rtps::iHandle2GUID(
      eprosima::fastrtps::rtps::InstanceHandle_t(status.last_publication_handle)));
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
    PolledSockets* const polled = participant_.polled();
    if (polled == nullptr) return is_acknowledged(longest);
    const std::int64_t until = monotonic_ns() + ns_from_seconds(longest);
    for (std::int64_t left = 1; left > 0; left = until - monotonic_ns()) {
      if (is_acknowledged(0)) return true;
      polled->hear(seconds_from_ns(left));
    }
    return is_acknowledged(0);
  }

 private:
  bool is_acknowledged(double longest) {
    const Duration_t duration(static_cast<long double>(longest));
    return writer_->wait_for_acknowledgments(duration) == ReturnCode_t::RETCODE_OK;
  }

  Participant& participant_;
  dds::DataWriter* writer_;
  PayloadType::Sample sample_;
};

GuidPrefix prefix_of(const WriterId& writer) {
  GuidPrefix prefix;
  std::copy_n(writer.begin(), prefix.size(), prefix.begin());
  return prefix;
}

/// A stream to readers on this host, which find it by what DDS tells them.
class HostWriter : public RawWriter {
 public:
  HostWriter(Participant& participant, const TopicInfo& topic)
      : stream_(*participant.polled(), host_stream_name(participant.prefix(), topic.name),
                participant.token()),
        announced_(participant, topic) {}

  bool write(messages::Payload payload) override { return stream_.write(payload); }
  int matched_readers() const override { return stream_.matched_readers(); }
  bool has_readers() const override { return stream_.has_readers(); }
  bool wait_until_received(double longest) override { return stream_.wait_until_received(longest); }

 private:
  HostStreamWriter stream_;  // listens before it is told of
  DdsWriter announced_;
};

class HostReader : public RawReader, private dds::DataReaderListener {
 public:
  HostReader(Participant& participant, const TopicInfo& topic, Keep keep)
      : participant_(participant),
        topic_(topic),
        stream_(*participant.polled(), participant.token()),
        reader_(participant.add_reader(topic, keep, this)) {}
  ~HostReader() override {
    reader_->set_listener(nullptr);
    participant_.remove(reader_);
  }

  bool take(RawSample& sample) override { return stream_.take(sample); }
  bool wait(double timeout) override { return stream_.wait(timeout); }
  int matched_writers() const override { return stream_.matched_writers(); }

 private:
  void on_subscription_matched(dds::DataReader* /*reader*/,
                               const dds::SubscriptionMatchedStatus& status) override {
    if (status.current_count_change <= 0) return;
    const WriterId writer = writer_of(status);
    stream_.meet(writer, host_stream_name(prefix_of(writer), topic_.name));
  }

  Participant& participant_;
  TopicInfo topic_;
  HostStreamReader stream_;
  dds::DataReader* reader_;
};

SampleShortcut::EntityId entity_of(const dds::DataReader& reader) {
  SampleShortcut::EntityId id = 0;
  for (const std::uint8_t byte : reader.guid().entityId.value) id = id << 8 | byte;
  return id;
}

/// Connects an inbox with the writers that its reader matches.
class InboxMatches : public dds::DataReaderListener {
 public:
  InboxMatches(SampleShortcut& shortcut, std::shared_ptr<SampleInbox> inbox)
      : shortcut_(shortcut), inbox_(std::move(inbox)) {}

  void on_subscription_matched(dds::DataReader* reader,
                               const dds::SubscriptionMatchedStatus& status) override {
    const WriterId writer = writer_of(status);
    const auto own = entity_of(*reader);
    shortcut_.disconnect(writer, own);
    if (status.current_count_change > 0) shortcut_.connect(writer, own, inbox_);
  }

 private:
  SampleShortcut& shortcut_;
  std::shared_ptr<SampleInbox> inbox_;
};

class DdsReader : public RawReader {
 public:
  /// @param clocks  on which what is read is put on this host's; nullptr: it stays as it came
  /// @param inbox   where what comes by the shortcut is put; nullptr: nothing does
  DdsReader(Participant& participant, const TopicInfo& topic, Keep keep, HostClocks* clocks,
            std::shared_ptr<SampleInbox> inbox = nullptr)
      : participant_(participant),
        topic_(topic),
        clocks_(clocks),
        inbox_(std::move(inbox)),
        matches_(inbox_ ? new InboxMatches(*participant.shortcut(), inbox_) : nullptr),
        reader_(participant.add_reader(topic, keep, matches_.get())) {}
  ~DdsReader() override {
    reader_->set_listener(nullptr);
    if (matches_) participant_.shortcut()->disconnect(entity_of(*reader_));
    participant_.remove(reader_);
  }

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
    if (inbox_ && !inbox_->empty()) return true;
    if (inbox_) timeout = std::min(timeout, kLookAgain);
    // What waits for a clock wakes nobody: who waits looks again.
    if (!waiting_.empty()) timeout = std::min(timeout, kLookAgain);
    PolledSockets* const polled = participant_.polled();
    // Whoever else waited or read has heard for all.
    if (polled != nullptr) return reader_->get_unread_count() > 0 || polled->hear(timeout);
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
    while (inbox_ && inbox_->take(sample)) {
      if (participant_.admit(sample.payload)) return true;
    }
    const std::int64_t asked = monotonic_ns();
    if (take_heard(sample)) return true;
    PolledSockets* const polled = participant_.polled();
    if (polled != nullptr && polled->hear(0) && take_heard(sample)) return true;
    // What is gathered may wait in a socket; there its stamps are seen to.
    if (participant_.shortcut() == nullptr) wall_shift_.nothing_waits(asked);
    return false;
  }

  /// What the library has.
  bool take_heard(RawSample& sample) {
    dds::SampleInfo info;
    sample_.into = &sample.payload;
    while (reader_->take_next_sample(&sample_, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;  // a writer has left
      if (!participant_.admit(sample.payload)) continue;
      sample.writer = id_of(info.sample_identity.writer_guid());
      sample.received_time_ns = monotonic(arrival_of(info));
      return true;
    }
    return false;
  }

  /// By the wall clock [ns].
  std::int64_t arrival_of(const dds::SampleInfo& info) const {
    // Gathered packets have it in place of their writer's time (packet_stamp.h), if that is told.
    const bool stamped = participant_.shortcut() != nullptr && info.source_timestamp.seconds() > 0;
    return (stamped ? info.source_timestamp : info.reception_timestamp).to_ns();
  }

  /// DDS stamps arrivals with the wall clock; everything else here runs on the monotonic one.
  std::int64_t monotonic(std::int64_t wall_ns) {
    const std::int64_t before = monotonic_ns();
    const std::int64_t wall_now = clock_ns<std::chrono::system_clock>();
    return wall_shift_.arrival(wall_ns, before, wall_now, monotonic_ns());
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
  std::shared_ptr<SampleInbox> inbox_;
  std::unique_ptr<InboxMatches> matches_;
  dds::DataReader* reader_;
  PayloadType::Sample sample_;
  WallClockShift wall_shift_;
  std::deque<RawSample> waiting_;
};

}  // namespace

DdsBus::DdsBus(const BusOptions& options, Arrivals arrivals)
    : every_sample_(options.every_sample), participant_(new Participant(options, arrivals)) {
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
  if (is_bundled(topic) && participant_->streams_on_host()) {
    return std::make_unique<BundledReader>(
        std::make_unique<HostReader>(*participant_, topic, keep));
  }
  const bool plain =
      participant_->shortcut() != nullptr && topic.delivery == Delivery::kStream && !every_sample_;
  auto reader = std::make_unique<DdsReader>(*participant_, topic, keep, clocks_.get(),
                                            plain ? std::make_shared<SampleInbox>() : nullptr);
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
  std::unique_ptr<RawWriter> writer;
  if (participant_->streams_on_host()) {
    writer = std::make_unique<HostWriter>(*participant_, topic);
  } else {
    writer = std::make_unique<DdsWriter>(*participant_, topic);
  }
  auto made = std::make_shared<BundleSender>(std::move(writer));
  senders_.emplace_back(topic.name, made);
  return made;
}

Refusals DdsBus::packets_refused() const { return participant_->packets_refused(); }

const char* DdsBus::clock_trouble() const {
  return clocks_ == nullptr ? "" : clocks_->trouble(now_ns());
}

}  // namespace palpate::bus
