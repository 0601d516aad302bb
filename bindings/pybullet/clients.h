// The clients of this process by their ids.
#pragma once

#include <Python.h>

#include <array>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "manyhands/bullet/client.h"

namespace manyhands::pybullet {

/// A client, and how it was connected.
struct Connection {
  bullet::Client client;
  int method = 2;
  std::mutex mutex;
  std::jthread clock;  ///< steps in real time; last, as it ends first
};

inline constexpr std::size_t kMostClients = 1024;
inline constexpr int kDirect = 2, kGui = 1;

/// What all clients share.
struct Shared {
  std::array<std::shared_ptr<Connection>, kMostClients> connections{};
  std::string search_path{};
};
[[nodiscard]] Shared& shared();

/// What Python is told: the id of a client with a window that has been connected, or is about to go. Null: nobody.
struct Listeners {
  PyObject *opened = nullptr, *closed = nullptr;
};
[[nodiscard]] Listeners& listeners();

/// The client's connection; null where there is none.
[[nodiscard]] std::shared_ptr<Connection> connection_of(int id);

/// Lets other threads of Python run.
class WithoutInterpreter {
 public:
  WithoutInterpreter() : state_(PyEval_SaveThread()) {}
  WithoutInterpreter(const WithoutInterpreter&) = delete;
  WithoutInterpreter& operator=(const WithoutInterpreter&) = delete;
  ~WithoutInterpreter() { PyEval_RestoreThread(state_); }

 private:
  PyThreadState* state_;
};

/// Lets a client's world step by itself in real time from now on.
void start_clock(Connection& connection);
/// Ends that, and waits until it has ended. Not to be called by who holds a ClientLock.
void stop_clock(Connection& connection);

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
