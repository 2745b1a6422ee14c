// Bundles: bytes in, the same bytes out, and nothing of what is no bundle.
#include "modules/bus/sample_bundle.h"

#include <catch2/catch.hpp>
#include <random>
#include <set>

#include "modules/bus/bundled_stream.h"
#include "modules/bus/memory_bus.h"
#include "tests/modules/messages/random_messages.h"

namespace palpate::bus {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Samples = std::vector<std::pair<std::uint32_t, Bytes>>;  // writer, sample

Bytes random_bytes(std::mt19937& random, std::size_t size) {
  Bytes bytes(size);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
  return bytes;
}

Samples samples_of(messages::Payload bundle) {
  BundleReader reader;
  Samples samples;
  REQUIRE(reader.open(bundle));
  while (!reader.empty()) {
    const BundleReader::Sample sample = reader.next();
    samples.emplace_back(sample.writer, Bytes(sample.bytes.begin(), sample.bytes.end()));
  }
  return samples;
}

Bytes bundle_of(const Samples& samples) {
  SampleBundle bundle;
  for (const auto& [writer, sample] : samples) bundle.add(sample, writer);
  const messages::Payload bytes = bundle.finish();
  return {bytes.begin(), bytes.end()};
}

/// Two writers and a reader of positions that travel together over the memory bus.
struct Together {
  explicit Together(const TopicInfo& topic)
      : sender(std::make_shared<BundleSender>(bus.raw_writer(topic))),
        first(sender),
        second(sender),
        plain(bus.raw_reader(topic, Keep::kNewest)),
        reader(bus.raw_reader(topic, Keep::kNewest)) {}
  MemoryBus bus{true};
  std::shared_ptr<BundleSender> sender;
  BundledWriter first, second;
  std::unique_ptr<RawReader> plain;  ///< sees the bundles themselves
  BundledReader reader;
};

}  // namespace

TEST_CASE("bundle: samples come out as they went in, whatever their sizes", "[bus]") {
  // Oracle: the samples themselves; 200 bundles from a fixed seed, sizes that are no whole words
  // among them.
  std::mt19937 random(5);
  SampleBundle bundle;
  for (int round = 0; round < 200; ++round) {
    Samples samples;
    for (std::size_t i = random() % 40; i > 0; --i) {
      samples.emplace_back(random(), random_bytes(random, random() % 300));
    }
    bundle.clear();
    CHECK(bundle.empty());
    for (const auto& [writer, sample] : samples) bundle.add(sample, writer);
    CHECK(bundle.empty() == samples.empty());
    CHECK(samples_of(bundle.finish()) == samples);
  }
}

TEST_CASE("bundle: it begins as its first sample does", "[bus]") {
  // Oracle: the first sample's bytes, which hold the key and the place of the token.
  std::mt19937 random(6);
  const Bytes first = random_bytes(random, 101);
  const Bytes bundle = bundle_of({{1, first}, {2, random_bytes(random, 50)}});
  CHECK(std::equal(first.begin(), first.end(), bundle.begin()));
  CHECK(bundle.size() % 4 == 0);
}

TEST_CASE("bundle: what does not account for every byte is none", "[bus]") {
  // Oracle: a bundle cut or lengthened by whole words, sizes and counts that are changed, and
  // messages as they travel alone.
  std::mt19937 random(7);
  const Bytes good = bundle_of({{1, random_bytes(random, 100)}, {2, random_bytes(random, 36)}});
  BundleReader reader;
  REQUIRE(reader.open(good));
  for (std::size_t size = 0; size < good.size(); size += 4) {
    CHECK_FALSE(reader.open(messages::Payload(good).first(size)));
    CHECK(reader.empty());
  }
  const std::size_t table = 136;  // size, writer, size, writer, count: of 4 bytes each
  REQUIRE(good.size() == table + 20);
  for (const std::size_t number : {0, 2, 4}) {
    for (std::size_t byte = 0; byte < 4; ++byte) {
      Bytes changed = good;
      changed[table + 4 * number + byte] ^= 0x84;
      CHECK_FALSE(reader.open(changed));
    }
  }
  Bytes huge(8, 0xff);
  CHECK_FALSE(reader.open(huge));
  for (int i = 0; i < 1000; ++i) CHECK_FALSE(reader.open(random_bytes(random, 4 * (i % 60))));
  messages::testing::Random of_messages(8);
  for (int i = 0; i < 100; ++i) {
    const auto contacts = messages::testing::random_message<Contacts>(of_messages);
    CHECK_FALSE(reader.open(messages::testing::payload_of(contacts)));
  }
}

