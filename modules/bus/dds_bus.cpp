#include "modules/bus/dds_bus.h"

#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>

#include <algorithm>
#include <chrono>

#include "modules/bus/participant.h"
#include "modules/bus/payload_type.h"

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
std::int64_t now_ns() {
  return std::chrono::nanoseconds(Clock::now().time_since_epoch()).count();
}

// DDS stamps arrivals with the wall clock; everything else here runs on the monotonic one.
std::int64_t monotonic(const eprosima::fastrtps::rtps::Time_t& wall) {
  return wall.to_ns() + now_ns<std::chrono::steady_clock>() - now_ns<std::chrono::system_clock>();
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
  DdsReader(Participant& participant, const TopicInfo& topic, Keep keep)
      : participant_(participant), reader_(participant.add_reader(topic, keep)) {}
  ~DdsReader() override { participant_.remove(reader_); }

  bool take(RawSample& sample) override {
    dds::SampleInfo info;
    sample_.into = &sample.payload;
    while (reader_->take_next_sample(&sample_, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;  // a writer has left
      if (!participant_.admit(sample.payload)) continue;
      sample.writer = writer_of(info);
      sample.received_time_ns = monotonic(info.reception_timestamp);
      return true;
    }
    return false;
  }
  bool wait(double timeout) override {
    return reader_->wait_for_unread_message(Duration_t(static_cast<long double>(timeout)));
  }
  int matched_writers() const override {
    dds::SubscriptionMatchedStatus status;
    reader_->get_subscription_matched_status(status);
    return status.current_count;
  }

 private:
  Participant& participant_;
  dds::DataReader* reader_;
  PayloadType::Sample sample_;
};

}  // namespace

DdsBus::DdsBus(const BusOptions& options) : participant_(new Participant(options)) {}
DdsBus::~DdsBus() = default;

std::unique_ptr<RawWriter> DdsBus::raw_writer(const TopicInfo& topic) {
  return std::make_unique<DdsWriter>(*participant_, topic);
}

std::unique_ptr<RawReader> DdsBus::raw_reader(const TopicInfo& topic, Keep keep) {
  return std::make_unique<DdsReader>(*participant_, topic, keep);
}

Refusals DdsBus::packets_refused() const { return participant_->packets_refused(); }

}  // namespace palpate::bus
