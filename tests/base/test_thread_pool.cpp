// Every item once, on every number of threads; exceptions reach the caller. Also run under ThreadSanitizer
// (cmake -D MANYHANDS_SANITIZE=thread).
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <string>

#include "manyhands/base/process_mutex.h"
#include "manyhands/base/thread_pool.h"

namespace manyhands {
namespace {

class OnThreads : public ::testing::TestWithParam<int> {};

INSTANTIATE_TEST_SUITE_P(ThreadPool, OnThreads, ::testing::Range(1, 9));

TEST_P(OnThreads, RunsEveryItemOnce) {
  ThreadPool pool(GetParam());
  EXPECT_EQ(pool.num_threads(), GetParam());
  for (int round = 0; round < 300; ++round) {
    const int n = round % 23;
    std::vector<int> calls(static_cast<std::size_t>(n), 0);  // plain: what one round writes the next may read
    pool.for_each(n, [&](int item, int) { ++calls[static_cast<std::size_t>(item)]; });
    EXPECT_EQ(calls, std::vector<int>(static_cast<std::size_t>(n), 1)) << "round " << round;
  }
}

TEST_P(OnThreads, LendsAWorkerToOneItemAtATime) {
  ThreadPool pool(GetParam());
  std::vector<std::atomic<int>> users(static_cast<std::size_t>(GetParam()));
  std::atomic<bool> clash = false, outside = false;
  for (int round = 0; round < 50; ++round) {
    pool.for_each(40, [&](int, int worker) {
      if (worker < 0 || worker >= GetParam()) {
        outside = true;
        return;
      }
      std::atomic<int>& user = users[static_cast<std::size_t>(worker)];
      if (++user != 1) clash = true;
      std::this_thread::yield();
      --user;
    });
  }
  EXPECT_FALSE(clash);
  EXPECT_FALSE(outside);
}

TEST_P(OnThreads, ThrowsTheBodysExceptionOnceAllIsDone) {
  ThreadPool pool(GetParam());
  for (int round = 0; round < 20; ++round) {
    std::atomic<int> calls = 0;
    const auto fail_at_seven = [&](int item, int) {
      ++calls;
      if (item == 7) throw std::runtime_error("item 7");
    };
    try {
      pool.for_each(20, fail_at_seven);
      FAIL() << "nothing was thrown";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "item 7");
    }
    EXPECT_EQ(calls, 20);
    int later = 0;  // an old exception must not come up again
    pool.for_each(1, [&](int, int) { ++later; });
    EXPECT_EQ(later, 1);
  }
}

TEST_P(OnThreads, ThrowsOneOfManyExceptions) {
  ThreadPool pool(GetParam());
  EXPECT_THROW(pool.for_each(50, [](int item, int) { throw std::out_of_range(std::to_string(item)); }),
               std::out_of_range);
}

TEST_P(OnThreads, EndsWhileIdle) {
  for (int round = 0; round < 30; ++round) {
    ThreadPool pool(GetParam());
    if (round % 2 == 0) pool.for_each(3, [](int, int) {});
    if (round % 3 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));  // let the threads fall asleep
  }
}

TEST_P(OnThreads, WakesThreadsThatSleep) {
  ThreadPool pool(GetParam());
  for (int round = 0; round < 5; ++round) {
    std::this_thread::sleep_for(std::chrono::milliseconds(3));
    std::atomic<int> sum = 0;
    pool.for_each(100, [&](int item, int) { sum += item; });
    EXPECT_EQ(sum, 4950);
  }
}

#if defined(__linux__)
/// The calling thread runs only when nothing else wants the first core.
void stand_back() {
  cpu_set_t first;
  CPU_ZERO(&first);
  CPU_SET(0, &first);
  sched_setaffinity(0, sizeof first, &first);
  const sched_param none{};
  sched_setscheduler(0, SCHED_IDLE, &none);
}

