// Policies as bytes.
#pragma once

#include <concepts>
#include <type_traits>

#include "manyhands/base/bytes.h"
#include "manyhands/learn/policy.h"

namespace manyhands::learn {

template <class Archive, class T>
  requires std::same_as<std::remove_const_t<T>, Policy::Layer>
void visit_fields(Archive& archive, T& layer) {
  auto& [inputs, outputs, weight, bias] = layer;
  archive(inputs, outputs, weight, bias);
}

template <class Archive, class T>
  requires std::same_as<std::remove_const_t<T>, Policy::Kernels>
void visit_fields(Archive& archive, T& kernels) {
  auto& [channels, kernel, stride, weight, bias] = kernels;
  archive(channels, kernel, stride, weight, bias);
}

template <class Archive, class T>
  requires std::same_as<std::remove_const_t<T>, Relations>
void visit_fields(Archive& archive, T& relations) {
  auto& [differences, cube_rotation] = relations;
  archive(differences, cube_rotation);
}

template <class Archive, class T>
  requires std::same_as<std::remove_const_t<T>, Policy>
void visit_fields(Archive& archive, T& policy) {
  auto& [env_id, observation_dim, goal_dim, action_dim, mean, scale, clip, relations, activation, output, layers,
         pictures, eyes] = policy;
  archive(env_id, observation_dim, goal_dim, action_dim, mean, scale, clip, relations, activation, output, layers,
          pictures, eyes);
}

}  // namespace manyhands::learn
