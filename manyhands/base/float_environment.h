// How the processor rounds while the physics computes, whatever the program around it has set.
#pragma once

#include <cstdint>

namespace manyhands {

/// While it lives, this thread rounds to nearest and keeps numbers that are denormal; then the caller's mode is back,
/// and flags of exceptions stay raised as they are. Everything public that computes begins with one.
class FloatEnvironment {
 public:
  FloatEnvironment();
  ~FloatEnvironment();
  FloatEnvironment(const FloatEnvironment&) = delete;
  FloatEnvironment& operator=(const FloatEnvironment&) = delete;

 private:
  std::uint64_t callers_;
};

}  // namespace manyhands
