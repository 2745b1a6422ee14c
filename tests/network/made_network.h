// Two hosts on one machine: a network namespace each, a monotonic clock of its own for the second,
// and between them a link that delays, reorders, loses and breaks as a test wants it.
//
// The link is ours because the kernel's (netem) is often not built: each host has a TUN device, and
// a thread carries packets from one to the other. IP fragments are packets of it, too: a datagram
// of 60 KB that loses one of its forty is lost.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

namespace palpate::testing {

/// One way; both ways are alike.
struct LinkFaults {
  double delay = 0;   ///< of every packet [s]
  double jitter = 0;  ///< uniform, up to so much more or less; packets overtake each other [s]
  double loss = 0;    ///< share of packets
};

/// Why no such network can be made here; empty if it can. Costs a try of everything it needs.
std::string no_made_network();

class MadeNetwork {
 public:
  /// @param clock_ahead  how far the second host's monotonic clock is ahead of the first's [s]
  explicit MadeNetwork(const LinkFaults& faults = {}, long clock_ahead = 0);
  ~MadeNetwork();  ///< programs still in it lose their link
  MadeNetwork(const MadeNetwork&) = delete;
  MadeNetwork& operator=(const MadeNetwork&) = delete;

  /// The words that let a program run on a host, before its own: {"/usr/bin/nsenter", "--net=…"}.
  std::vector<std::string> on(std::size_t host) const;
  /// A UDP socket of this program that is on a host; whoever asked closes it.
  int socket_on(std::size_t host) const;
  static std::string address(std::size_t host) { return "10.77.0." + std::to_string(host + 1); }

  void set_faults(const LinkFaults& faults);
  void cut() { cut_ = true; }  ///< a partition, until mend()
  void mend() { cut_ = false; }

  std::uint64_t carried() const { return carried_; }
  std::uint64_t lost() const { return lost_; }

 private:
  struct Host {
    pid_t keeper = -1;  ///< a process that does nothing but be in its namespaces
    int tun = -1;
  };
  static Host make_host(std::size_t index, long clock_ahead);
  void carry();

  Host hosts_[2];
  std::atomic<double> delay_{0}, jitter_{0}, loss_{0};
  std::atomic<bool> cut_{false}, ended_{false};
  std::atomic<std::uint64_t> carried_{0}, lost_{0};
  std::thread link_;
};

}  // namespace palpate::testing
