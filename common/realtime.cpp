#include "common/realtime.h"

#include <malloc.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstddef>
#include <cstring>

namespace tautline {
namespace {

constexpr std::size_t kStackBytes = 256 * 1024;

/// Where a user's limits come from depends on who starts the program: services do not read
/// limits.d.
std::string remedyOf(const std::string& item, const std::string& value, const std::string& unit) {
  return "give it the right: started by hand, '@tautline - " + item + " " + value +
         "' in /etc/security/limits.d/tautline.conf, then log in again; as a systemd service, " +
         unit + " in its unit, then systemctl daemon-reload";
}

RealTimeStep done(std::string name) { return {true, std::move(name), ""}; }

RealTimeStep failed(std::string name, int error, const std::string& remedy) {
  return {false, std::move(name), std::string(std::strerror(error)) + "; " + remedy};
}

}  // namespace

RealTimeStep lockMemory() {
  const std::string name = "memory locked";
  mallopt(M_TRIM_THRESHOLD, -1);
  mallopt(M_MMAP_MAX, 0);
  if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    return failed(name, errno, remedyOf("memlock", "unlimited", "LimitMEMLOCK=infinity"));
  }
  return done(name);
}

RealTimeStep prefaultStack() {
  unsigned char stack[kStackBytes];
  for (std::size_t i = 0; i < kStackBytes; i += 4096) stack[i] = 0;
  asm volatile("" : : "r"(stack) : "memory");  // the compiler may not leave the writes out
  return done("stack of " + std::to_string(kStackBytes / 1024) + " KiB prefaulted");
}

RealTimeStep setAffinity(int cpu) {
  const std::string name = "pinned to processor " + std::to_string(cpu);
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(static_cast<unsigned>(cpu), &set);
  // pthread functions return the error; they do not set errno.
  if (const int error = pthread_setaffinity_np(pthread_self(), sizeof(set), &set); error != 0) {
    return failed(name, error, "choose a processor that exists (nproc) with realtime_cpu");
  }
  return done(name);
}

RealTimeStep setFifoPriority(int priority) {
  const std::string name = "SCHED_FIFO priority " + std::to_string(priority);
  const std::string remedy = remedyOf("rtprio", "98", "LimitRTPRIO=98");
  sched_param wanted{};
  wanted.sched_priority = priority;
  if (const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &wanted); error != 0) {
    return failed(name, error, remedy);
  }
  int policy = 0;
  sched_param got{};
  const int error = pthread_getschedparam(pthread_self(), &policy, &got);
  if (error != 0 || policy != SCHED_FIFO || got.sched_priority != priority) {
    return failed(name, error != 0 ? error : EPERM, remedy);
  }
  return done(name);
}

std::vector<RealTimeStep> startRealTime(const RealTimeConfig& config) {
  std::vector<RealTimeStep> steps{lockMemory(), prefaultStack()};
  if (config.cpu >= 0) steps.push_back(setAffinity(config.cpu));
  if (config.priority > 0) steps.push_back(setFifoPriority(config.priority));
  return steps;
}

}  // namespace tautline
