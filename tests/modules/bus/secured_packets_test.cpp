// What a stranger can do who has no keys, but hears every packet of a session on its host and
// forges others in its processes' names: from their addresses and ports, replayed, changed, cut and
// mixed with words of his own.

#include <catch2/catch.hpp>
#include <iostream>
#include <map>

#include "modules/bus/keys.h"
#include "modules/bus/roles.h"
#include "modules/bus/rtps_words.h"
#include "tests/modules/bus/keyed_process.h"
#include "tests/modules/bus/wiretap.h"
#include "tests/modules/messages/random_messages.h"
#include "tests/scratch_folder.h"

namespace palpate::bus {
namespace {

using messages::testing::Random;
using messages::testing::random_message;
using testing::Bytes;
using testing::OverheardPacket;
using testing::Wiretap;

constexpr int kForgedBursts = 200, kForgedBurst = 50;  // 10,000 packets on each topic
constexpr int kTellings = 20;
constexpr std::size_t kModels = 50;  // packets that the stranger hears before he begins

std::string role_that_writes(std::string_view topic) {
  const auto writer = std::ranges::find_if(roles(), [&](const Role& role) {
    return std::ranges::find(role.writes, topic) != role.writes.end();
  });
  return std::string(writer->name);
}

/// Not the announcements of participants, which are many: who proves what to whom, and what is
/// encrypted.
bool worth_forging(const OverheardPacket& packet) {
  constexpr std::uint8_t kEncrypted = 0x31;
  constexpr std::uint32_t kAuthentication = 0x0002'01c3;
  const auto& bytes = packet.bytes;
  for (std::size_t at = 20; at + 4 <= bytes.size();) {
    if (bytes[at] == kEncrypted) return true;
    if (bytes[at] == kData && at + 16 <= bytes.size()) {
      std::uint32_t writer = 0;
      for (std::size_t k = at + 12; k < at + 16; ++k) writer = writer << 8 | bytes[k];
      if (writer == kAuthentication) return true;
    }
    at += 4u + bytes[at + 2] + 256u * bytes[at + 3];
  }
  return false;
}

/// One in ten is what it was.
OverheardPacket forged(Random& random, OverheardPacket packet) {
  Bytes& bytes = packet.bytes;
  const Bytes prefix(bytes.begin() + 8, bytes.begin() + 20);
  const auto kind = random() % 10;
  if (kind == 0) return packet;
  if (kind == 1) {  // plain words, in its name
    bytes = testing::joined(
        {testing::header(prefix), testing::data(testing::kUserWriter, std::int64_t(random() % 1000),
                                                Bytes(random() % 200))});
    return packet;
  }
  if (kind == 2) {  // and behind its own
    for (const Bytes& more : {testing::heartbeat(1, std::int64_t(random() >> 1)),
                              testing::gap(1, std::int64_t(random() % 1000))})
      bytes.insert(bytes.end(), more.begin(), more.end());
    return packet;
  }
  for (auto changes = 1 + random() % 6; changes > 0; --changes)
    bytes[20 + random() % (bytes.size() - 20)] = static_cast<std::uint8_t>(random());
  if (kind == 3) bytes.resize(20 + random() % (bytes.size() - 20));
  return packet;
}

/// What was written, and what of it came: once each, and nothing else.
template <class Message>
struct Heard {
  Reader<Message>& reader;
  Message message;  ///< each time with another sequence number
  std::map<std::uint64_t, Message> sent = {};
  std::map<std::uint64_t, int> came = {};
  int foreign = 0;

  void write(Writer<Message>& writer) {
    REQUIRE(writer.write(message));
    sent[message.header.sequence] = message;
  }
  bool take() {
    Message received;
    bool any = false;
    while (reader.take(received)) {
      const auto own = sent.find(received.header.sequence);
      const bool ours = own != sent.end() && messages::testing::equal(own->second, received);
      ++(ours ? came[received.header.sequence] : foreign);
      any = true;
    }
    return any;
  }
};

template <class Message>
void flood_with_forged(const TopicOf<Message>& topic, const std::filesystem::path& keys) {
  CAPTURE(topic.name);
  const BusOptions options = testing::own_options();
  Wiretap stranger(options.domain);
  const auto writing = testing::keyed_process(keys, role_that_writes(topic.name).c_str(), options);
  const auto reading = testing::keyed_process(keys, "viewer", options);
  Writer<Message> writer = writing->writer(topic);
  Reader<Message> reader = reading->reader(topic);
  REQUIRE(testing::wait_until(
      [&] { return writer.matched_readers() == 1 && reader.matched_writers() == 1; }));
  Random random(7);
  Heard<Message> heard{reader, random_message<Message>(random)};
  const auto goes_on = [&] {
    return testing::wait_until([&] {
      heard.write(writer);
      return heard.take();
    });
  };
  std::vector<OverheardPacket> models;
  while (models.size() < kModels) {
    REQUIRE(goes_on());
    for (OverheardPacket& packet : stranger.overheard())
      if (worth_forging(packet)) models.push_back(std::move(packet));
  }
  for (int burst = 0; burst < kForgedBursts; ++burst) {
    for (int k = 0; k < kForgedBurst; ++k)
      stranger.forge(forged(random, models[random() % models.size()]));
    REQUIRE(goes_on());
  }
  CHECK(heard.foreign == 0);
  CHECK(std::ranges::all_of(heard.came, [](const auto& each) { return each.second == 1; }));
  CHECK(reader.statistics().rejected == 0);
  CHECK(reading->packets_refused().count > 0);
  std::cout << topic.name << ": " << heard.came.size() << " of " << heard.sent.size()
            << " own samples came\n";
}

}  // namespace

TEST_CASE("secured packets: of ten thousand forged ones on each topic none is believed", "[bus]") {
  // Oracle: what was written. Own samples come between them, once each; that they do shows that the
  // forged packets reach who listens.
  const std::string why = Wiretap::impossible();
  if (!why.empty()) {
    std::cout << "SKIPPED: " << why << '\n';
    return;
  }
  const ScratchFolder folder;
  make_keys(folder / "keys", std::chrono::hours(1));
  std::apply([&](const auto&... topic) { (flood_with_forged(topic, folder / "keys"), ...); },
             kTopics);
}

TEST_CASE("secured packets: nothing of a sample can be read in them", "[bus]") {
  // Oracle: a word that is in every sample; without keys it is in the packets.
  const std::string why = Wiretap::impossible();
  if (!why.empty()) {
    std::cout << "SKIPPED: " << why << '\n';
    return;
  }
  const ScratchFolder folder;
  make_keys(folder / "keys", std::chrono::hours(1));
  const std::string word = "a word that only the session knows";
  for (const std::filesystem::path& keys : {folder / "keys", std::filesystem::path()}) {
    const BusOptions options = testing::own_options();
    Wiretap stranger(options.domain);
    const auto writing = testing::keyed_process(keys, "palpate", options);
    const auto reading = testing::keyed_process(keys, "viewer", options);
    auto writer = writing->writer(kScene);
    auto reader = reading->reader(kScene);
    SceneDescription scene;
    int told = 0;
    for (int k = 0; k < kTellings; ++k) {
      stranger.overheard();  // forgotten: there is much else to be heard on a loopback
      scene.resolved_text = word;
      REQUIRE(writer.write(scene));
      REQUIRE(testing::take_soon(reader, scene));
      for (const OverheardPacket& packet : stranger.overheard())
        told += std::ranges::search(packet.bytes, word).empty() ? 0 : 1;
    }
    CHECK((told > 0) == keys.empty());
  }
}

}  // namespace palpate::bus
