// The DDS entities of one process, without their types.
#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "modules/bus/addresses.h"
#include "modules/bus/bus.h"
#include "modules/bus/hearing.h"
#include "modules/bus/packet_senders.h"

namespace eprosima::fastdds::dds {
class DataReader;
class DataReaderListener;
class DataWriter;
class DomainParticipant;
class Publisher;
class Subscriber;
class Topic;
}  // namespace eprosima::fastdds::dds

namespace palpate::bus {

struct PacketTally;

/// A participant with one publisher and one subscriber in the session's partition.
class Participant {
 public:
  /// @param arrivals  how packets are heard, on one host
  /// With PALPATE_KEYS in the environment it plays the role of its name, or PALPATE_ROLE (keys.h).
  /// @throws InputError if the session name, the domain or an address (addresses.h) is not
  /// acceptable
  /// @throws std::runtime_error if DDS cannot start
  explicit Participant(const BusOptions& options, Arrivals arrivals = Arrivals::kAtOnce);
  ~Participant();
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  // Endpoints are given back with remove() before the participant ends.
  eprosima::fastdds::dds::DataWriter* add_writer(const TopicInfo& topic);
  /// @param listener  told of the writers it matches
  eprosima::fastdds::dds::DataReader* add_reader(
      const TopicInfo& topic, Keep keep,
      eprosima::fastdds::dds::DataReaderListener* listener = nullptr);
  void remove(eprosima::fastdds::dds::DataWriter* writer);
  void remove(eprosima::fastdds::dds::DataReader* reader);

  Refusals packets_refused() const;  ///< by the filter in front of DDS, and by admit()

  /// Takes the token off a payload that came; false, and counted, if it is not this session's.
  bool admit(std::span<std::uint8_t> payload);

  bool over_hosts() const { return addresses_.over_hosts(); }
  /// Where packets are gathered; nullptr where not. What arrives has the time of its arrival as
  /// source timestamp then.
  SampleShortcut* shortcut() const { return hearing_.shortcut.get(); }
  /// Who waits for something has to let them hear; nullptr where others do.
  PolledSockets* polled() const { return hearing_.polled.get(); }
  /// Whether streams go past DDS (host_stream.h): in a lockstep on one host, without keys.
  /// Endpoints of DDS only tell of each other then, and match no others.
  bool streams_on_host() const { return every_sample_ && polled() != nullptr && role_.empty(); }
  std::uint64_t token() const { return token_; }
  GuidPrefix prefix() const;
  /// Where a participant that was heard speaks from, as "10.0.0.6"; empty for this host.
  std::string host_of(const GuidPrefix& participant) const;

 private:
  eprosima::fastdds::dds::Topic* topic(const TopicInfo& topic);
  std::string what(const char* endpoint, const TopicInfo& topic) const;  ///< for who is told of it
  void close();

  bool every_sample_;
  std::uint64_t token_ = 0;
  std::string role_;  ///< empty: without keys
  Addresses addresses_;
  Hearing hearing_;
  std::shared_ptr<PacketTally> packets_;
  eprosima::fastdds::dds::DomainParticipant* participant_ = nullptr;
  eprosima::fastdds::dds::Publisher* publisher_ = nullptr;
  eprosima::fastdds::dds::Subscriber* subscriber_ = nullptr;
  std::map<std::string, eprosima::fastdds::dds::Topic*, std::less<>> topics_;
};

}  // namespace palpate::bus
