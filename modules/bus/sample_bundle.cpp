#include "modules/bus/sample_bundle.h"

#include "modules/core/error.h"

namespace palpate::bus {
namespace {

constexpr std::size_t kWord = 4, kAbout = 2 * kWord;  // [bytes]

void put(std::uint32_t number, std::vector<std::uint8_t>& bytes) {
  for (std::size_t i = 0; i < kWord; ++i) {
    bytes.push_back(static_cast<std::uint8_t>(number >> 8 * i));
  }
}

std::uint32_t number_at(messages::Payload bytes, std::size_t at) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < kWord; ++i) number |= std::uint32_t{bytes[at + i]} << 8 * i;
  return number;
}

std::size_t filled_up(std::size_t size) { return (size + kWord - 1) / kWord * kWord; }

}  // namespace

void SampleBundle::add(messages::Payload sample, std::uint32_t writer) {
  bytes_.insert(bytes_.end(), sample.begin(), sample.end());
  bytes_.resize(filled_up(bytes_.size()), 0);
  about_.push_back(static_cast<std::uint32_t>(sample.size()));
  about_.push_back(writer);
}

messages::Payload SampleBundle::finish() {
  for (const std::uint32_t number : about_) put(number, bytes_);
  put(static_cast<std::uint32_t>(about_.size() / 2), bytes_);
  return bytes_;
}

void SampleBundle::clear() {
  bytes_.clear();
  about_.clear();
}

bool BundleReader::open(messages::Payload bundle) {
  next_ = count_ = 0;
  if (bundle.size() < kWord) return false;
  const std::size_t count = number_at(bundle, bundle.size() - kWord);
  if (count > bundle.size() / kAbout) return false;
  if (count * kAbout + kWord > bundle.size()) return false;
  const std::size_t samples = bundle.size() - kWord - count * kAbout;
  samples_ = bundle.first(samples);
  about_ = bundle.subspan(samples, count * kAbout);
  std::size_t sum = 0;
  for (std::size_t i = 0; i < count; ++i) sum += filled_up(number_at(about_, i * kAbout));
  if (sum != samples) return false;
  count_ = count;
  return true;
}

BundleReader::Sample BundleReader::next() {
  PALPATE_DEMAND(!empty());
  const std::size_t size = number_at(about_, next_ * kAbout);
  const Sample sample{samples_.first(size), number_at(about_, next_ * kAbout + kWord)};
  samples_ = samples_.subspan(filled_up(size));
  ++next_;
  return sample;
}

}  // namespace palpate::bus
