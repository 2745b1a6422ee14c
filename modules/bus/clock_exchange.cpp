#include "modules/bus/clock_exchange.h"

#include <algorithm>
#include <chrono>
#include <random>

#include "modules/bus/clock_ns.h"
#include "modules/messages/cdr.h"

namespace palpate::bus {
namespace {

using namespace std::chrono_literals;
constexpr auto kPeriod = 50ms;
/// At first faster: until clocks are known, nothing of another host is used.
constexpr auto kFirstPeriod = 10ms;
constexpr int kFirstPeriods = 100;

}  // namespace

const ClockOffset* ClockConversation::hear(const ClockExchange& said, std::int64_t received_ns) {
  if (said.process == own_.process) return nullptr;
  Peer& peer = peers_[said.process];
  if (said.header.source_time_ns <= peer.heard.sent_ns && peer.heard.process != 0) return nullptr;
  peer.heard = {said.process, said.header.source_time_ns, received_ns};
  for (const ClockExchange::Echo& echo : said.echoes) {
    if (echo.process != own_.process || echo.sent_ns <= peer.answered_ns) continue;
    peer.answered_ns = echo.sent_ns;
    peer.offset.add({echo.sent_ns, echo.received_ns, said.header.source_time_ns, received_ns});
  }
  return peer.offset.known() ? &peer.offset : nullptr;
}

ClockExchange& ClockConversation::speak(std::int64_t now_ns) {
  std::erase_if(
      peers_, [&](const auto& peer) { return now_ns - peer.second.heard.received_ns > kSilence; });
  own_.echoes.clear();
  for (const auto& [process, peer] : peers_) {
    if (own_.echoes.size() < kMaxClockEchoes) own_.echoes.push_back(peer.heard);
  }
  return own_;
}

ClockExchanger::ClockExchanger(std::unique_ptr<RawWriter> writer, std::unique_ptr<RawReader> reader,
                               HostClocks& clocks)
    : writer_(std::move(writer)),
      reader_(std::move(reader)),
      clocks_(clocks),
      conversation_(1 + std::random_device()() % 0xfffffffeu),
      thread_([this] { run(); }) {}

ClockExchanger::~ClockExchanger() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void ClockExchanger::run() {
  std::unique_lock lock(mutex_);
  for (int periods = 0; !ended_; ++periods) {
    lock.unlock();
    listen();
    say();
    lock.lock();
    wake_.wait_for(lock, periods < kFirstPeriods ? kFirstPeriod : kPeriod, [&] { return ended_; });
  }
}

void ClockExchanger::listen() {
  while (reader_->take(sample_)) {
    const GuidPrefix participant = participant_of(sample_.writer);
    if (clocks_.is_of_this_host(participant)) continue;
    if (messages::decode(sample_.payload, heard_) != nullptr) continue;
    const ClockOffset* offset = conversation_.hear(heard_, sample_.received_time_ns);
    if (offset == nullptr) continue;
    const std::int64_t now_ns = sample_.received_time_ns;
    clocks_.set(participant, offset->at(now_ns), offset->jumps(), now_ns);
  }
}

void ClockExchanger::say() {
  ClockExchange& own = conversation_.speak(monotonic_ns());
  own.header.sequence = ++sequence_;
  own.header.source_time_ns = monotonic_ns();
  if (messages::encode(own, payload_) == nullptr) writer_->write(payload_);
}

}  // namespace palpate::bus
