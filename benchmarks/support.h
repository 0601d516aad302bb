// What the benchmark programs share: repeated timing, rows of JSON, and the command line.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "manyhands/base/hash.h"
#include "manyhands/math/instantiate.h"

namespace benchmarks {

/// Median seconds of one call, and how far its rounds scattered.
struct Timing {
  double cpu;        ///< of this thread: what the call costs, whoever else uses the machine
  double wall;       ///< by the clock on the wall
  double variation;  ///< of cpu: standard deviation / mean, without the slowest and fastest fifth of the rounds
};

struct Settings {
  int rounds = 15;
  double seconds = 0.02;  ///< of one round, at least
};

inline double thread_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

inline double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Makes the compiler believe that the memory is read: results may not be left uncomputed.
template <class T>
void consume(const T* data) {
  asm volatile("" : : "r"(data) : "memory");
}

inline double median(std::vector<double> values) {
  std::ranges::sort(values);
  const std::size_t n = values.size();
  return n % 2 == 1 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

/// Standard deviation / mean of the middle three fifths.
inline double variation(std::vector<double> values) {
  std::ranges::sort(values);
  const std::size_t cut = values.size() / 5;
  const std::span<const double> middle(values.data() + cut, values.size() - 2 * cut);
  double sum = 0, squares = 0;
  for (const double x : middle) sum += x;
  const double mean = sum / static_cast<double>(middle.size());
  for (const double x : middle) squares += (x - mean) * (x - mean);
  return std::sqrt(squares / static_cast<double>(middle.size())) / mean;
}

/// Times several calls in turns, so that a disturbance of the machine meets all of them.
template <class Call>
std::vector<Timing> time_in_turns(const Settings& settings, std::span<Call> calls) {
  struct Samples {
    int repeats = 1;
    std::vector<double> cpu, wall;
  };
  std::vector<Samples> samples(calls.size());
  for (std::size_t i = 0; i < calls.size(); ++i) {
    for (double spent = 0;; samples[i].repeats *= 2) {
      const double start = thread_seconds();
      for (int k = 0; k < samples[i].repeats; ++k) calls[i]();
      spent = thread_seconds() - start;
      if (spent >= settings.seconds) break;
    }
  }
  for (int round = 0; round < settings.rounds; ++round) {
    for (std::size_t i = 0; i < calls.size(); ++i) {
      const double cpu = thread_seconds(), wall = wall_seconds();
      for (int k = 0; k < samples[i].repeats; ++k) calls[i]();
      samples[i].cpu.push_back((thread_seconds() - cpu) / samples[i].repeats);
      samples[i].wall.push_back((wall_seconds() - wall) / samples[i].repeats);
    }
  }
  std::vector<Timing> timings;
  timings.reserve(samples.size());
  for (const Samples& s : samples) timings.push_back({median(s.cpu), median(s.wall), variation(s.cpu)});
  return timings;
}

/// Reads --quick and --help; anything else ends the program.
inline Settings parse(int argc, char** argv, const char* what) {
  Settings settings;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--quick") == 0) {
      settings = {.rounds = 3, .seconds = 0.0005};
    } else {
      const bool help = std::strcmp(argv[i], "--help") == 0;
      std::fprintf(help ? stdout : stderr, "%s\nUsage: %s [--quick]\nPrints one JSON object a line.\n", what, argv[0]);
      std::exit(help ? 0 : 2);
    }
  }
  return settings;
}

template <class T>
const char* number_name() {
  using namespace manyhands;
  if constexpr (std::is_same_v<T, double>) return "double";
  if constexpr (std::is_same_v<T, float>) return "float";
  if constexpr (std::is_same_v<T, Lanes4>) return "lanes4";
  if constexpr (std::is_same_v<T, Lanes8>) return "lanes8";
  if constexpr (std::is_same_v<T, Lanes16>) return "lanes16";
}

/// One line of output. `wrong` tells why the row must not be believed, or is empty; `note` is for people.
struct Row {
  std::string benchmark;
  const char* number_type;
  int threads;
  double value;
  const char* unit;
  double wall;
  double variation;
  std::uint64_t hash;
  std::string wrong;
  std::string note = {};
};

inline void print(const Row& row) {
  std::printf(
      "{\"benchmark\": \"%s\", \"engine\": \"manyhands\", \"number_type\": \"%s\", \"threads\": %d, \"value\": %.6g, "
      "\"unit\": \"%s\", \"wall\": %.6g, \"variation\": %.4f, \"hash\": \"%016llx\", \"wrong\": \"%s\", \"note\": "
      "\"%s\"}\n",
      row.benchmark.c_str(), row.number_type, row.threads, row.value, row.unit, row.wall, row.variation,
      static_cast<unsigned long long>(row.hash), row.wrong.c_str(), row.note.c_str());
  std::fflush(stdout);
}

/// Results of many arms, arm by arm: numbers of every number type, as double.
struct Results {
  std::vector<double> numbers;
  std::uint64_t hash = 0;  ///< over the bits in their own precision
};

/// `columns` numbers of each block of lanes, unpacked into rows of arms.
template <manyhands::Number T>
Results unpack(std::span<const T> blocks, std::size_t columns) {
  Results results;
  manyhands::Hash hash;
  for (std::size_t b = 0; b < blocks.size(); b += columns) {
    for (int k = 0; k < manyhands::width_v<T>; ++k) {
      for (std::size_t c = 0; c < columns; ++c) {
        const auto number = manyhands::lane(blocks[b + c], k);
        hash.add(number);
        results.numbers.push_back(static_cast<double>(number));
      }
    }
  }
  results.hash = hash.value();
  return results;
}

/// Why `results` are not those of the scalar float run, or "": lanes must have its bits, double must be near it.
template <manyhands::Number T>
std::string compare(const Results& results, const Results& reference, double tolerance) {
  if constexpr (std::is_same_v<T, double>) {
    double difference = 0, size = 0;
    for (std::size_t i = 0; i < results.numbers.size(); ++i) {
      difference += std::pow(results.numbers[i] - reference.numbers[i], 2);
      size += std::pow(reference.numbers[i], 2);
    }
    if (!(difference <= tolerance * tolerance * size)) return "differs from float by more than rounding";
  } else if (results.hash != reference.hash) {
    return "not the bits of the scalar float run";
  }
  return {};
}

}  // namespace benchmarks
