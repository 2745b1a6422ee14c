#include "modules/recording/raw_bus.h"

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>

#include <algorithm>
#include <chrono>
#include <mutex>
#include <stdexcept>

#include "modules/bus/participant.h"
#include "modules/bus/qos.h"

namespace palpate::recording {
namespace {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
using eprosima::fastrtps::types::ReturnCode_t;

using Bytes = std::vector<std::uint8_t>;

// A wire type whose sample in memory is the serialized payload itself. Only the key is decoded.
class RawType : public dds::TopicDataType {
 public:
  explicit RawType(dds::TopicDataType* wire_type) : wire_type_(wire_type) {
    setName(wire_type->getName());
    m_typeSize = wire_type->m_typeSize;
    m_isGetKeyDefined = wire_type->m_isGetKeyDefined;
  }

  bool serialize(void* data, rtps::SerializedPayload_t* payload) override {
    const Bytes& bytes = *static_cast<Bytes*>(data);
    if (bytes.size() > payload->max_size || bytes.size() < 4) return false;
    std::copy(bytes.begin(), bytes.end(), payload->data);
    payload->length = static_cast<std::uint32_t>(bytes.size());
    payload->encapsulation = (bytes[1] & 1) != 0 ? CDR_LE : CDR_BE;
    return true;
  }

  bool deserialize(rtps::SerializedPayload_t* payload, void* data) override {
    static_cast<Bytes*>(data)->assign(payload->data, payload->data + payload->length);
    return true;
  }

  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return static_cast<std::uint32_t>(static_cast<Bytes*>(data)->size()); };
  }

  void* createData() override { return new Bytes; }
  void deleteData(void* data) override { delete static_cast<Bytes*>(data); }

  // Called by threads of DDS and, through another endpoint of the type, by ours: the wire type's
  // key buffer is shared.
  bool getKey(void* data, rtps::InstanceHandle_t* handle, bool force_md5) override {
    if (!m_isGetKeyDefined) return false;
    Bytes& bytes = *static_cast<Bytes*>(data);
    rtps::SerializedPayload_t payload;
    payload.data = bytes.data();
    payload.length = payload.max_size = static_cast<std::uint32_t>(bytes.size());
    const std::lock_guard lock(mutex_);
    void* sample = wire_type_->createData();
    bool found = false;
    try {
      found = wire_type_->deserialize(&payload, sample) &&
              wire_type_->getKey(sample, handle, force_md5);
    } catch (const std::exception&) {  // generated code throws on some malformed payloads
    }
    wire_type_->deleteData(sample);
    payload.data = nullptr;  // not its own
    return found;
  }

 private:
  std::unique_ptr<dds::TopicDataType> wire_type_;
  std::mutex mutex_;
};

// A reader in the place of `newest_only` that keeps `depth` samples per key.
dds::DataReader* deepen(dds::DataReader* newest_only, dds::Subscriber*& subscriber, int depth) {
  const dds::TopicDescription* description = newest_only->get_topicdescription();
  dds::DomainParticipant* participant = description->get_participant();
  if (subscriber == nullptr) {
    subscriber = participant->create_subscriber(newest_only->get_subscriber()->get_qos());
  }
  dds::DataReaderQos qos = newest_only->get_qos();
  qos.history().depth = depth;
  qos.resource_limits().max_samples_per_instance = depth;
  qos.resource_limits().max_samples = depth * bus::kMaxKeys;
  dds::TopicDescription* topic = participant->lookup_topicdescription(description->get_name());
  dds::DataReader* reader =
      subscriber == nullptr ? nullptr : subscriber->create_datareader(topic, qos);
  if (reader == nullptr) throw std::runtime_error("DDS refused a reader");
  return reader;
}

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

}  // namespace

struct RawReader::Impl {
  struct Endpoint {
    const RecordedTopic* topic;
    dds::DataReader* reader;
  };

  explicit Impl(const bus::BusOptions& options) : participant(options) {
    for (const RecordedTopic& topic : recorded_topics()) {
      dds::DataReader* newest_only =
          participant.add_reader(topic.name, topic.delivery, new RawType(topic.new_support()));
      endpoints.push_back({&topic, deepen(newest_only, subscriber, topic.reader_depth)});
      participant.remove(newest_only);
    }
  }

  RawSample& next_sample() {
    if (used == samples.size()) samples.emplace_back();
    return samples[used++];
  }

  bus::Participant participant;  // deletes what it contains
  dds::Subscriber* subscriber = nullptr;
  std::vector<Endpoint> endpoints;
  std::vector<RawSample> samples;
  std::size_t used = 0;
};

RawReader::RawReader(const bus::BusOptions& options) : impl_(new Impl(options)) {}
RawReader::~RawReader() = default;

std::span<const RawSample> RawReader::take_all() {
  impl_->used = 0;
  // DDS stamps arrivals with the wall clock; everything else here runs on the monotonic one.
  const std::int64_t monotonic_minus_wall =
      now_ns<std::chrono::steady_clock>() - now_ns<std::chrono::system_clock>();
  for (const Impl::Endpoint& endpoint : impl_->endpoints) {
    dds::SampleInfo info;
    RawSample* sample = &impl_->next_sample();
    while (endpoint.reader->take_next_sample(&sample->payload, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;
      sample->topic = endpoint.topic;
      sample->writer = writer_of(info);
      sample->received_time_ns = info.reception_timestamp.to_ns() + monotonic_minus_wall;
      sample = &impl_->next_sample();
    }
    --impl_->used;  // the one that stayed empty
  }
  const std::span<RawSample> taken(impl_->samples.data(), impl_->used);
  std::stable_sort(taken.begin(), taken.end(), [](const RawSample& a, const RawSample& b) {
    return a.received_time_ns < b.received_time_ns;
  });
  return taken;
}

int RawReader::matched_writers() const {
  int count = 0;
  for (const Impl::Endpoint& endpoint : impl_->endpoints) {
    dds::SubscriptionMatchedStatus status;
    endpoint.reader->get_subscription_matched_status(status);
    count += status.current_count;
  }
  return count;
}

struct RawWriter::Impl {
  explicit Impl(const bus::BusOptions& options) : participant(options) {
    for (const RecordedTopic& topic : recorded_topics()) {
      writers.push_back(
          participant.add_writer(topic.name, topic.delivery, new RawType(topic.new_support())));
    }
  }

  dds::DataWriter* writer_of(const RecordedTopic& topic) const {
    return writers.at(static_cast<std::size_t>(&topic - recorded_topics().data()));
  }

  bus::Participant participant;  // deletes what it contains
  std::vector<dds::DataWriter*> writers;
  Bytes bytes;
};

RawWriter::RawWriter(const bus::BusOptions& options) : impl_(new Impl(options)) {}
RawWriter::~RawWriter() = default;

bool RawWriter::write(const RecordedTopic& topic, std::span<const std::uint8_t> payload) {
  impl_->bytes.assign(payload.begin(), payload.end());
  return impl_->writer_of(topic)->write(&impl_->bytes);
}

int RawWriter::matched_readers(const RecordedTopic& topic) const {
  dds::PublicationMatchedStatus status;
  impl_->writer_of(topic)->get_publication_matched_status(status);
  return status.current_count;
}

void RawWriter::wait_for_acknowledgments(double timeout) {
  for (const RecordedTopic& topic : recorded_topics()) {
    if (topic.delivery != bus::Delivery::kState) continue;
    impl_->writer_of(topic)->wait_for_acknowledgments(eprosima::fastrtps::Duration_t(timeout));
  }
}

}  // namespace palpate::recording
