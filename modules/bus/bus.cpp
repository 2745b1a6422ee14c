#include "modules/bus/bus.h"

#include "modules/bus/clock_ns.h"
#include "modules/messages/cdr.h"

namespace palpate::bus {

std::int64_t Bus::now_ns() const {
  if (clock_) return clock_();
  return monotonic_ns();
}

template <class Message>
bool Writer<Message>::write(Message& message) {
  Header& header = message.header;
  header.sequence = output_->next_sequence();
  if (!output_->raw().is_read()) {
    output_->count();
    return true;
  }
  const std::int64_t given_ns = header.source_time_ns;
  if (given_ns == 0) header.source_time_ns = bus_->now_ns();
  const char* refused_field = messages::encode(message, payload_);
  header.source_time_ns = given_ns;
  if (refused_field != nullptr) {
    output_->refuse(refused_field);
    return false;
  }
  output_->count();
  return output_->raw().write(payload_);
}

template <class Message>
bool Reader<Message>::take(Message& message) {
  // Of a stream one sample per key can be waiting: more tries would only chase a writer that
  // floods.
  constexpr int kMaxTries = 256;
  for (int tries = 0; tries < kMaxTries; ++tries) {
    const RawSample* sample = input_->next();
    if (sample == nullptr) return false;
    if (const char* field = messages::decode(sample->payload, message)) {
      input_->reject(*sample, field);
    } else {
      input_->accept(*sample, message.header);
      return true;
    }
  }
  return false;
}

#define PALPATE_INSTANTIATE(Message) \
  template class Writer<Message>;    \
  template class Reader<Message>;
PALPATE_MESSAGES(PALPATE_INSTANTIATE)
#undef PALPATE_INSTANTIATE

}  // namespace palpate::bus
