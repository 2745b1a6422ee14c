// Latency of node positions from one process to another, beside the same number of bytes through
// plain UDP on loopback, and with keys (everything encrypted):  palpate-bench-topic-latency
// [SECONDS [RATE_HZ]]
//
// The reading process starts the writing ones (itself with other arguments). Latency is the
// monotonic clock after taking the sample minus that before writing it, so translation, checks and
// wake-up of the reader count. The plain path sends datagrams of 65 000 bytes and checks nothing.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "modules/bus/dds_bus.h"
#include "modules/bus/keys.h"
#include "modules/core/error.h"
#include "modules/core/temporary_folder.h"
#include "modules/runtime/program.h"
#include "studies/report/measures.h"

namespace {

using palpate::NodePositions;
using Clock = std::chrono::steady_clock;

constexpr int kWarmUpSamples = 50;
constexpr std::size_t kDatagramBytes = 65'000;
constexpr int kSocketBufferBytes = 4 << 20;
constexpr double kSilence = 2;  // [s] without a sample: the writer is done

struct Load {
  std::size_t nodes = 0;
  int samples = 0;
  double rate_hz = 0;
};

struct Latencies {
  std::vector<double> microseconds;
  int missed = 0;

  double quantile(double part) const { return palpate::report::quantile(microseconds, part); }
};

std::int64_t now_ns() { return std::chrono::nanoseconds(Clock::now().time_since_epoch()).count(); }

// Calls send(i) at the load's rate on absolute times.
template <class Send>
void send_at_rate(const Load& load, const Send& send) {
  const auto period =
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / load.rate_hz));
  auto next = Clock::now();
  for (int i = 0; i < load.samples; ++i) {
    std::this_thread::sleep_until(next += period);
    send(i);
  }
}

// --- the topic ---

palpate::bus::BusOptions bus_options(const std::string& session, const char* role) {
  palpate::bus::BusOptions options;
  options.session = session;
  options.participant_name = role;
  return options;
}

