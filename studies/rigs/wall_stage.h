// A virtual wall in the place of deformation: an organ whose answer is known.
#pragma once

#include "modules/bus/bus.h"
#include "modules/runtime/stage.h"

namespace palpate::rigs {

/// What deformation would say of probe 0 on a lossless wall z ≤ 0.
class WallStage final : public runtime::Stage {
 public:
  /// @param stiffness    [N/m]
  /// @param local_model  a law that knows the stiffness, else bare forces
  WallStage(bus::Bus& bus, double stiffness, bool local_model);
  runtime::Health cycle(const runtime::Cycle& now) override;

 private:
  bus::Reader<ProbeState> states_;
  bus::Writer<ContactModel> models_;
  ProbeState state_;
  ContactModel model_;
  double stiffness_;  ///< [N/m]
};

}  // namespace palpate::rigs
