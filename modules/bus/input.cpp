#include "modules/bus/input.h"

#include <algorithm>
#include <iterator>
#include <tuple>

#include "modules/bus/bus.h"

namespace palpate::bus {

Input::Input(Bus& bus, const TopicInfo& topic, Keep keep)
    : bus_(bus), topic_(topic), raw_(bus.raw_reader(topic, keep)) {
  bus_.inputs_.push_back(this);
}

Input::~Input() { std::erase(bus_.inputs_, this); }

void Input::set_horizon(std::int64_t source_time_ns, bool all_heard) {
  horizon_ = source_time_ns;
  all_heard_ = all_heard;
  gated_ = true;
}

bool Input::heard_until(std::int64_t source_time_ns, std::size_t keys) {
  const auto is_heard = [&] {
    const auto heard = std::ranges::count_if(
        newest_, [&](const auto& newest) { return newest.second >= source_time_ns; });
    return static_cast<std::size_t>(heard) >= keys;
  };
  gated_ = true;
  if (is_heard()) return true;
  pull();
  return is_heard();
}

const RawSample* Input::next() {
  if (!gated_) return raw_->take(current_) ? &current_ : nullptr;
  if (!has_admitted() && !all_heard_) pull();
  if (!has_admitted()) return nullptr;
  spare_.splice(spare_.end(), pending_, pending_.begin());
  return &spare_.back().sample;
}

void Input::pull() {
  for (;;) {
    Waiting& arrived = spare();
    if (!raw_->take(arrived.sample)) return;
    read_header(arrived);
    note(arrived);
    if (arrived.header.source_time_ns >= told_before_) insert(spare_.begin());
  }
}

Input::Waiting& Input::spare() {
  if (spare_.empty()) spare_.emplace_back();
  return spare_.front();
}

void Input::read_header(Waiting& arrived) const {
  arrived.header = messages::header_of(arrived.sample.payload);
  arrived.key = messages::key_of(*topic_.type, arrived.sample.payload);
}

void Input::exchange(StateArchive& archive, std::int64_t time_ns) {
  gated_ = true;
  pull();
  const auto is_before = [&](const Waiting& w) { return w.header.source_time_ns < time_ns; };
  auto count = static_cast<std::uint64_t>(std::ranges::count_if(pending_, is_before));
  archive(count);
  if (!archive.reads()) {
    for (Waiting& waiting : pending_) {
      if (is_before(waiting)) archive(waiting.sample.payload);
    }
    return;
  }
  told_before_ = time_ns;
  spare_.splice(spare_.end(), pending_);
  for (; count > 0; --count) {
    Waiting& waiting = spare();
    waiting.sample.writer = {};
    archive(waiting.sample.payload);
    read_header(waiting);
    insert(spare_.begin());
  }
}

// Arrivals are nearly in order: the place is found from the back.
void Input::insert(std::list<Waiting>::iterator arrived) {
  const auto rank = [](const Waiting& w) {
    return std::tie(w.header.source_time_ns, w.key, w.header.sequence);
  };
  auto place = pending_.end();
  while (place != pending_.begin() && rank(*arrived) < rank(*std::prev(place))) --place;
  pending_.splice(place, spare_, arrived);
}

void Input::note(const Waiting& waiting) {
  if (!waiting.key.readable) return;
  const auto is_its = [&](const auto& newest) { return newest.first == waiting.key; };
  const std::int64_t time_ns = waiting.header.source_time_ns;
  // Keys come in turns: it is the one after the last, or looked for.
  noted_ = noted_ + 1 < newest_.size() ? noted_ + 1 : 0;
  if (newest_.empty() || !is_its(newest_[noted_])) {
    const auto known = std::ranges::find_if(newest_, is_its);
    noted_ = static_cast<std::size_t>(known - newest_.begin());
    if (known == newest_.end()) newest_.emplace_back(waiting.key, time_ns);
  }
  newest_[noted_].second = std::max(newest_[noted_].second, time_ns);
}

void Input::accept(const RawSample& sample, const Header& header) {
  count(sample.writer, header.sequence);
  ++statistics_.received;
  writer_ = sample.writer;
  statistics_.clock_error = sample.clock_error;
  statistics_.newest_source_time_ns =
      std::max(statistics_.newest_source_time_ns, header.source_time_ns);
}

void Input::reject(const RawSample& sample, const char* field) {
  // Its number is no gap, if it can be read at all.
  const Header header = messages::header_of(sample.payload);
  if (header.sequence > 0) count(sample.writer, header.sequence);
  ++statistics_.rejected;
  statistics_.last_rejected_field = field;
}

void Input::count(const WriterId& writer, std::uint64_t sequence) {
  gaps_.count(writer, sequence);
  statistics_.dropped = gaps_.dropped();
}

}  // namespace palpate::bus
