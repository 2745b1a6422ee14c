#include "modules/bus/participant.h"

#include <fastrtps/xmlparser/XMLProfileManager.h>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>

#include <arpa/inet.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string_view>

#include "modules/bus/addresses.h"
#include "modules/bus/dds_words.h"
#include "modules/bus/filtered_transport.h"
#include "modules/bus/keys.h"
#include "modules/bus/packet_filter.h"
#include "modules/bus/payload_type.h"
#include "modules/bus/polled_sockets.h"
#include "modules/bus/qos.h"
#include "modules/bus/roles.h"
#include "modules/bus/sample_shortcut.h"
#include "modules/bus/session_token.h"
#include "modules/core/error.h"

namespace palpate::bus {
namespace {

namespace dds = eprosima::fastdds::dds;

/// While a participant is made, Fast DDS 2.9.1 answers a thread or memory that it is not given with
/// an assertion (sockets that are open in `UDPTransportInterface::clean`): no fault of ours, that
/// leaves a core behind.
class AssertionsTold {
 public:
  AssertionsTold() {
    struct sigaction told {};
    told.sa_handler = [](int) {
      constexpr std::string_view kSaid =
          "DDS cannot start: there are not enough threads, or memory; ulimit -u says how many a "
          "user may have, ulimit -v how much memory a process\n";
      [[maybe_unused]] const auto told_all = ::write(STDERR_FILENO, kSaid.data(), kSaid.size());
      ::_exit(kExitFailed);
    };
    ::sigaction(SIGABRT, &told, &earlier_);
  }
  ~AssertionsTold() { ::sigaction(SIGABRT, &earlier_, nullptr); }
  AssertionsTold(const AssertionsTold&) = delete;
  AssertionsTold& operator=(const AssertionsTold&) = delete;

