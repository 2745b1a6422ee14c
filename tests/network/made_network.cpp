#include "tests/network/made_network.h"

#include <fcntl.h>
#include <linux/if.h>
#include <linux/if_tun.h>
#include <sched.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <queue>
#include <random>
#include <stdexcept>

#ifndef CLONE_NEWTIME
#define CLONE_NEWTIME 0x00000080
#endif

namespace palpate::testing {
namespace {

constexpr const char* kNsenter = "/usr/bin/nsenter";
constexpr std::size_t kPacketBytes = 65'536;

std::int64_t now_ns() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * 1'000'000'000 + now.tv_nsec;
}

bool succeeds(const std::string& command) {
  return std::system((command + " > /dev/null 2>&1").c_str()) == 0;
}

/// A message of one byte with room for a descriptor beside it.
struct DescriptorMessage {
  char byte = 0;
  iovec data{&byte, 1};
  alignas(cmsghdr) char control[CMSG_SPACE(sizeof(int))] = {};
  msghdr message{};

  DescriptorMessage() {
    message.msg_iov = &data;
    message.msg_iovlen = 1;
    message.msg_control = control;
    message.msg_controllen = sizeof control;
  }
  DescriptorMessage(const DescriptorMessage&) = delete;
  DescriptorMessage& operator=(const DescriptorMessage&) = delete;
  cmsghdr* header() { return CMSG_FIRSTHDR(&message); }
};

void send_descriptor(int socket, int descriptor) {
  DescriptorMessage with;
  with.header()->cmsg_level = SOL_SOCKET;
  with.header()->cmsg_type = SCM_RIGHTS;
  with.header()->cmsg_len = CMSG_LEN(sizeof(int));
  std::memcpy(CMSG_DATA(with.header()), &descriptor, sizeof descriptor);
  if (sendmsg(socket, &with.message, 0) < 0) _exit(3);
}

int receive_descriptor(int socket) {
  DescriptorMessage with;
  if (recvmsg(socket, &with.message, MSG_CMSG_CLOEXEC) <= 0) return -1;
  if (with.header() == nullptr || with.header()->cmsg_type != SCM_RIGHTS) return -1;
  int descriptor = -1;
  std::memcpy(&descriptor, CMSG_DATA(with.header()), sizeof descriptor);
  return descriptor;
}

/// In the child: makes the host, hands over its end of the link, and waits for the end.
[[noreturn]] void keep_host(int socket, std::size_t index, long clock_ahead) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (unshare(CLONE_NEWNET | CLONE_NEWTIME) != 0) _exit(1);
  std::ofstream("/proc/self/timens_offsets") << "monotonic " << clock_ahead << " 0\n" << std::flush;
  const int tun = open("/dev/net/tun", O_RDWR | O_NONBLOCK | O_CLOEXEC);
  ifreq request{};
  request.ifr_flags = IFF_TUN | IFF_NO_PI;
  std::strcpy(request.ifr_name, "wire");
  if (tun < 0 || ioctl(tun, TUNSETIFF, &request) != 0) _exit(2);
  const std::string set_up = "ip addr add " + MadeNetwork::address(index) +
                             "/24 dev wire && ip link set dev wire txqueuelen 10000 mtu 1500 up && "
                             "ip link set lo up";
  if (!succeeds(set_up)) _exit(4);
  send_descriptor(socket, tun);
  for (;;) pause();  // until it is killed
}

struct Packet {
  std::int64_t due_ns = 0;
  std::size_t to = 0;
  std::vector<std::uint8_t> bytes;
  bool operator<(const Packet& other) const { return due_ns > other.due_ns; }
};

}  // namespace

std::string no_made_network() {
  if (geteuid() != 0) return "network namespaces need root";
  if (!succeeds("command -v ip && command -v nsenter")) return "ip or nsenter is not installed";
  if (!succeeds("unshare --net true")) return "the kernel allows no network namespace";
  if (!succeeds("unshare --time --monotonic 1000 --fork true"))
    return "the kernel allows no time namespace";
  if (access("/dev/net/tun", R_OK | W_OK) != 0) return "there is no /dev/net/tun";
  return "";
}

MadeNetwork::Host MadeNetwork::make_host(std::size_t index, long clock_ahead) {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    throw std::runtime_error("no pair of sockets");
  Host host;
  host.keeper = fork();
  if (host.keeper == 0) {
    close(ends[0]);
    keep_host(ends[1], index, clock_ahead);
  }
  close(ends[1]);
  host.tun = receive_descriptor(ends[0]);
  close(ends[0]);
  if (host.tun < 0) throw std::runtime_error("a made host cannot be set up");
  return host;
}

MadeNetwork::MadeNetwork(const LinkFaults& faults, long clock_ahead)
    : hosts_{make_host(0, 0), make_host(1, clock_ahead)} {
  set_faults(faults);
  link_ = std::thread([this] { carry(); });
}

MadeNetwork::~MadeNetwork() {
  ended_ = true;
  link_.join();
  for (const Host& host : hosts_) {
    close(host.tun);
    kill(host.keeper, SIGKILL);
    waitpid(host.keeper, nullptr, 0);
  }
}

std::vector<std::string> MadeNetwork::on(std::size_t host) const {
  const std::string of = "/proc/" + std::to_string(hosts_[host].keeper) + "/ns/";
  return {kNsenter, "--net=" + of + "net", "--time=" + of + "time_for_children"};
}

int MadeNetwork::socket_on(std::size_t host) const {
  int made = -1;
  // In a thread of its own: it alone moves there.
  std::thread([&] {
    const std::string file = "/proc/" + std::to_string(hosts_[host].keeper) + "/ns/net";
    const int there = open(file.c_str(), O_RDONLY | O_CLOEXEC);
    if (there < 0) return;
    if (setns(there, CLONE_NEWNET) == 0) made = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    close(there);
  }).join();
  return made;
}

void MadeNetwork::set_faults(const LinkFaults& faults) {
  delay_ = faults.delay;
  jitter_ = faults.jitter;
  loss_ = faults.loss;
}

void MadeNetwork::carry() {
  // What it lends its programs must not be what they take from it: they ask for real-time priority.
  sched_param priority{};
  priority.sched_priority = 90;
  sched_setscheduler(0, SCHED_FIFO, &priority);
  prctl(PR_SET_TIMERSLACK, 1);
  std::mt19937_64 random(20261123);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::priority_queue<Packet> travelling;
  std::vector<std::uint8_t> bytes(kPacketBytes);
  while (!ended_) {
    // Not at every packet: at thousands of wake-ups a second the link would be what is slow.
    constexpr timespec kNap{0, 200'000};
    clock_nanosleep(CLOCK_MONOTONIC, 0, &kNap, nullptr);
    for (std::size_t from = 0; from < 2; ++from) {
      for (ssize_t size; (size = read(hosts_[from].tun, bytes.data(), bytes.size())) > 0;) {
        if (cut_ || uniform(random) < loss_) {
          ++lost_;
          continue;
        }
        const double late = delay_ + jitter_ * (2 * uniform(random) - 1);
        travelling.push({now_ns() + static_cast<std::int64_t>(1e9 * std::max(0.0, late)),
                         1 - from,
                         {bytes.begin(), bytes.begin() + size}});
      }
    }
    while (!travelling.empty() && travelling.top().due_ns <= now_ns()) {
      const Packet& packet = travelling.top();
      if (write(hosts_[packet.to].tun, packet.bytes.data(), packet.bytes.size()) > 0) ++carried_;
      travelling.pop();
    }
  }
}

}  // namespace palpate::testing
