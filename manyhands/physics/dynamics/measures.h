// What energy.h measures of a tree in motion.
#pragma once

#include "manyhands/math/spatial.h"

namespace manyhands {

template <Number T>
struct Energy {
  T kinetic;    ///< rotors included [J]
  T potential;  ///< of gravity; 0 at the world's origin [J]
};

template <Number T>
struct MassProperties {
  T mass;             ///< [kg]
  Vec3<T> com;        ///< centre of mass in the world [m]
  Force<T> momentum;  ///< about the world's origin: n angular [kg m^2/s], f linear [kg m/s]
};

}  // namespace manyhands
