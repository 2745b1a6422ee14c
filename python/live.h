// A session of other processes, heard and spoken to over DDS.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "modules/bus/bus.h"
#include "modules/bus/packet_senders.h"
#include "modules/messages/messages.h"
#include "modules/runtime/session.h"

namespace palpate::python {

/// Readers are made when a topic is first asked for. One thread at a time, as Session (session.h).
class Live {
 public:
  /// @throws InputError, std::runtime_error as bus::DdsBus does
  Live(const std::string& session, int domain);

  /// The newest message of a topic and key; waits until one has come, at most `timeout` [s].
  /// @param key  "0" of probe or organ 0, "haptics" of a module; empty: whichever came last
  /// @return None if none came
  pybind11::object newest(const std::string& topic, const std::string& key, double timeout);
  /// All that came since the last take(), at the first since the topic was asked for last,
  /// (columns, messages). A reader that looks too rarely loses the oldest (bus::kBacklogDepth per
  /// key; of those that newest() read meanwhile, what is beyond 256 MiB).
  pybind11::tuple take(const std::string& topic);

  /// False if the bus refused it. @param source_time  by this host's monotonic clock
  bool write_probe_input(const ProbeState& state);
  /// Gives a command once the launcher's last one has been heard, or after `timeout` [s]; false if
  /// nobody's was. Waits until the launcher has said it again, as long at most.
  bool control(SessionCommand command, double timeout);
  /// running, paused, …
  std::string phase();
  /// Waits until somebody reads probe_input, at most `timeout` [s].
  bool wait_for_haptics(double timeout);

  void close();
  bool closed() const { return closed_; }

 private:
  struct Untaken {
    std::shared_ptr<const messages::AnyMessage> message;
    std::size_t bytes;
  };
  struct Topic {
    const bus::TopicInfo* info;
    std::unique_ptr<bus::RawReader> reader;
    bool is_taken = false;  ///< somebody calls take(): what newest() reads meanwhile is kept
    std::deque<Untaken> untaken;
    std::size_t untaken_bytes = 0;
    std::map<std::string, std::shared_ptr<const messages::AnyMessage>> newest;
    std::string last_key;
  };
  void check_open() const;
  Topic& topic_of(const std::string& name);
  static void receive(Topic& topic);
  static void keep(Topic& topic, Untaken untaken);
  void poll_controls();
  /// Source time of the newest command that a launcher said; 0 before any.
  std::int64_t launcher_said_ns() const;
  template <class Done>
  bool wait_until(double timeout, const Done& done);

  std::atomic_flag in_use_;
  std::atomic<bool> closed_{false};
  std::unique_ptr<bus::Bus> bus_;
  std::map<std::string, Topic> topics_;
  std::optional<bus::Writer<ProbeState>> input_;
  std::optional<bus::Reader<SessionControl>> controls_;
  std::optional<bus::Reader<SceneDescription>> scenes_;
  std::optional<runtime::SessionConductor> conductor_;
  runtime::SessionState state_;
  /// Who tells the session its scene says its newest command again, whoever gave it.
  std::set<bus::GuidPrefix> launchers_;
  std::map<bus::GuidPrefix, std::int64_t> said_by_;  ///< source time of the command heard last
};

}  // namespace palpate::python
