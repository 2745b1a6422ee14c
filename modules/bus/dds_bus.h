// The bus between processes: Fast DDS, behind a header that knows no DDS.
#pragma once

#include <utility>
#include <vector>

#include "modules/bus/bus.h"
#include "modules/bus/hearing.h"

namespace palpate::bus {

class BundleSender;
class ClockExchanger;
class HostClocks;
class Participant;

/// One DDS participant. Over hosts, times in what is read are on this host's clock: of what others
/// say, states wait until their clock is known, streams are left out. Its threads inherit the
/// scheduling of the thread that constructs it: set real-time priority before.
class DdsBus : public Bus {
 public:
  /// @throws InputError for a domain outside 0 to 200, a session that is not 1 to 64 letters,
  /// digits, '_', '-', '.', an address in PALPATE_INTERFACES that this host does not have, or one
  /// in PALPATE_PEERS that is none
  /// @throws std::runtime_error if DDS cannot start (domain in use up, no loopback, …)
  explicit DdsBus(const BusOptions& options, Arrivals arrivals = Arrivals::kAtOnce);
  ~DdsBus() override;

  std::unique_ptr<RawWriter> raw_writer(const TopicInfo& topic) override;
  std::unique_ptr<RawReader> raw_reader(const TopicInfo& topic, Keep keep) override;
  void flush() override;
  Refusals packets_refused() const override;
  const char* clock_trouble() const override;

 private:
  bool is_bundled(const TopicInfo& topic) const;
  std::shared_ptr<BundleSender> sender_of(const TopicInfo& topic);

  bool every_sample_;
  std::unique_ptr<Participant> participant_;
  std::unique_ptr<HostClocks> clocks_;  ///< none on one host, and in lockstep
  std::unique_ptr<ClockExchanger> exchanger_;
  /// By topic, in the order they were made, which is that of sending; users own them.
  std::vector<std::pair<std::string_view, std::weak_ptr<BundleSender>>> senders_;
};

}  // namespace palpate::bus
