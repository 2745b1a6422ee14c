// A driver for a haptic device, on Cyclone DDS: nothing of Palpate but its message types (idl/).
// driver SESSION DOMAIN PROBE X Y Z: moves probe number PROBE of `palpate run … --session SESSION
// --domain DOMAIN`; X Y Z is where the device's own origin is in the scene [m].
#define _GNU_SOURCE
#include <dds/dds.h>
#include <math.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "HapticForce.h"
#include "ProbeState.h"

static const int64_t kPeriod = 1000000;        // of this loop, the device's: 1 kHz [ns]
static const int64_t kForceHolds = 100000000;  // [ns]
static const double kMaxForce = 3.3;           // of the device [N]
static const double kOmega = 2 * M_PI / 4;     // of the stand-in below [rad/s]

// Palpate talks on 127.0.0.1 (PALPATE_INTERFACES changes that), without multicast: participants
// look for each other at the ports that the domain gives to the first hundred of a host. The lease
// is the longest that Cyclone takes: Fast DDS 2.9.1, which looks at each participant once per
// lease, may abort if that is just leaving. Nobody needs it: who is silent is told by the age of
// samples.
static const char* kConfiguration =
    "<General><Interfaces><NetworkInterface address=\"127.0.0.1\"/></Interfaces>"
    "<AllowMulticast>false</AllowMulticast></General>"
    "<Discovery><ParticipantIndex>auto</ParticipantIndex>"
    "<MaxAutoParticipantIndex>99</MaxAutoParticipantIndex>"
    "<Peers><Peer address=\"127.0.0.1\"/></Peers><LeaseDuration>1 hr</LeaseDuration></Discovery>";

// Stand in for your device: its handle goes 15 mm down and up again every 4 s, and nobody feels its
// motors. Positions in metres from its own origin, axes as the scene's (z up).
static double felt = 0;  // most so far [N]
static void device_measured_cp(double time, double position[3]) {
  position[0] = position[1] = 0;
  position[2] = -0.0075 * (1 - cos(kOmega * time));
}
static void device_measured_cv(double time, double velocity[3]) {
  velocity[0] = velocity[1] = 0;
  velocity[2] = -0.0075 * kOmega * sin(kOmega * time);
}
static double length(const double v[3]) { return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }
static void device_servo_cf(const double force[3]) { felt = fmax(felt, length(force)); }

static volatile sig_atomic_t stop_wanted = 0;
static void want_stop(int number) {
  (void)number;
  stop_wanted = 1;
}

static int64_t now_ns(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * 1000000000LL + now.tv_nsec;
}

// (1) Absolute times: what a cycle takes does not add up.
static void sleep_until(int64_t wake_ns) {
  const struct timespec wake = {wake_ns / 1000000000, wake_ns % 1000000000};
  while (!stop_wanted && clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &wake, NULL) != 0) {
  }
}

// What may reach the motors of what was heard `age` ago [ns].
static void guard(const double heard[3], int64_t age, double force[3]) {
  const double size = length(heard);
  double share = 1;
  if (age > kForceHolds)
    share = 0;  // (2) nobody says it
  else if (size > kMaxForce)
    share = kMaxForce / size;                                                    // (3)
  for (int i = 0; i < 3; ++i) force[i] = isfinite(size) ? share * heard[i] : 0;  // (4)
}

// What samples of the session bear. Started as
//   PALPATE_TOKEN=$(palpate token --session SESSION --domain DOMAIN) driver SESSION DOMAIN …
static uint64_t session_token(void) {
  const char* text = getenv("PALPATE_TOKEN");
  if (text != NULL) return strtoull(text, NULL, 16);
  fprintf(stderr, "driver: PALPATE_TOKEN is not set: palpate token says it\n");
  exit(2);
}

static dds_entity_t checked(dds_entity_t result, const char* what) {
  if (result >= 0) return result;
  fprintf(stderr, "driver: %s: %s\n", what, dds_strretcode(-result));
  exit(1);
}

int main(int argc, char** argv) {
  if (argc != 7) {
    fprintf(stderr, "usage: driver SESSION DOMAIN PROBE X Y Z\n");
    return 2;
  }
  const char* session = argv[1];
  const dds_domainid_t domain = (dds_domainid_t)atoi(argv[2]);
  const uint32_t probe = (uint32_t)atoi(argv[3]);
  const double origin[3] = {atof(argv[4]), atof(argv[5]), atof(argv[6])};  // [m]
  const uint64_t token = session_token();
  signal(SIGINT, want_stop);
  signal(SIGTERM, want_stop);

  checked(dds_create_domain(domain, kConfiguration), "domain");
  const dds_entity_t participant =
      checked(dds_create_participant(domain, NULL, NULL), "participant");
  dds_qos_t* qos = dds_create_qos();
  dds_qset_partition1(qos, session);  // a session is a partition
  dds_qset_reliability(qos, DDS_RELIABILITY_BEST_EFFORT, 0);
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 1);
  const dds_entity_t publisher = dds_create_publisher(participant, qos, NULL);
  const dds_entity_t subscriber = dds_create_subscriber(participant, qos, NULL);
  const dds_entity_t input = checked(
      dds_create_topic(participant, &palpate_idl_ProbeState_desc, "probe_input", NULL, NULL),
      "topic");
  const dds_entity_t output = checked(
      dds_create_topic(participant, &palpate_idl_HapticForce_desc, "haptic_force", NULL, NULL),
      "topic");
  const dds_entity_t writer = checked(dds_create_writer(publisher, input, qos, NULL), "writer");
  const dds_entity_t reader = checked(dds_create_reader(subscriber, output, qos, NULL), "reader");
  dds_delete_qos(qos);

  palpate_idl_ProbeState state;
  memset(&state, 0, sizeof state);
  state.session_token = token;
  state.probe = probe;
  state.rotation_xyzw[3] = 1;  // this device does not turn
  double newest[3] = {0, 0, 0}, force[3];
  const int64_t began = now_ns();
  int64_t next = began, heard = began, samples = 0;
  while (!stop_wanted) {
    sleep_until(next);
    const int64_t now = now_ns();
    next += (now > next ? (now - next) / kPeriod + 1 : 1) * kPeriod;  // (1) late: skip

    void* sample = NULL;  // lent by Cyclone
    dds_sample_info_t info;
    while (dds_take(reader, &sample, &info, 1, 1) > 0) {
      const palpate_idl_HapticForce* said = sample;
      if (info.valid_data && said->session_token == token && said->probe == probe) {
        memcpy(newest, said->force_n, sizeof newest);  // on the probe, in the scene's world [N]
        heard = now;
        ++samples;
      }
      dds_return_loan(reader, &sample, 1);
      sample = NULL;
    }
    guard(newest, now - heard, force);
    device_servo_cf(force);

    const double time = 1e-9 * (double)(now - began);
    ++state.sequence_number;     // from 1
    state.source_time_ns = now;  // when it was measured, CLOCK_MONOTONIC
    device_measured_cp(time, state.position_m);
    for (int i = 0; i < 3; ++i) state.position_m[i] += origin[i];
    device_measured_cv(time, state.linear_velocity_m_per_s);
    dds_write(writer, &state);
  }
  const double nothing[3] = {0, 0, 0};
  device_servo_cf(nothing);  // (5)
  printf("driver: %lld forces heard, at most %.3f N\n", (long long)samples, felt);
  dds_delete(DDS_CYCLONEDDS_HANDLE);
  return 0;
}