 private:
  struct sigaction earlier_ {};
};

/// Participants of one process talk as those of several do. Fast DDS 2.9.1 would call readers of
/// the other by their addresses, and of one that has just left some that are no more (its pull
/// request 5034).
void talk_by_sockets_alone() {
  [[maybe_unused]] static const bool told = [] {
    using Settings = eprosima::fastrtps::xmlparser::XMLProfileManager;
    auto settings = Settings::library_settings();
    settings.intraprocess_delivery = eprosima::fastrtps::INTRAPROCESS_OFF;
    Settings::library_settings(settings);
    return true;
  }();
}

dds::DomainParticipant* made_participant(int domain, const dds::DomainParticipantQos& qos) {
  const AssertionsTold told;
  talk_by_sockets_alone();
  return dds::DomainParticipantFactory::get_instance()->create_participant(
      static_cast<std::uint32_t>(domain), qos);
}

/// What Fast DDS cannot open it does without, and says nothing: who made it would hear nobody, and
/// wait for ever. So some files more can be opened behind it, or it lacks some.
void check_files_left() {
  constexpr std::size_t kSpare = 4;
  std::array<int, kSpare> spare{};
  for (int& file : spare) file = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  const int failure = errno;
  const bool all = std::ranges::all_of(spare, [](int file) { return file >= 0; });
  for (const int file : spare) {
    if (file >= 0) ::close(file);
  }
  if (all) return;
  throw std::runtime_error(std::string("DDS cannot start: ") + std::strerror(failure) +
                           "; ulimit -n says how many a process may have");
}

template <class Entity>
Entity* demand_created(Entity* entity, const std::string& what) {
  if (entity == nullptr) throw std::runtime_error("DDS refused a " + what);
  return entity;
}

}  // namespace

Participant::Participant(const BusOptions& options, Arrivals arrivals)
    : every_sample_(options.every_sample) {
  check_session(options.domain, options.session);
  tell_plainly();
  token_ = options.token ? *options.token : session_token(options.domain, options.session);
  addresses_ = addresses_from(std::getenv("PALPATE_INTERFACES"), std::getenv("PALPATE_PEERS"));
  if (!addresses_.over_hosts()) {
    if (arrivals == Arrivals::kGathered) hearing_.shortcut = std::make_shared<SampleShortcut>();
    if (arrivals == Arrivals::kPolled) hearing_.polled = std::make_shared<PolledSockets>();
  }
  dds::DomainParticipantQos qos;
  if (const char* const folder = std::getenv("PALPATE_KEYS"); folder != nullptr) {
    const char* const role = std::getenv("PALPATE_ROLE");
    role_ = role == nullptr ? options.participant_name : role;
    if (const Role* known = find_role(role_)) role_ = known->name;
    apply_keys(folder, role_, qos);
  }
  packets_ = apply_transport(addresses_, options.domain, {token_, !role_.empty()}, qos, hearing_);
  qos.name(options.participant_name);
  participant_ = made_participant(options.domain, qos);
  if (participant_ == nullptr && !role_.empty()) {
    throw std::runtime_error("DDS cannot start with the keys of role " + role_ +
                             ": its own words are above");
  }
  if (participant_ == nullptr) {
    throw std::runtime_error("DDS cannot start in domain " + std::to_string(options.domain) +
                             ": is the loopback interface up?");
  }
  if (shortcut() != nullptr) {
    shortcut()->set_participant(prefix());
  }
  try {
    check_files_left();
    dds::PublisherQos publisher_qos;
    publisher_qos.partition().push_back(options.session.c_str());
    publisher_ = demand_created(participant_->create_publisher(publisher_qos), "publisher");
    dds::SubscriberQos subscriber_qos;
    subscriber_qos.partition().push_back(options.session.c_str());
    subscriber_ = demand_created(participant_->create_subscriber(subscriber_qos), "subscriber");
  } catch (...) {
    close();
    throw;
  }
}

Participant::~Participant() { close(); }

Refusals Participant::packets_refused() const {
  return {packets_->refused, text_of(packets_->last)};
}

GuidPrefix Participant::prefix() const {
  GuidPrefix own;
  std::ranges::copy(participant_->guid().guidPrefix.value, own.begin());
  return own;
}

bool Participant::admit(std::span<std::uint8_t> payload) {
  const auto token = messages::token_of(payload);
  if (token == token_) {
    messages::set_token(payload, 0);
    return true;
  }
  packets_->refuse(PacketFault::kToken);
  return false;
}

std::string Participant::host_of(const GuidPrefix& participant) const {
  const auto sender = packets_->senders.sender_of(participant);
  if (!sender) return "";  // no packet of it came in: it is this process
  char text[INET_ADDRSTRLEN] = "";
  inet_ntop(AF_INET, &sender->address, text, sizeof text);
  const std::string host = text;
  const bool own =
      host.starts_with("127.") || std::ranges::find(addresses_.own, host) != addresses_.own.end();
  return own ? "" : host;
}

void Participant::close() {
  participant_->delete_contained_entities();
  dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
}

dds::Topic* Participant::topic(const TopicInfo& topic) {
  const auto known = topics_.find(topic.name);
  if (known != topics_.end()) return known->second;
  // A bundle holds samples of many keys, and bundles come in the order they were sent.
  const bool bundled = every_sample_ && topic.delivery == Delivery::kStream;
  dds::TypeSupport support(new PayloadType(*topic.type, token_, !bundled));
  if (bundled && streams_on_host()) {
    support->setName((std::string(topic.type->wire_name) + "@host").c_str());
  }
  participant_->register_type(support);
  dds::Topic* created = demand_created(
      participant_->create_topic(std::string(topic.name), support.get_type_name(), dds::TopicQos()),
      "topic");
  topics_.emplace(topic.name, created);
  return created;
}

std::string Participant::what(const char* endpoint, const TopicInfo& topic) const {
  std::string text = std::string(endpoint) + " of " + std::string(topic.name);
  if (!role_.empty()) text += ": role " + role_ + " may have none";
  return text;
}

dds::DataWriter* Participant::add_writer(const TopicInfo& info) {
  dds::DataWriterQos qos;
  apply_profile({info.delivery, Keep::kNewest, every_sample_, over_hosts()}, qos);
  return demand_created(publisher_->create_datawriter(topic(info), qos), what("writer", info));
}

dds::DataReader* Participant::add_reader(const TopicInfo& info, Keep keep,
                                         dds::DataReaderListener* listener) {
  dds::DataReaderQos qos;
  apply_profile({info.delivery, keep, every_sample_, over_hosts()}, qos);
  const auto told =
      listener == nullptr ? dds::StatusMask::all() : dds::StatusMask::subscription_matched();
  auto* const created = subscriber_->create_datareader(topic(info), qos, listener, told);
  return demand_created(created, what("reader", info));
}

void Participant::remove(dds::DataWriter* writer) { publisher_->delete_datawriter(writer); }
void Participant::remove(dds::DataReader* reader) { subscriber_->delete_datareader(reader); }

}  // namespace palpate::bus