void write_topic(const std::string& session, const Load& load) {
  palpate::bus::DdsBus bus(bus_options(session, "deformation"));
  auto writer = bus.writer(palpate::bus::kNodePositions);
  while (writer.matched_readers() == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  NodePositions message;
  message.positions.resize(3 * load.nodes);
  send_at_rate(load, [&](int i) {
    std::fill(message.positions.begin(), message.positions.end(), static_cast<float>(i));
    message.header.source_time_ns = now_ns();
    writer.write(message);
  });
}

Latencies read_topic(const std::string& session, const Load& load) {
  palpate::bus::DdsBus bus(bus_options(session, "collision"));
  auto reader = bus.reader(palpate::bus::kNodePositions);
  NodePositions message;
  Latencies latencies;
  int arrived = 0;
  while (reader.wait(arrived == 0 ? 20 : kSilence)) {
    while (reader.take(message)) {
      const std::int64_t now = now_ns();
      if (++arrived <= kWarmUpSamples) continue;
      latencies.microseconds.push_back(1e-3 *
                                       static_cast<double>(now - message.header.source_time_ns));
    }
    if (message.header.sequence == static_cast<std::uint64_t>(load.samples)) break;
  }
  latencies.missed = static_cast<int>(reader.statistics().dropped);
  return latencies;
}

// --- plain UDP ---

struct ChunkHeader {
  std::int64_t source_time_ns;
  std::uint32_t sample, bytes_left;  // of this sample, with this chunk
};

class LoopbackSocket {
 public:
  LoopbackSocket() : file_(socket(AF_INET, SOCK_DGRAM, 0)) {
    const timeval silence{static_cast<time_t>(kSilence), 0};
    setsockopt(file_, SOL_SOCKET, SO_RCVBUF, &kSocketBufferBytes, sizeof kSocketBufferBytes);
    setsockopt(file_, SOL_SOCKET, SO_SNDBUF, &kSocketBufferBytes, sizeof kSocketBufferBytes);
    setsockopt(file_, SOL_SOCKET, SO_RCVTIMEO, &silence, sizeof silence);
    const sockaddr_in any = address(0);
    if (bind(file_, reinterpret_cast<const sockaddr*>(&any), sizeof any) != 0) {
      throw std::runtime_error("cannot open a socket on 127.0.0.1");
    }
  }
  ~LoopbackSocket() { close(file_); }
  LoopbackSocket(const LoopbackSocket&) = delete;
  LoopbackSocket& operator=(const LoopbackSocket&) = delete;

  int port() const {
    sockaddr_in own{};
    socklen_t size = sizeof own;
    getsockname(file_, reinterpret_cast<sockaddr*>(&own), &size);
    return ntohs(own.sin_port);
  }
  void send_to(int port, const std::vector<char>& bytes) const {
    const sockaddr_in to = address(port);
    sendto(file_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
  }
  /// False after a silence.
  bool receive(std::vector<char>& bytes) const {
    bytes.resize(kDatagramBytes + sizeof(ChunkHeader));
    const ssize_t count = recv(file_, bytes.data(), bytes.size(), 0);
    if (count < 0) return false;
    bytes.resize(static_cast<std::size_t>(count));
    return true;
  }

 private:
  static sockaddr_in address(int port) {
    sockaddr_in loopback{};
    loopback.sin_family = AF_INET;
    loopback.sin_port = htons(static_cast<std::uint16_t>(port));
    loopback.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return loopback;
  }
  int file_;
};

void write_udp(int port, const Load& load) {
  const LoopbackSocket socket;
  std::vector<float> positions(3 * load.nodes);
  std::vector<char> chunk;
  send_at_rate(load, [&](int i) {
    std::fill(positions.begin(), positions.end(), static_cast<float>(i));
    ChunkHeader header{now_ns(), static_cast<std::uint32_t>(i),
                       static_cast<std::uint32_t>(positions.size() * sizeof(float))};
    const char* data = reinterpret_cast<const char*>(positions.data());
    while (header.bytes_left > 0) {
      const std::size_t bytes = std::min<std::size_t>(header.bytes_left, kDatagramBytes);
      chunk.resize(sizeof header + bytes);
      std::memcpy(chunk.data(), &header, sizeof header);
      std::memcpy(chunk.data() + sizeof header, data, bytes);
      socket.send_to(port, chunk);
      data += bytes;
      header.bytes_left -= static_cast<std::uint32_t>(bytes);
    }
  });
}

Latencies read_udp(const LoopbackSocket& socket, const Load& load) {
  const std::size_t sample_bytes = 3 * load.nodes * sizeof(float);
  std::vector<char> chunk, sample(sample_bytes);
  Latencies latencies;
  int arrived = 0;
  ChunkHeader header{};
  std::size_t received = 0;
  while (socket.receive(chunk)) {
    std::memcpy(&header, chunk.data(), sizeof header);
    if (header.bytes_left == sample_bytes) received = 0;
    const std::size_t bytes = chunk.size() - sizeof header;
    std::memcpy(sample.data() + (sample_bytes - header.bytes_left), chunk.data() + sizeof header,
                bytes);
    received += bytes;
    if (received != sample_bytes) continue;
    const std::int64_t now = now_ns();
    if (++arrived > kWarmUpSamples) {
      latencies.microseconds.push_back(1e-3 * static_cast<double>(now - header.source_time_ns));
    }
    if (header.sample + 1 == static_cast<std::uint32_t>(load.samples)) break;
  }
  latencies.missed = load.samples - arrived;
  return latencies;
}

// --- both ---

class WriterProcess {
 public:
  WriterProcess(const std::string& path, const std::string& target, const Load& load) {
    const std::array<std::string, 6> words{"palpate-bench-topic-latency", path, target,
                                           std::to_string(load.nodes),    //
                                           std::to_string(load.samples),  //
                                           std::to_string(load.rate_hz)};
    std::array<char*, 7> arguments{};
    std::transform(words.begin(), words.end(), arguments.begin(),
                   [](const std::string& word) { return const_cast<char*>(word.c_str()); });
    if (posix_spawn(&pid_, "/proc/self/exe", nullptr, nullptr, arguments.data(), environ) != 0) {
      throw std::runtime_error("cannot start the writing process");
    }
  }
  ~WriterProcess() { waitpid(pid_, nullptr, 0); }
  WriterProcess(const WriterProcess&) = delete;
  WriterProcess& operator=(const WriterProcess&) = delete;

 private:
  pid_t pid_ = 0;
};

void print(const char* path, const Load& load, const Latencies& latencies) {
  std::printf("%8.1f KB  %-14s %9.0f %9.0f   %d of %d\n", 12e-3 * static_cast<double>(load.nodes),
              path, latencies.quantile(0.5), latencies.quantile(0.999), latencies.missed,
              load.samples);
}

Latencies measure_topic(const std::string& session, const Load& load) {
  const WriterProcess writer("topic", session, load);
  return read_topic(session, load);
}

void print_ratio(const Latencies& a, const Latencies& b) {
  std::printf("%11s  ratio          %9.2f %9.2f\n", "", a.quantile(0.5) / b.quantile(0.5),
              a.quantile(0.999) / b.quantile(0.999));
}

void measure(const Load& load, const std::filesystem::path& keys) {
  const std::string session =
      std::to_string(getpid()).append("_").append(std::to_string(load.nodes));
  const Latencies topic = measure_topic(session, load);
  setenv("PALPATE_KEYS", keys.c_str(), 1);  // the writing process inherits it
  const Latencies secured = measure_topic(session, load);
  unsetenv("PALPATE_KEYS");
  Latencies udp;
  {
    const LoopbackSocket socket;
    const WriterProcess writer("udp", std::to_string(socket.port()), load);
    udp = read_udp(socket, load);
  }
  print("node_positions", load, topic);
  print("plain UDP", load, udp);
  print_ratio(topic, udp);
  print("with keys", load, secured);
  print_ratio(secured, topic);
}

void run(double seconds, double rate_hz) {
  const int samples = kWarmUpSamples + static_cast<int>(seconds * rate_hz);
  std::printf("one way between two processes at %.0f Hz, %.0f s, microseconds\n", rate_hz, seconds);
  std::printf(
      "    payload  path              median     p99.9   missed (lost, or replaced before "
      "taken)\n");
  const palpate::TemporaryFolder folder;
  const auto keys = folder.path() / "keys";
  palpate::bus::make_keys(keys, std::chrono::hours(24));
  measure({1'100, samples, rate_hz}, keys);   // 13 KB: twice an organ of 550 nodes in floats
  measure({39'000, samples, rate_hz}, keys);  // 468 KB: twice one of 19 500
}

/// The writing process: PATH TARGET NODES SAMPLES RATE_HZ.
void write_as_told(char** words) {
  const Load load{std::stoul(words[2]), std::stoi(words[3]), std::stod(words[4])};
  words[0] == std::string("topic") ? write_topic(words[1], load)
                                   : write_udp(std::stoi(words[1]), load);
}

}  // namespace

int main(int argc, char** argv) {
  palpate::runtime::Program program(
      "Latency of node positions between two processes, beside plain UDP.",
      "palpate-bench-topic-latency");
  double seconds = 5, rate_hz = 250;
  program.add("SECONDS", seconds, "Of each measurement").range(0.1, 3600.0).shows_default();
  program.add("RATE_HZ", rate_hz, "Of the samples").range(1.0, 10'000.0).shows_default();
  const bool writes = argc == 6;
  return program.run(writes ? 1 : argc, argv, [&] {
    writes ? write_as_told(argv + 1) : run(seconds, rate_hz);
    return palpate::kExitDone;
  });
}
