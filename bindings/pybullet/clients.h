// The clients of this process by their ids.
#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <string>

#include "manyhands/bullet/client.h"

namespace manyhands::pybullet {

/// A client, and how it was connected.
struct Connection {
  bullet::Client client;
  int method = 2;
  std::mutex mutex;
};

inline constexpr std::size_t kMostClients = 1024;
inline constexpr int kDirect = 2, kGui = 1;

/// What all clients share.
struct Shared {
  std::array<std::shared_ptr<Connection>, kMostClients> connections{};
  std::string search_path{};
};
[[nodiscard]] Shared& shared();

/// The client of that id, for one thread at a time. Throws bullet::Error where none is connected.
class ClientLock {
 public:
  explicit ClientLock(int id);
  [[nodiscard]] bullet::Client& operator*() const { return connection_->client; }

 private:
  std::shared_ptr<Connection> connection_;
  std::unique_lock<std::mutex> lock_;
};

/// The file of that name as given, or in the search path; empty if there is none.
[[nodiscard]] std::string find_file(const std::string& name);

}  // namespace manyhands::pybullet