TEST(ThreadPool, DoesNotWaitForAWorkerThatHasNotWokenUp) {
  if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "the caller needs a core of its own";
  ThreadPool pool(2);
  std::atomic<bool> stands_back = false;
  while (!stands_back) {
    pool.for_each(2, [&](int, int worker) {
      if (worker == 1 && !stands_back.exchange(true)) stand_back();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));  // time for the other to come
    });
  }
  std::atomic<bool> stop = false;
  std::jthread greedy([&] {
    cpu_set_t first;
    CPU_ZERO(&first);
    CPU_SET(0, &first);
    sched_setaffinity(0, sizeof first, &first);
    while (!stop) {
    }
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  std::array<double, 51> seconds;
  for (double& one : seconds) {
    const auto begin = std::chrono::steady_clock::now();
    pool.for_each(2, [](int, int) {});
    one = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }
  stop = true;
  std::ranges::nth_element(seconds, seconds.begin() + 25);
  EXPECT_LT(seconds[25], 1e-3) << "median of rounds of nothing";
}
#endif

TEST(ThreadPool, RefusesAnImpossibleNumberOfThreads) {
  for (const int n : {0, -1, 1025}) {
    try {
      const ThreadPool pool(n);
      FAIL() << n;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(std::to_string(n)), std::string::npos) << error.what();
    }
  }
}

TEST(ThreadPool, WorksAloneInAChildProcess) {
  auto pool = std::make_unique<ThreadPool>(3);
  pool->for_each(8, [](int, int) {});
  const pid_t child = fork();
  if (child == 0) {
    alarm(20);  // a child that waits for threads it does not have ends here
    std::atomic<int> calls = 0;
    pool->for_each(8, [&](int, int) { ++calls; });
    pool.reset();
    _exit(calls == 8 ? 0 : 1);
  }
  int status = -1;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

/// The parent's round goes on; its child knows none of the workers inside, nor who holds a lock.
TEST(ThreadPool, WorksAloneInAChildThatWasBornInARound) {
  ThreadPool pool(3);
  ProcessMutex mutex;
  std::atomic<int> inside = 0;
  std::atomic<bool> over = false;
  std::jthread caller([&] {
    const std::scoped_lock lock(mutex);
    pool.for_each(3, [&](int, int) {
      ++inside;
      inside.notify_all();
      over.wait(false);
    });
  });
  for (int now = inside; now < 2; now = inside) inside.wait(now);
  const pid_t child = fork();
  if (child == 0) {
    alarm(20);
    const std::scoped_lock lock(mutex);
    std::atomic<int> calls = 0;
    pool.for_each(8, [&](int, int) { ++calls; });
    _exit(calls == 8 ? 0 : 1);
  }
  over = true;
  over.notify_all();
  int status = -1;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

class Variable : public ::testing::Test {
 protected:
  Variable() {
    if (const char* value = std::getenv("MANYHANDS_THREADS")) before_ = value;
  }
  ~Variable() override {
    if (before_.empty()) {
      unsetenv("MANYHANDS_THREADS");
    } else {
      setenv("MANYHANDS_THREADS", before_.c_str(), 1);
    }
  }

 private:
  std::string before_;
};

TEST_F(Variable, ChoosesTheNumberOfThreadsUnlessTheCallerDoes) {
  setenv("MANYHANDS_THREADS", "5", 1);
  EXPECT_EQ(choose_num_threads(0), 5);
  EXPECT_EQ(choose_num_threads(3), 3);
  for (const char* unset : {"", static_cast<const char*>(nullptr)}) {
    if (unset == nullptr) {
      unsetenv("MANYHANDS_THREADS");
    } else {
      setenv("MANYHANDS_THREADS", unset, 1);
    }
    EXPECT_GE(choose_num_threads(0), 1);
  }
}

TEST_F(Variable, IsRefusedIfItIsNoCount) {
  for (const char* bad : {"0", "-2", "two", "3 ", "2.5", "1025", "99999999999999"}) {
    setenv("MANYHANDS_THREADS", bad, 1);
    try {
      (void)choose_num_threads(0);
      FAIL() << bad;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(std::string("'") + bad + "'"), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("MANYHANDS_THREADS"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace manyhands
