// Worlds that step by themselves, in real time.
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <utility>

#include "bindings/pybullet/clients.h"

namespace manyhands::pybullet {

namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr Seconds kLate{0.1};  // who comes later than this is not hurried afterwards

/// What a step took of simulated time. A world that cannot be stepped stands still from then on.
std::optional<Seconds> step(Connection& connection) {
  const std::lock_guard lock(connection.mutex);
  bullet::Settings& settings = connection.client.settings();
  try {
    connection.client.step();
    return Seconds(settings.time_step);
  } catch (const std::exception& error) {
    settings.real_time = false;
    std::fprintf(stderr, "manyhands: real-time simulation has stopped: %s\n", error.what());
    return {};
  }
}

void run(const std::stop_token& stop, Connection& connection) {
  std::mutex mutex;
  std::condition_variable_any never;
  std::unique_lock lock(mutex);
  Clock::time_point due = Clock::now();
  while (!stop.stop_requested()) {
    const std::optional<Seconds> taken = step(connection);
    if (!taken) return;
    due += std::chrono::duration_cast<Clock::duration>(*taken);
    if (const Clock::time_point now = Clock::now(); now - due > kLate) due = now;
    never.wait_until(lock, stop, due, [] { return false; });
  }
}

}  // namespace

void start_clock(Connection& connection) {
  stop_clock(connection);
  if (connection.clock.joinable()) return;  // another thread of Python has just started it
  connection.clock = std::jthread([&connection](const std::stop_token& stop) { run(stop, connection); });
}

void stop_clock(Connection& connection) {
  std::jthread clock = std::exchange(connection.clock, {});
  if (!clock.joinable()) return;
  const WithoutInterpreter release;  // it may wait for somebody who waits for the interpreter
  clock.request_stop();
  clock.join();
}

}  // namespace manyhands::pybullet