TEST_CASE("bundled stream: what two writers wrote travels as one, and is of each", "[bus]") {
  // Oracle: the samples in the order they were written; the writers' own names; one message seen by
  // who does not take bundles apart.
  const TopicInfo topic = info_of(kNodePositions);
  Together together(topic);
  std::mt19937 random(9);
  std::vector<Bytes> written;
  for (int i = 0; i < 6; ++i) {
    written.push_back(random_bytes(random, 30 + random() % 90));
    REQUIRE((i % 2 == 0 ? together.first : together.second).write(written.back()));
  }
  RawSample sample, bundle;
  CHECK_FALSE(together.reader.take(sample));
  REQUIRE(together.sender->send());
  REQUIRE(together.plain->take(bundle));
  CHECK_FALSE(together.plain->take(bundle));
  std::array<WriterId, 2> writers;
  for (std::size_t i = 0; i < written.size(); ++i) {
    REQUIRE(together.reader.wait(0));
    REQUIRE(together.reader.take(sample));
    CHECK(sample.payload == written[i]);
    if (i < 2) writers[i] = sample.writer;
    CHECK(sample.writer == writers[i % 2]);
  }
  CHECK(writers[0] != writers[1]);
  CHECK_FALSE(together.reader.wait(0));
  CHECK_FALSE(together.reader.take(sample));
}

TEST_CASE("bundled stream: more writers than a byte can number have names of their own", "[bus]") {
  // Oracle: as many names as writers; the 257th was called as the first. All begin as the bundle's.
  constexpr std::size_t kWriters = 600, kOfParticipant = 12;
  Together together(info_of(kNodePositions));
  const Bytes written{1, 2, 3, 4};
  for (std::size_t k = 0; k < kWriters; ++k) {
    REQUIRE(BundledWriter(together.sender).write(written));
  }
  REQUIRE(together.sender->send());
  RawSample sample, bundle;
  REQUIRE(together.plain->take(bundle));
  std::set<WriterId> names;
  while (together.reader.take(sample)) {
    names.insert(sample.writer);
    CHECK(std::equal(sample.writer.begin(), sample.writer.begin() + kOfParticipant,
                     bundle.writer.begin()));
  }
  CHECK(names.size() == kWriters);
}

TEST_CASE("bundled stream: a bundle leaves by itself before it outgrows a datagram", "[bus]") {
  // Oracle: no bundle of several samples of 65,000 bytes or more; all samples arrive, in order, one
  // that is larger itself among them, and one that came alone, from who knows no bundles.
  const TopicInfo topic = info_of(kNodePositions);
  Together together(topic);
  std::mt19937 random(10);
  std::vector<Bytes> written;
  for (const std::size_t size : {20'000, 20'000, 20'000, 200'000, 10, 10}) {
    written.push_back(random_bytes(random, size));
    REQUIRE(together.first.write(written.back()));
  }
  REQUIRE(together.second.wait_until_received(0));  // sends the rest
  messages::testing::Random of_messages(11);
  written.push_back(
      messages::testing::payload_of(messages::testing::random_message<NodePositions>(of_messages)));
  REQUIRE(together.bus.raw_writer(topic)->write(written.back()));
  RawSample sample;
  std::size_t largest_of_several = 0;
  while (together.plain->take(sample)) {
    BundleReader bundle;
    if (bundle.open(sample.payload) && (bundle.next(), !bundle.empty())) {
      largest_of_several = std::max(largest_of_several, sample.payload.size());
    }
  }
  CHECK(largest_of_several > 40'000);
  CHECK(largest_of_several < 65'000);
  for (const Bytes& expected : written) {
    REQUIRE(together.reader.take(sample));
    CHECK(sample.payload == expected);
  }
}

}  // namespace palpate::bus
