#include "modules/bus/bundled_stream.h"

#include <utility>

namespace palpate::bus {

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
  sample.writer = bundle_.writer;
  sample.writer.back() ^= static_cast<std::uint8_t>(next.writer);
  sample.received_time_ns = bundle_.received_time_ns;
  sample.clock_error = bundle_.clock_error;
  sample.payload.assign(next.bytes.begin(), next.bytes.end());
  return true;
}

}  // namespace palpate::bus
