// A stream whose samples travel together (sample_bundle.h), over writers and readers of any bus.
#pragma once

#include <memory>

#include "modules/bus/raw_bus.h"
#include "modules/bus/sample_bundle.h"

namespace palpate::bus {

/// What several writers of a topic write, until it is sent or would fill a datagram.
class BundleSender {
 public:
  explicit BundleSender(std::unique_ptr<RawWriter> writer) : writer_(std::move(writer)) {}

  std::uint32_t next_writer() { return writers_++; }
  /// False if the bus refused what had to leave.
  bool add(messages::Payload sample, std::uint32_t writer);
  bool send();
  RawWriter& raw() { return *writer_; }
  int matched_readers();
  /// Whether there was one when it was sent last, or they were asked for.
  bool is_read() const { return read_; }

 private:
  /// With table and words of RTPS a bundle fits a datagram, unless one sample alone is larger.
  static constexpr std::size_t kMostBytes = 48 << 10;

  std::unique_ptr<RawWriter> writer_;
  SampleBundle bundle_;
  std::uint32_t writers_ = 0;
  bool read_ = true;
};

class BundledWriter : public RawWriter {
 public:
  explicit BundledWriter(std::shared_ptr<BundleSender> sender)
      : sender_(std::move(sender)), number_(sender_->next_writer()) {}

  bool write(messages::Payload sample) override { return sender_->add(sample, number_); }
  int matched_readers() const override { return sender_->matched_readers(); }
  bool is_read() const override { return sender_->is_read(); }
  /// Sends what waits first.
  bool wait_until_received(double longest) override {
    return sender_->send() && sender_->raw().wait_until_received(longest);
  }

 private:
  std::shared_ptr<BundleSender> sender_;
  std::uint32_t number_;
};

/// Hands out what came in bundles one by one, as of the writers that it is of. What is no bundle is
/// a sample.
class BundledReader : public RawReader {
 public:
  explicit BundledReader(std::unique_ptr<RawReader> reader) : reader_(std::move(reader)) {}

  bool take(RawSample& sample) override;
  bool wait(double timeout) override { return !samples_.empty() || reader_->wait(timeout); }
  int matched_writers() const override { return reader_->matched_writers(); }

 private:
  std::unique_ptr<RawReader> reader_;
  RawSample bundle_;
  BundleReader samples_;  ///< of it, not yet taken
};

}  // namespace palpate::bus
