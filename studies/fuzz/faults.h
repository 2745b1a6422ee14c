// Faults of a random scene as what they are: taps on the bus, and a device that fails.
#pragma once

#include <memory>

#include "haptics/devices/device.h"
#include "modules/bus/tap.h"
#include "studies/fuzz/random_scene.h"

namespace palpate::fuzz {

/// Each does nothing where the fault is about another kind of message.
void corrupt(Fault fault, ProbeState& message);
void corrupt(Fault fault, Contacts& message);
void corrupt(Fault fault, ContactModel& message);

/// Lets the scene's faults act on probe states, contacts and contact models of their probes:
/// corruption for a period of deformation, so that every module says something corrupt once; loss,
/// delay and repetition for 0.1 s, which is longer than an input counts as fresh. Readers refuse
/// what the codecs refuse.
void tap_faults(const RandomScene& scene, bus::TappedBus& bus);

/// The device of a probe; its samples are no numbers while a fault of the scene says so.
std::unique_ptr<haptics::Device> faulty_device(const RandomScene& scene, std::uint32_t probe);

}  // namespace palpate::fuzz
