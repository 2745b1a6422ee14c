// Of what is stiffer than the device can hold, no more force than its spring has been loaded for.
//
// A law of more than K = b/(T/2 + t_d) is softened to K between two laws, but each law's own force
// is the stiff tissue's. Felt at once, such a force comes up while the device turns round, and the
// softened spring gives back f²/(2K) that nobody put in. So f²/(2K) ≤ E + G, with E what the hand
// put in (Passivity) and G what is granted to a device that rests: there nothing can be fed, and a
// contact that began around it, or one that the tissue stiffened, must come to its force.
#pragma once

namespace palpate::haptics {

class EnergyCredit {
 public:
  static constexpr double kStill = 0.01;      ///< root mean square of a speed that is rest [m/s]
  static constexpr double kStillTime = 0.05;  ///< over which it is taken [s]
  static constexpr double kGrantTime = 0.2;   ///< in which the whole of a force is granted [s]

  explicit EnergyCredit(double period) : period_(period) {}  ///< T [s] > 0

  /// Once per tick of a softened law.
  /// @param wanted     strength of the force [N] ≥ 0
  /// @param stiffness  K [N/m] > 0
  /// @param put_in     E [J]
  /// @param speed      of the device [m/s] ≥ 0
  /// @returns how strong it may be, at most `wanted`
  double limit(double wanted, double stiffness, double put_in, double speed);

  /// Contact is over, or its law is not softened.
  void clear();

 private:
  double period_;
  double granted_ = 0;                     ///< G [J]
  double square_speed_ = kStill * kStill;  ///< mean [m²/s²]
};

}  // namespace palpate::haptics
