// Client: states to come back to.
#include "manyhands/bullet/client_body.h"

namespace manyhands::bullet {

int Client::save_state() {
  release_grips();  // states are those of the program's own world
  int id = 0;
  while (states_.contains(id)) ++id;
  states_[id] = world_.snapshot();
  return id;
}

void Client::restore_state(int id) {
  const auto found = states_.find(id);
  if (found == states_.end()) throw Error("Couldn't restore state.");
  release_grips();
  try {
    world_.restore(found->second);
  } catch (const std::invalid_argument&) {
    throw Error("Couldn't restore state.");
  }
  contacts_.clear();
  contacts_known_ = true;
  clear_torques();
  // Motors, gravity and materials are no part of a state.
  for (const int body : order_) {
    for (int i = 0; i < num_joints(body); ++i) write_motor(*find(body), i);
  }
}

void Client::remove_state(int id) { states_.erase(id); }

}  // namespace manyhands::bullet
