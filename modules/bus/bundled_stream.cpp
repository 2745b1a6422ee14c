#include "modules/bus/bundled_stream.h"

#include <utility>

namespace palpate::bus {
namespace {

/// The bundle's writer with the sample's number in its last four bytes: those of its participant
/// stay.
WriterId numbered_writer(WriterId bundled, std::uint32_t number) {
  for (auto byte = bundled.rbegin(); number != 0; ++byte, number >>= 8) {
    *byte ^= static_cast<std::uint8_t>(number);
  }
  return bundled;
}

}  // namespace

bool BundleSender::add(messages::Payload sample, std::uint32_t writer) {
  const bool sent = bundle_.size() + sample.size() <= kMostBytes || send();
  bundle_.add(sample, writer);
  return sent;
}

int BundleSender::matched_readers() {
  const int readers = writer_->matched_readers();
  read_ = readers > 0;
  return readers;
}

bool BundleSender::send() {
  // Streams are of the present: what nobody reads is nobody's.
  read_ = writer_->has_readers();
  if (bundle_.empty()) return true;
  const bool sent = !read_ || writer_->write(bundle_.finish());
  bundle_.clear();
  return sent;
}

bool BundledReader::take(RawSample& sample) {
  while (samples_.empty()) {
    if (!reader_->take(bundle_)) return false;
    if (samples_.open(bundle_.payload)) continue;
    std::swap(sample, bundle_);
    return true;
  }
  const BundleReader::Sample next = samples_.next();
  sample.writer = numbered_writer(bundle_.writer, next.writer);
  sample.received_time_ns = bundle_.received_time_ns;
  sample.clock_error = bundle_.clock_error;
  sample.payload.assign(next.bytes.begin(), next.bytes.end());
  return true;
}

}  // namespace palpate::bus
