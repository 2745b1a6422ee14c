// Writers that a reader hears and must not believe: of another session under the same name, and of
// a program whose partition "*" matches every session.
#include <catch2/catch.hpp>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>

#include "modules/bus/packet_filter.h"
#include "modules/bus/payload_type.h"
#include "modules/bus/qos.h"
#include "tests/modules/bus/loopback.h"
#include "tests/modules/messages/random_messages.h"

namespace palpate::bus {
namespace {

namespace fast = eprosima::fastdds::dds;
using messages::testing::payload_of;
using messages::testing::Random;
using messages::testing::random_message;
using testing::own_options;
using testing::Pair;
using testing::take_soon;
using testing::wait_until;

constexpr std::uint64_t kOurs = 0x5e55'1077;
constexpr std::uint64_t kTheirs = kOurs ^ 1;
constexpr int kBursts = 200,
              kBurst = 50;  // 10,000 samples of each topic, as fast as they are heard

BusOptions our_options() {
  BusOptions options = own_options();
  options.token = kOurs;
  return options;
}

/// Writes what it likes to every session of a domain.
class Everywhere {
 public:
  Everywhere(int domain, const TopicInfo& topic) : type_(new PayloadType(*topic.type, kTheirs)) {
    fast::DomainParticipantQos qos;
    apply_transport({{"127.0.0.1"}, {}}, domain, {kTheirs, false}, qos);
    participant_ = fast::DomainParticipantFactory::get_instance()->create_participant(
        static_cast<std::uint32_t>(domain), qos);
    participant_->register_type(type_);
    auto* named = participant_->create_topic(std::string(topic.name), type_.get_type_name(),
                                             fast::TopicQos());
    fast::PublisherQos everywhere;
    everywhere.partition().push_back("*");
    fast::DataWriterQos writer_qos;
    apply_profile({topic.delivery, Keep::kNewest, false}, writer_qos);
    writer_qos.resource_limits().max_instances = 0;  // any number of keys
    writer_qos.resource_limits().max_samples = 0;
    // With each heartbeat its library would walk over thousands of keys, and starve the test.
    writer_qos.reliable_writer_qos().times.heartbeatPeriod = {3600, 0};
    writer_ = participant_->create_publisher(everywhere)->create_datawriter(named, writer_qos);
  }
  ~Everywhere() {
    participant_->delete_contained_entities();
    fast::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  Everywhere(const Everywhere&) = delete;
  Everywhere& operator=(const Everywhere&) = delete;

  bool matched() const {
    fast::PublicationMatchedStatus status;
    writer_->get_publication_matched_status(status);
    return status.current_count == 1;
  }
  void write(messages::Payload payload) {
    PayloadType::Sample sample;
    sample.bytes = payload;
    writer_->write(&sample);
  }

 private:
  fast::TypeSupport type_;
  fast::DomainParticipant* participant_;
  fast::DataWriter* writer_;
};

/// A sound message, whole or with some bytes changed, or cut.
template <class Message>
std::vector<std::uint8_t> mutated(Random& random) {
  std::vector<std::uint8_t> payload = payload_of(random_message<Message>(random));
  for (auto changes = random() % 4; changes > 0; --changes) {
    payload[random() % payload.size()] = static_cast<std::uint8_t>(random());
  }
  if (random() % 20 == 0) payload.resize(4 + random() % (payload.size() - 4));
  return payload;
}

template <class Message>
void flood(const TopicOf<Message>& topic) {
  CAPTURE(topic.name);
  const BusOptions options = our_options();
  DdsBus bus(options);
  Reader<Message> reader = bus.reader(topic);
  Everywhere stranger(options.domain, info_of(topic));
  REQUIRE(wait_until([&] { return stranger.matched() && reader.matched_writers() == 1; }));
  Random random(5);
  Message message;
  bool believed = false;
  for (int burst = 0; burst < kBursts; ++burst) {
    const std::uint64_t before = bus.packets_refused().count;
    for (int k = 0; k < kBurst; ++k) stranger.write(mutated<Message>(random));
    REQUIRE(wait_until([&] { return bus.packets_refused().count > before; }));
    believed = reader.take(message) || believed;
  }
  CHECK_FALSE(believed);
  CHECK(reader.statistics().received == 0);
  CHECK(reader.statistics().rejected == 0);                   // the codec did not have to judge one
  CHECK(bus.packets_refused().count > kBursts * kBurst / 2);  // a few are lost on the way

  DdsBus own_bus(options);
  Writer<Message> own = own_bus.writer(topic);
  REQUIRE(wait_until([&] { return own.matched_readers() == 1 && reader.matched_writers() == 2; }));
  Message sent = random_message<Message>(random);
  REQUIRE(own.write(sent));
  CHECK(take_soon(reader, message));
  CHECK(messages::testing::equal(sent, message));
}

}  // namespace

TEST_CASE("foreign session: of ten thousand mutated samples on each topic none is believed",
          "[bus]") {
  // Oracle: what the reader gives out and counts; a sample of its own session comes through behind
  // them, so it did listen.
  std::apply([](const auto&... topic) { (flood(topic), ...); }, kTopics);
}

TEST_CASE("foreign session: another of the same name is heard, not believed, counted and named",
          "[bus]") {
  // Oracle: the counters. The same samples with the right token are taken, small ones and such of
  // many datagrams.
  const BusOptions options = our_options();
  BusOptions second = options;
  second.token = kTheirs;
  Pair<NodePositions> pair(kNodePositions, options);
  DdsBus foreign_bus(second);
  auto foreign = foreign_bus.writer(kNodePositions);
  REQUIRE(pair.matched);
  REQUIRE(wait_until([&] { return foreign.matched_readers() == 1; }));
  for (const std::size_t nodes : {std::size_t{4}, std::size_t{30'000}}) {
    NodePositions sent, received;
    sent.positions.assign(3 * nodes, 0.5f);
    const std::uint64_t refused = pair.reader_bus.packets_refused().count;
    REQUIRE(foreign.write(sent));
    CHECK(wait_until([&] { return pair.reader_bus.packets_refused().count > refused; }));
    CHECK_FALSE(pair.reader.take(received));
    REQUIRE(pair.writer.write(sent));
    REQUIRE(take_soon(pair.reader, received));
    CHECK(received.positions.size() == 3 * nodes);
    CHECK(received.header.session_token == 0);
  }
  CHECK(pair.reader.statistics().received == 2);
  CHECK(std::string(pair.reader_bus.packets_refused().last) == text_of(PacketFault::kToken));
}

TEST_CASE("foreign session: a state that was there first is not taken from a late reader",
          "[bus]") {
  // Oracle: the scene of the own session, though the other's launcher spoke last.
  const BusOptions options = our_options();
  BusOptions second = options;
  second.token = kTheirs;
  DdsBus own_bus(options), foreign_bus(second), late_bus(options);
  auto own = own_bus.writer(kScene), foreign = foreign_bus.writer(kScene);
  SceneDescription scene;
  scene.name = "ours";
  REQUIRE(own.write(scene));
  scene.name = "theirs";
  REQUIRE(foreign.write(scene));
  auto reader = late_bus.reader(kScene);
  REQUIRE(wait_until([&] { return reader.matched_writers() == 2; }));
  REQUIRE(take_soon(reader, scene));
  CHECK(scene.name == "ours");
  CHECK(wait_until([&] { return late_bus.packets_refused().count > 0; }));
  CHECK_FALSE(reader.take(scene));
}

}  // namespace palpate::bus
